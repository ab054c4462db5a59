"""Format numbers for tables on the terminal."""


def scaled(scale: float, value: float | None) -> float | None:
    """Return a value times a scale; None if the value is None."""
    return None if value is None else scale * value


def figure_text(value: float | None) -> str:
    """Return a number with three significant digits; an empty text if it is None."""
    return "" if value is None else f"{value:.3g}"
