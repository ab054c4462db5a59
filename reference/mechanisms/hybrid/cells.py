"""Forces that are linear in pieces: the saturation of continuous laws, and elastic stops.

The effort of a saturated law is a function of the wanted effort w and the velocity v, and that of elastic stops a function of
the coordinate q and of v. The plane of both arguments is made up of cells, in each of which the effort is linear. A motion
leaves a cell where one of its margins, which are linear too, becomes negative.
"""

from dataclasses import dataclass
from typing import Any

from bodycheck.reference.exact.numbers import MP, Real
from bodycheck.reference.mechanisms.control import Controller, Stops


@dataclass(frozen=True)
class Margin:
    """The function slope (x - origin) + rate (v - speed) of an argument x and the velocity v."""

    slope: Real = 0
    origin: Real = 0
    rate: Real = 0
    speed: Real = 0

    def value(self, x: Any, v: Any) -> Any:
        """The value of the function."""
        return self.slope * (x - self.origin) + self.rate * (v - self.speed)


@dataclass(frozen=True)
class Cell:
    """A cell and its margins; the effort in it is gate w + force - stiffness q - damping v."""

    margins: tuple[Margin, ...]
    gate: int = 0
    force: Real = 0
    stiffness: Real = 0
    damping: Real = 0


def most_margins(controller: Controller) -> int:
    """Return the largest number of margins of the cells of a controller."""
    if controller.effort_limit is None:
        return 0
    return 2 if controller.no_load_speed is None else 6


def saturation(controller: Controller, w: Real, v: Real) -> Cell:
    """Return the cell of a controller's law at a wanted effort and a velocity."""
    if controller.effort_limit is None:
        return Cell((), gate=1)
    limit = MP.mpf(controller.effort_limit)
    if controller.no_load_speed is None:
        if abs(w) <= limit:
            return Cell((Margin(-1, limit), Margin(1, -limit)), gate=1)
        side = 1 if w > 0 else -1
        return Cell((Margin(side, side * limit),), force=side * limit)
    fastest = MP.mpf(controller.no_load_speed)
    highest, lowest = limit * min(1, max(0, 1 - v / fastest)), -limit * min(1, max(0, 1 + v / fastest))
    if lowest <= w <= highest:
        return Cell(_unsaturated(limit, fastest, v), gate=1)
    return _saturated(limit, fastest, 1 if w > highest else -1, v)


def _unsaturated(limit: Real, fastest: Real, v: Real) -> tuple[Margin, ...]:
    """The margins in which the wanted effort is exerted: within the limits, and within the two lines."""
    slope = limit / fastest
    if abs(v) < fastest:
        within = Margin(-1, limit), Margin(1, -limit)
        lines = Margin(-1, limit, -slope), Margin(1, -limit, slope)
        return *within, *lines, Margin(rate=-1, speed=fastest), Margin(rate=1, speed=-fastest)
    side = 1 if v > 0 else -1
    return Margin(-side), Margin(side, -side * limit), Margin(rate=side, speed=side * fastest)


def _saturated(limit: Real, fastest: Real, side: int, v: Real) -> Cell:
    """The cell in which the effort is cut, in the direction `side`."""
    slope = limit / fastest
    if side * v < 0:
        return Cell((Margin(side, side * limit), Margin(rate=-side)), force=side * limit)
    if side * v < fastest:
        border = Margin(side, side * limit, side * slope)
        speeds = Margin(rate=side), Margin(rate=-side, speed=side * fastest)
        return Cell((border, *speeds), force=side * limit, damping=slope)
    return Cell((Margin(side), Margin(rate=side, speed=side * fastest)))


def elastic(stops: Stops, beyond: tuple[Real, Real], v: Real) -> Cell:
    """Return the cell of elastic stops.

    beyond: how far the coordinate is beyond the lower and the upper stop; negative before a stop, or where there is none.
    """
    for side, x, stop in zip((-1, 1), beyond, (stops.lower, stops.upper), strict=True):
        if stop is None or x <= 0:
            continue
        stiffness, damping, origin = MP.mpf(stops.stiffness), MP.mpf(stops.damping), MP.mpf(stop)
        push = Margin(side * stiffness, origin, side * damping)
        if stiffness * x + damping * side * v > 0:
            return Cell((push,), force=stiffness * origin, stiffness=stiffness, damping=damping)
        return Cell((Margin(side, origin), Margin(-side * stiffness, origin, -side * damping)))
    limits = ((1, stops.lower), (-1, stops.upper))
    return Cell(tuple(Margin(slope, MP.mpf(stop)) for slope, stop in limits if stop is not None))
