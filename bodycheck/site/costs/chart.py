"""The picture of accuracy against cost: an SVG with the methods of each engine in a scene, of one style with the page.

An open circle is the default of an engine, a square the method that its documentation recommends, and a dot its most accurate
method at the cost of the default, to which a line leads. A ring is around the cheapest accurate method of all engines.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup, escape

from bodycheck.reports.lines import hue
from bodycheck.reports.quantities import number
from bodycheck.reports.runs.choices import ENOUGH
from bodycheck.site.costs.standings import Costs, Priced, Standing

#: The margins of the plot inside a picture: left, below, above and at the right (pixels).
LEFT, BELOW, ABOVE, RIGHT = 70, 46, 14, 12

#: The width of a letter and the height of a line of text (pixels).
LETTER, LINE = 7.2, 15

#: The distances of a name from its mark that are tried in turn: to the right, to the left, below and above (pixels).
AROUND = tuple((side, drop) for drop in (0, 14, -14, 28, -28, 42, -42, 56, -56) for side in (9, -9))

#: The smallest error that the picture tells from none.
LEAST = 1e-15

#: The classes and the sizes (pixels) of the pictures for broad and for narrow screens, of which a page shows one.
SIZES = (("broad", 640, 430), ("narrow", 362, 430))

#: The radius of a mark (pixels).
MARK = 5.0


@dataclass(frozen=True)
class Plane:
    """The axes of a picture: the exponents of ten at the ends of both, and the size (pixels)."""

    cheapest: float
    dearest: float
    least: float
    most: float
    width: int
    height: int

    def at(self, run: Priced) -> tuple[float, float]:
        """Return the place of a run (pixels)."""
        return self.across(run.cost), self.up(run.error)

    def across(self, cost: float) -> float:
        """Return the distance of a cost from the left (pixels)."""
        share = (math.log10(cost) - self.cheapest) / (self.dearest - self.cheapest)
        return LEFT + (self.width - LEFT - RIGHT) * share

    def up(self, error: float) -> float:
        """Return the distance of an error from the top (pixels)."""
        share = (self.most - math.log10(max(error, LEAST))) / (self.most - self.least)
        return ABOVE + (self.height - ABOVE - BELOW) * share


def chart(costs: Costs, width: int, height: int) -> Markup:
    """Return the picture of a scene, with logarithmic axes. width, height: its size (pixels)."""
    plane = _plane(costs, width, height)
    title = f"Accuracy against cost in {costs.scene.name}, of {len(costs.standings)} engines; the table has the numbers"
    parts = [f'<svg class="costs" viewBox="0 0 {width} {height}" role="img" aria-label="{escape(title)}">']
    parts += _axes(plane, costs.scene.quantity.label)
    for one in costs.standings:
        parts += _engine(plane, one)
    if (cheapest := costs.cheapest) is not None:
        x, y = plane.at(cheapest)
        parts.append(f'<circle class="chosen" cx="{x:.1f}" cy="{y:.1f}" r="{2 * MARK:g}"/>')
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{MARK:g}" fill="{hue(cheapest.run.engine)[0]}"/>')
        name = escape(f"{cheapest.run.engine} {cheapest.run.method[0]}")
        parts.append(f'<text class="name" x="{x - 2 * MARK:.1f}" y="{y + 2 * MARK + LINE:.1f}">{name}</text>')
    return Markup("".join([*parts, *_names(plane, costs.standings), "</svg>"]))


def pictures(costs: Costs) -> tuple[tuple[str, Markup], ...]:
    """Return the picture of a scene for broad and for narrow screens, each with its class of style."""
    return tuple((name, chart(costs, width, height)) for name, width, height in SIZES)


def _plane(costs: Costs, width: int, height: int) -> Plane:
    drawn = [run for one in costs.standings for run in (one.usual, one.recommended, one.best) if run is not None]
    if costs.cheapest is not None:
        drawn.append(costs.cheapest)
    prices = [math.log10(run.cost) for run in drawn]
    errors = [math.log10(max(run.error, LEAST)) for run in drawn] + [math.log10(ENOUGH)]
    return Plane(min(prices) - 0.15, max(prices) + 0.35, min(errors) - 0.4, max(errors) + 0.4, width, height)


def _axes(plane: Plane, label: str) -> list[str]:
    right, bottom = plane.width - RIGHT, plane.height - BELOW
    parts = []
    decades = range(math.ceil(plane.least), math.floor(plane.most) + 1)
    for decade in decades[:: max(1, len(decades) // 6)]:
        y = plane.up(10.0**decade)
        parts.append(f'<path class="grid" d="M{LEFT} {y:.1f}H{right}"/>')
        parts.append(f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{number(10.0**decade)}</text>')
    for decade in range(math.ceil(plane.cheapest), math.floor(plane.dearest) + 1):
        x = plane.across(10.0**decade)
        parts.append(f'<path class="grid" d="M{x:.1f} {ABOVE}V{bottom}"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 17}" text-anchor="middle">{_time(10.0**decade)}</text>')
    enough = plane.up(ENOUGH)
    parts.append(f'<path class="enough" d="M{LEFT} {enough:.1f}H{right}"/>')
    parts.append(f'<text x="{LEFT + 3}" y="{enough - 4:.1f}">{number(ENOUGH)}: accurate enough</text>')
    parts.append(f'<text x="{right}" y="{plane.height - 8}" text-anchor="end">Computing time of a second of motion</text>')
    turn = f"rotate(-90 12 {(ABOVE + bottom) / 2:.0f})"
    parts.append(f'<text x="12" y="{(ABOVE + bottom) / 2:.0f}" text-anchor="middle" transform="{turn}">{escape(label)}</text>')
    return parts


def _time(seconds: float) -> str:
    return f"{number(seconds)} s" if seconds >= 1 else f"{number(1e3 * seconds)} ms"


def _engine(plane: Plane, one: Standing) -> list[str]:
    """Return the marks of an engine: its default, the recommended method, and its best method with a line to it."""
    colour = hue(one.engine)[0]
    x, y = plane.at(one.usual)
    parts = []
    if one.best is not one.usual:
        to_x, to_y = plane.at(one.best)
        parts.append(f'<path d="M{x:.1f} {y:.1f}L{to_x:.1f} {to_y:.1f}" stroke="{colour}" stroke-width="1.5"/>')
        parts.append(f'<circle cx="{to_x:.1f}" cy="{to_y:.1f}" r="{MARK:g}" fill="{colour}"/>')
    if one.recommended is not None and one.recommended is not one.usual:
        side_x, side_y = plane.at(one.recommended)
        parts.append(
            f'<rect class="open" x="{side_x - MARK:.1f}" y="{side_y - MARK:.1f}" width="{2 * MARK:g}" height="{2 * MARK:g}" '
            f'stroke="{colour}"/>'
        )
    parts.append(f'<circle class="open" cx="{x:.1f}" cy="{y:.1f}" r="{MARK:g}" stroke="{colour}"/>')
    return parts


def _names(plane: Plane, standings: Sequence[Standing]) -> list[str]:
    """Return the name of each engine beside its best method, where it covers no mark and no other name."""
    taken = [
        (x - MARK, y - MARK, x + MARK, y + MARK)
        for one in standings
        for x, y in (plane.at(run) for run in (one.usual, one.recommended, one.best) if run is not None)
    ]
    parts = []
    for one in sorted(standings, key=lambda one: plane.up(one.best.error)):
        x, y = plane.at(one.best)
        length = LETTER * len(one.engine)
        boxes = [_box(x + side, y + drop, length if side > 0 else -length) for side, drop in AROUND]
        inside = [box for box in boxes if box[0] >= LEFT and box[2] <= plane.width and ABOVE <= box[3] <= plane.height - BELOW]
        box = min(inside or boxes, key=lambda box: (sum(_overlap(box, other) for other in taken), boxes.index(box)))
        taken.append(box)
        left, top, right, bottom = box
        if abs((top + bottom) / 2 - y) > LINE / 2:
            end = left if left > x else right
            parts.append(f'<path class="lead" d="M{x:.1f} {y:.1f}L{end:.1f} {(top + bottom) / 2:.1f}"/>')
        parts.append(f'<text class="name" x="{left:.1f}" y="{bottom - 4:.1f}">{escape(one.engine)}</text>')
    return parts


def _box(x: float, y: float, length: float) -> tuple[float, float, float, float]:
    """Return the box of a text: left, top, right and bottom (pixels). length: negative for a text that ends at `x`."""
    return min(x, x + length), y - LINE / 2, max(x, x + length), y + LINE / 2


def _overlap(one: tuple[float, float, float, float], other: tuple[float, float, float, float]) -> float:
    """Return the area that two boxes share (pixels²)."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(0.0, width) * max(0.0, height)
