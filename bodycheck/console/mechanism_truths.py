"""Print the truth of a mechanism to stdout: the motion of its joints and of its free bodies."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.console.options import View
from bodycheck.console.output import tell
from bodycheck.console.tables import Column, attribute, show
from bodycheck.figures.bounds import rounded_up
from bodycheck.reference.mechanisms.coordinates import by_name
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth

#: Most joints and free bodies that have columns; all of them are in the JSON.
MOST_TOLD = 12

#: An error (rad) as double precision makes it in an angle.
ROUNDING = 1e-16

#: How early the columns of velocities go where the terminal is narrow, and those of coordinates after the first.
VELOCITIES_GO, COORDINATES_GO = 100, 10


@dataclass(frozen=True)
class Instant:
    """The coordinates of a mechanism at one instant (s), by the names of columns, with the bounds of the truth's errors."""

    t: float
    values: dict[str, Array]
    truth_error: float
    truth_position_error: float


def columns(mechanism: Mechanism) -> tuple[Column[Instant], ...]:
    """Return the columns of the table of the truth of a mechanism.

    These are the coordinates and velocities of its joints, and the positions, attitudes and velocities of its free bodies.
    """
    told: list[tuple[str, str, int]] = []
    for joint in mechanism.joints:
        if joint.form.motions:
            own, rate = joint.form.heads
            told += [(joint.name, f"{joint.name} {own}", 0), (_rate(joint.name), f"{joint.name} {rate}", 1)]
    for body in _free(mechanism):
        told += [(body, f"{body} m", 0), (f"{body}.quaternion", f"{body} w x y z", 0), (_rate(body), f"{body} m/s", 1)]
    vectors = (_vector(name, head, place, bool(moves)) for place, (name, head, moves) in enumerate(told[: 2 * MOST_TOLD]))
    return (
        attribute("t", "t s", "g"),
        *vectors,
        _bound("truth_error", "error rad"),
        _bound("truth_position_error", "error m"),
    )


def print_states(mechanism: Mechanism, truth: Truth, chosen: Sequence[int], view: View) -> None:
    """Print the motion of a mechanism at some instants, given by their places."""
    trajectory, bounds = truth.trajectory, truth.bounds
    assert truth.joints is not None  # a mechanism has them
    values: dict[str, Array] = {}
    for name, own in by_name(mechanism, truth.joints).items():
        values |= {name: own["position"], _rate(name): own["velocity"]}
    for place, body in enumerate(mechanism.bodies):
        if body.start is not None:
            states = trajectory.body(place)
            values |= {body.name: states.position, f"{body.name}.quaternion": states.quaternion}
            values |= {_rate(body.name): states.velocity}
    rows = [
        Instant(
            float(trajectory.t[i]),
            {name: np.atleast_1d(own[i]) for name, own in values.items()},
            float(bounds.error[i]),
            float(bounds.position_error[i]),
        )
        for i in chosen
    ]
    show(columns(mechanism), rows, view)


def print_growth(truth: Truth) -> None:
    """Print by how much an error grows, when one of a rounding is no small one any more, and until when the motion is known."""

    from bodycheck.reference.mechanisms.truth import KNOWN, known_until  # which imports all ways to a truth

    t = truth.trajectory.t
    if truth.growth is not None:
        tell(f"an error of the initial angles has grown up to {truth.growth.max():.2g}-fold by t = {t[-1]:g} s")
        lost = np.flatnonzero(truth.growth * ROUNDING >= KNOWN)
        if len(lost):
            tell(f"one of {ROUNDING:.0e} rad reaches {KNOWN:.0e} rad at t = {t[lost[0]]:g} s")
    until, end = known_until(truth), float(t[-1])
    if until == end:
        tell(f"all angles and attitudes are known within {KNOWN:.0e} rad")
    else:
        tell(f"known within {KNOWN:.0e} rad {'at no instant' if until is None else f'until t = {until:g} s'}")


def _free(mechanism: Mechanism) -> list[str]:
    return [body.name for body in mechanism.bodies if body.start is not None]


def _rate(name: str) -> str:
    return f"{name}.velocity"


def _vector(name: str, head: str, place: int, moves: bool) -> Column[Instant]:
    """Return the column of a joint or a body; rows are sorted by the first of its numbers."""

    def text(instant: Instant) -> str:
        return " ".join(f"{value:.9g}" for value in instant.values[name])

    goes = (VELOCITIES_GO if moves else COORDINATES_GO) + place if place else 0
    return Column(name, head, text, lambda instant: float(instant.values[name][0]), goes)


def _bound(name: str, head: str) -> Column[Instant]:
    def value(instant: Instant) -> float:
        found: float = getattr(instant, name)
        return found

    return Column(name, head, lambda instant: f"{rounded_up(value(instant), 2):.2g}", value)
