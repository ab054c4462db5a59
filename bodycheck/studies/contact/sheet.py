"""The sheet of contact: its scenes, its figures, and the exact value in mechanics of the subject of each figure.

The subject of a figure is, for example, the instant of an impact if the figure is the error of this instant.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Literal

from bodycheck.adapters.contract import kind_of
from bodycheck.adapters.touching import laws
from bodycheck.casefile.case import load, shipped
from bodycheck.casefile.content import Case
from bodycheck.figures.columns import FIGURES
from bodycheck.reference.contact.motion import Event, EventKind
from bodycheck.reference.truths import Truth

#: The tag of the shipped cases that are on the sheet.
TAG = "contact"

#: Shipped cases that are on the sheet only if they are named. What `block-rests-on-ramp` shows in a minute, the probe of creep
#: measures in two seconds. `stack-mass-ratio` and `rolling-coin-circle` show what the next two show, at a fraction of their
#: cost. The others repeat scenes of the sheet with sensors.
ONLY_NAMED = frozenset(
    {"block-rests-on-ramp", "stack-of-ten", "rolling-coin-wobble", "sensor-block-on-ramp", "sensor-rolling-ball"}
)

#: The groups of scenes that have settings of their own: a body slides flat on a level plane; bodies touch, and their laws have
#: no restitution; bodies bounce.
Group = Literal["plane", "contact", "impact"]

#: The scenes in which settings are searched for, by their group: short ones, one of each motion that engines have in common. If
#: none of them is selected, the `MOST_SEARCHED` shortest ones are taken.
SEARCHED: Mapping[Group, tuple[str, ...]] = {
    "plane": ("sliding-brick", "spinning-brick-corners"),
    "contact": ("rolling-ball", "block-up-a-ramp", "stack-mass-ratio", "falling-rod", "ball-rolls-to-rest"),
    "impact": ("thrown-ball-with-spin", "ball-hits-ball-on-plane", "dropped-ball"),
}
MOST_SEARCHED = 6

#: A value in exact mechanics, and the bound of its error.
Known = tuple[float, float]


def scenes() -> tuple[str, ...]:
    """Return the names of the shipped cases that are on the sheet unless cases are named."""
    return tuple(name for name in shipped() if name not in ONLY_NAMED and TAG in load(name).tags)


def group_of(case: Case) -> Group:
    """Return the group of the scene of a case."""
    if kind_of(case.scene) == "plane":
        return "plane"
    return "impact" if any(law.restitution for law in laws(case.scene)) else "contact"


def searched(cases: Sequence[Case], group: Group) -> tuple[Case, ...]:
    """Return the cases in which settings are searched for, of those of a group."""
    chosen = [case for case in cases if case.name in SEARCHED[group]]
    return tuple(chosen or sorted(cases, key=lambda case: case.duration)[:MOST_SEARCHED])


def _first(truth: Truth, kind: EventKind) -> Event | None:
    return next((event for event in truth.events if event.kind == kind), None)


def _time(kind: EventKind) -> Callable[[Case, Truth], Known | None]:
    """Return a function that returns the instant (s) of a truth's first event of a kind, and its error bound.

    The function returns None if there is no such event.
    """

    def time(_: Case, truth: Truth) -> Known | None:
        event = _first(truth, kind)
        return None if event is None else (event.time, event.error)

    return time


def _speed_after(kind: EventKind) -> Callable[[Case, Truth], Known | None]:
    """Return a function that returns the speed (m/s) just after a truth's first event of a kind, and its error bound.

    The function returns None if there is no such event.
    """

    def speed(_: Case, truth: Truth) -> Known | None:
        event = _first(truth, kind)
        return None if event is None else (math.hypot(*event.velocity), float(truth.bounds.velocity_error[0]))

    return speed


def _restitution(case: Case, _: Truth) -> Known | None:
    plane = case.scene.plane
    return None if plane is None else (plane.restitution, 0.0)


def _ideal(_: Case, __: Truth) -> Known:
    return 0.0, 0.0


#: The figures of the sheet, in their order, with functions that return the exact value of each figure's subject.
SUBJECTS: Mapping[str, Callable[[Case, Truth], Known | None]] = {
    "transition_time_error": _time("roll"),
    "roll_speed_error": _speed_after("roll"),
    "impact_time_error": _time("impact"),
    "impact_speed_error": _speed_after("impact"),
    "bounce_ratio_error": _restitution,
    "impact_energy_error": _ideal,
    "impact_momentum_error": _ideal,
    "rest_time_error": _time("rest"),
    "creep": _ideal,
    "viscous_speed": _ideal,
    "penetration": _ideal,
    "energy_gain": _ideal,
    "load_error": _ideal,
    "contact_losses": _ideal,
    "position_error": _ideal,
}


def unit_of(figure: str) -> str:
    """Return the unit of a figure; if it has none, the noun for the things that it counts, or "relative"."""
    return FIGURES[figure].in_unit


def truth_error(figure: str, known: Known | None, bounds: Mapping[str, float]) -> float | None:
    """Return the error bound of the exact value of a figure's subject; None if it is not known.

    known: the exact value with its error bound. bounds: the bounds of the truth's own errors in a run, by column. If the figure
    has such a column, its bound is returned, and otherwise the bound in `known`.
    """
    if bounded := FIGURES[figure].bounded_by:
        return bounds.get(bounded)
    return None if known is None else known[1]
