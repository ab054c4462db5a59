"""The table of a truth: the state of a single body, or the motion of the joints and of the free bodies of a mechanism."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.console.tables import Column, attribute
from bodycheck.figures.bounds import rounded_up
from bodycheck.reference.bodies import motions
from bodycheck.reference.mechanisms.coordinates import by_name
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth

#: The largest number of joints and free bodies with columns; the JSON contains all of them.
MOST_TOLD = 12

#: `Column.goes` of the velocities of a mechanism, and of its coordinates after the first: columns with larger numbers are left
#: out earlier on a narrow terminal.
VELOCITIES_GO, COORDINATES_GO = 100, 10


@dataclass(frozen=True)
class Instant:
    """The states of a truth at one instant (s), by the names of columns, with the bounds of the truth's errors (rad, m)."""

    t: float
    values: dict[str, Array]
    truth_error: float
    truth_position_error: float


def columns(scene: AnyScene) -> tuple[Column[Instant], ...]:
    """Return the columns of the table with the truth of a scene.

    The columns of a mechanism are the coordinates and velocities of its joints, and the positions, attitudes and velocities of
    its free bodies.
    """
    states = _of_mechanism(scene) if isinstance(scene, Mechanism) else _OF_BODY
    return (
        attribute("t", "t s", "g"),
        *states,
        _bound("truth_error", "error rad"),
        _bound("truth_position_error", "error m"),
    )


def instants(truth: Truth, chosen: Sequence[int]) -> list[Instant]:
    """Return the rows of the table at some instants, given by their indices."""
    values, bounds = _values(truth), truth.bounds
    return [
        Instant(
            float(truth.trajectory.t[i]),
            {name: np.atleast_1d(states[i]) for name, states in values.items()},
            float(bounds.error[i]),
            float(bounds.position_error[i]),
        )
        for i in chosen
    ]


def _values(truth: Truth) -> dict[str, Array]:
    """Return the states (n, ...) by the names of columns."""
    scene, trajectory = truth.scene, truth.trajectory
    if not isinstance(scene, Mechanism):
        names = ("position", "quaternion", "velocity", "angular_velocity")
        return {name: getattr(trajectory, name) for name in names}
    assert truth.joints is not None  # the truth of a mechanism has joints
    values: dict[str, Array] = {}
    for name, motion in by_name(scene, truth.joints).items():
        values |= {name: motion["position"], _rate(name): motion["velocity"]}
    for body, states in zip(scene.bodies, motions(scene, trajectory), strict=True):
        if body.start is not None:
            values |= {body.name: states.position, f"{body.name}.quaternion": states.quaternion}
            values |= {_rate(body.name): states.velocity}
    return values


def _of_mechanism(mechanism: Mechanism) -> list[Column[Instant]]:
    """Return the columns of the joints and free bodies of a mechanism. Rows are sorted by the first number of a column."""
    heads: list[tuple[str, str, bool]] = []
    for joint in mechanism.joints:
        if joint.form.motions:
            unit, rate = joint.form.heads
            heads += [(joint.name, f"{joint.name} {unit}", False), (_rate(joint.name), f"{joint.name} {rate}", True)]
    for body in (body.name for body in mechanism.bodies if body.start is not None):
        heads += [(body, f"{body} m", False), (f"{body}.quaternion", f"{body} w x y z", False)]
        heads += [(_rate(body), f"{body} m/s", True)]
    return [
        _vector(name, head, (VELOCITIES_GO if moves else COORDINATES_GO) + index if index else 0, _first)
        for index, (name, head, moves) in enumerate(heads[: 2 * MOST_TOLD])
    ]


def _rate(name: str) -> str:
    return f"{name}.velocity"


def _vector(name: str, head: str, goes: int, size: Callable[[Array], float]) -> Column[Instant]:
    """Return the column of a vector. goes: see `Column`; size: function from a vector to the value for sorting rows."""

    def text(instant: Instant) -> str:
        return " ".join(f"{value:.9g}" for value in instant.values[name])

    return Column(name, head, text, lambda instant: size(instant.values[name]), goes)


def _bound(name: str, head: str) -> Column[Instant]:
    def value(instant: Instant) -> float:
        bound: float = getattr(instant, name)
        return bound

    return Column(name, head, lambda instant: f"{rounded_up(value(instant), 2):.2g}", value)


def _first(values: Array) -> float:
    return float(values[0])


def _length(values: Array) -> float:
    return float(np.linalg.norm(values))


#: The columns of the state of a single body; rows are sorted by the length of a vector.
_OF_BODY = (
    _vector("position", "position m", 1, _length),
    _vector("quaternion", "quaternion w x y z", 2, _length),
    _vector("velocity", "velocity m/s", 4, _length),
    _vector("angular_velocity", "angular velocity (body) rad/s", 3, _length),
)
