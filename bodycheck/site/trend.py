"""A small chart of errors by release: an SVG that is embedded in a page and takes its colours from the style of the page."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from markupsafe import Markup, escape

#: The sizes of the plot in pixels, and of the margins inside it at the left, below and above.
WIDTH, HEIGHT, LEFT, BELOW, ABOVE = 350, 200, 46, 36, 10

#: The width of a chart (pixels), with the room for names at the right.
TOTAL = WIDTH + 150

#: The width of a digit (pixels).
LETTER = 8

#: The least distance between the names of lines (pixels).
APART = 14

#: The dash patterns of lines, so that lines can be distinguished without colour.
DASHES = ("", "7 3", "2 2", "9 3 2 3", "12 4", "1 4")

#: A function from a value to its height in a chart (pixels from the top).
Height = Callable[[float], float]

#: The most lines of a chart, and the most characters of a name beside it.
MOST_LINES, LONGEST = 6, 24


@dataclass(frozen=True)
class Line:
    """The errors of a method.

    Parameters
    ----------
    name
        The name of the method.
    values
        The error of the method in each release; None for a release without an error.
    """

    name: str
    values: tuple[float | None, ...]


def chart(title: str, label: str, versions: Sequence[str], lines: Sequence[Line]) -> Markup:
    """Return a chart with a logarithmic axis of errors.

    Parameters
    ----------
    title
        A description of the chart for readers who cannot see it.
    label
        The label of the axis of errors, with its unit.
    versions
        The releases, the oldest first.
    lines
        At most `MOST_LINES` lines, of which at least one has a positive value.
    """
    low, high = _decades([value for line in lines for value in line.values])
    across = [LEFT + (WIDTH - LEFT - 10) * (place + 0.5) / len(versions) for place in range(len(versions))]

    def up(value: float) -> float:
        return ABOVE + (HEIGHT - ABOVE - BELOW) * (high - math.log10(max(value, 10.0**low))) / (high - low)

    parts = [f'<svg class="trend" viewBox="0 0 {TOTAL} {HEIGHT}" role="img" aria-label="{escape(title)}">']
    for decade in range(low, high + 1, max(1, (high - low) // 5)):
        y = up(10.0**decade)
        parts.append(f'<path class="grid" d="M{LEFT} {y:.1f}H{WIDTH - 10}"/>')
        parts.append(f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">1e{decade}</text>')
    for place in _shown(versions):
        x = across[place]
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - BELOW + 18}" text-anchor="middle">{escape(versions[place])}</text>')
    parts.append(f'<text x="{LEFT}" y="{HEIGHT - 1}">{escape(label)}</text>')
    places = _names(lines, up)
    for place, line in enumerate(lines):
        parts += _drawn(place, line, across, up)
        parts.append(
            f'<text class="line{place}" x="{WIDTH - 4}" y="{places[place] + 4:.1f}">{escape(_short(line.name))}</text>'
        )
    return Markup("".join([*parts, "</svg>"]))


def _drawn(place: int, line: Line, across: Sequence[float], up: Height) -> list[str]:
    """Return the SVG elements of a line: a path with a gap where a value is None, and a dot for each value."""
    path, dots, pen = "", [], "M"
    for x, value in zip(across, line.values, strict=True):
        if value is None:
            pen = "M"
            continue
        path += f"{pen}{x:.1f} {up(value):.1f}"
        pen = "L"
        dots.append(f'<circle class="line{place}" cx="{x:.1f}" cy="{up(value):.1f}" r="3"/>')
    dash = f' stroke-dasharray="{DASHES[place]}"' if DASHES[place] else ""
    return [f'<path class="line{place}"{dash} d="{path}"/>', *dots]


def _decades(values: Sequence[float | None]) -> tuple[int, int]:
    """Return the exponents of the powers of ten that enclose all positive values."""
    positive = [math.log10(value) for value in values if value]
    low, high = math.floor(min(positive)), math.ceil(max(positive))
    return (low, high) if low < high else (low - 1, high)


def _names(lines: Sequence[Line], up: Height) -> list[float]:
    """Return the heights (pixels from the top) of the names of lines: near their last values, but without overlap."""
    wanted = [next((up(value) for value in reversed(line.values) if value is not None), float(ABOVE)) for line in lines]
    placed = [0.0] * len(lines)
    last = -math.inf
    for place in sorted(range(len(lines)), key=lambda one: wanted[one]):
        last = placed[place] = max(wanted[place], last + APART)
    over = max(0.0, last - (HEIGHT - BELOW))
    return [y - over for y in placed]


def _shown(versions: Sequence[str]) -> range:
    """Return the indices of the releases whose names fit below the chart; the last release is always among them."""
    room = (WIDTH - LEFT - 10) / len(versions)
    step = math.ceil((max(map(len, versions)) + 1) * LETTER / room)
    return range((len(versions) - 1) % step, len(versions), step)


def _short(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
