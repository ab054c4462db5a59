"""The effect of an engine's differences on a motion: the free motions of its model and of the file's model.

Both motions follow exact mechanics, so that they differ only by the differences between the models: the model of the engine is
the model of the file with the faults that were found. Joints that follow others move independently in both.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.kinematics import geodesic_angle, multiply, normalise
from bodycheck.reference.robots.dynamics import terms, velocity_labels
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import VELOCITIES, RobotState
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array

#: Tolerances of the integration, far below the differences that are shown.
RELATIVE, ABSOLUTE = 1e-6, 1e-7

#: Most evaluations of the accelerations. Dry friction in a joint that comes to rest requires ever shorter steps.
MOST_EVALUATIONS = 4000

#: The index of the quaternion's first component among the positions of a joint, by the type of the joint.
QUATERNIONS = {"spherical": 0, "floating": 3}


@dataclass(frozen=True)
class Drift:
    """The largest difference of two motions at their end.

    Attributes
    ----------
    joint
        The joint with the largest difference.
    amount, unit
        Its difference: an angle in degrees, or a length in mm.
    """

    joint: str
    amount: float
    unit: str


class NoMotion(Exception):
    """A motion cannot be computed; the text says why."""


def sentence(file: RobotModel, engine: RobotModel, state: RobotState, gravity: Vector, seconds: float) -> str:
    """Return the effect of differences between two models with the same joints on a motion, as a sentence without a full stop.

    Parameters
    ----------
    file, engine
        The models.
    state
        The state in which both motions begin. No efforts act.
    gravity
        The gravitational acceleration (m/s^2).
    seconds
        The time (s).
    """
    try:
        end = drift(file, engine, state, gravity, seconds)
    except NoMotion as error:
        return f"the motion that follows cannot be compared: {error}"
    return f"after {seconds:g} s of free motion, {end.joint} is {end.amount:.3g} {end.unit} from where it should be"


def drift(file: RobotModel, engine: RobotModel, state: RobotState, gravity: Vector, seconds: float) -> Drift:
    """Return the largest difference of the motions of two models. The parameters are those of `sentence`. Raises `NoMotion`."""
    ends = [moved(model, state, gravity, seconds) for model in (file, engine)]
    drifts = [_apart(joint.name, joint.type, ends[0], ends[1]) for joint in file.joints if VELOCITIES[joint.type]]
    return max(drifts, key=lambda one: one.amount, default=Drift("", 0.0, "°"))


def moved(model: RobotModel, state: RobotState, gravity: Vector, seconds: float) -> dict[str, Array]:
    """Return the positions of the joints of a model after free motion for a time (s). Raises `NoMotion`."""
    from scipy.integrate import DOP853

    names = list(dict.fromkeys(name for name, _ in velocity_labels(model)))
    kinds = {joint.name: joint.type for joint in model.joints}
    lengths = [len(state.positions[name]) for name in names]
    rates = [VELOCITIES[kinds[name]] for name in names]
    none = {name: (0.0,) * rate for name, rate in zip(names, rates, strict=True)}

    def parts(numbers: Array) -> tuple[dict[str, Array], dict[str, Array]]:
        position, velocity = numbers[: sum(lengths)], numbers[sum(lengths) :]
        return _cut(names, lengths, position), _cut(names, rates, velocity)

    def change(_: float, numbers: Array) -> Array:
        position, velocity = parts(numbers)
        at = {name: _normalised(kinds[name], numbers_of_joint) for name, numbers_of_joint in position.items()}
        now = RobotState(_tuples(at), _tuples(velocity), none, none)
        acceleration = terms(model, now, gravity).forward_dynamics
        if acceleration is None:
            raise NoMotion("its accelerations are not determined")
        turned = [_rate(kinds[name], at[name], velocity[name]) for name in names]
        return np.concatenate([*turned, np.asarray(acceleration, np.float64)])

    start = [*(state.positions[name] for name in names), *(state.velocities[name] for name in names)]
    solver = DOP853(change, 0.0, np.concatenate(list(map(np.array, start))), seconds, rtol=RELATIVE, atol=ABSOLUTE)
    while solver.status == "running":
        solver.step()
        if solver.nfev > MOST_EVALUATIONS:
            raise NoMotion(f"it takes more than {MOST_EVALUATIONS} evaluations")
    if solver.status != "finished":
        raise NoMotion("its motion cannot be integrated")
    return {name: _normalised(kinds[name], numbers_of_joint) for name, numbers_of_joint in parts(solver.y)[0].items()}


def _cut(names: list[str], lengths: list[int], numbers: Array) -> dict[str, Array]:
    return dict(zip(names, np.split(numbers, np.cumsum(lengths)[:-1]), strict=True)) if names else {}


def _tuples(values: Mapping[str, Array]) -> dict[str, tuple[float, ...]]:
    return {name: tuple(map(float, numbers)) for name, numbers in values.items()}


def _normalised(kind: str, position: Array) -> Array:
    if (first := QUATERNIONS.get(kind)) is None:
        return position
    return np.concatenate([position[:first], normalise(position[first:])])


def _rate(kind: str, position: Array, velocity: Array) -> Array:
    """Return the derivative of the positions of a joint."""
    if (first := QUATERNIONS.get(kind)) is None:
        return velocity
    spin = np.concatenate([[0.0], velocity[first:]])
    return np.concatenate([velocity[:first], multiply(position[first:], spin) / 2])


def _apart(name: str, kind: str, one: Mapping[str, Array], other: Mapping[str, Array]) -> Drift:
    """Return the difference of two positions of a joint; for a joint with angles and lengths, the angle alone."""
    gap = np.abs(one[name] - other[name])
    if kind == "prismatic":
        return Drift(name, float(gap[0]) * 1e3, "mm")
    if (first := QUATERNIONS.get(kind)) is not None:
        angle = geodesic_angle(one[name][first:], other[name][first:])
        return Drift(name, math.degrees(float(angle)), "°")
    return Drift(name, math.degrees(float(gap[-1])), "°")
