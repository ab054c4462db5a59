"""Numbers as text for tables on the terminal."""


def scaled(scale: float, value: float | None) -> float | None:
    """A value times a scale; None stays None."""
    return None if value is None else scale * value


def figure_text(value: float | None) -> str:
    """A number with three significant digits; empty for None."""
    return "" if value is None else f"{value:.3g}"
