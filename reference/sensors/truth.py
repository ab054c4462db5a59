"""The truth of the readings of sensors, with bounds of its errors.

The readings follow from the states of a truth by the equations of motion at each instant (`expected`), without differentiation.
Their bound is twice the sum of the largest changes of a reading when each coordinate, each velocity and each effort is changed
by the bound of its error, plus the rounding to doubles. Twice covers what is not linear in such changes; where the bound of an
attitude is so large that this cannot be said, the bound of the readings is infinite.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bodies import of_bodies
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.loops.joint_space import coordinate_rates
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.requirements import grips
from bodycheck.reference.sensors.bounding import with_bounds, without
from bodycheck.reference.sensors.contacts import touching_truth
from bodycheck.reference.sensors.efforts import Acting, acting_at, efforts, nudged
from bodycheck.reference.sensors.equations import Equations, closed_sides, equations, solution, states_of, with_rules
from bodycheck.reference.sensors.expected import reading, require_modelled, terms
from bodycheck.reference.sensors.kinetics import kinetics
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.truths import Truth

#: The largest number of entries of the mass matrices that are computed at once.
MOST_ENTRIES = 1_000_000


def sensor_truth(truth: Truth, sensors: Sequence[Sensor]) -> tuple[SensorTruth, ...]:
    """Return the true readings of sensors at the instants of a truth, with bounds.

    Raises `OutOfReach` if it is undecided which joints at rest begin to move.
    """
    if not sensors:
        return ()
    if truth.scene.plane is not None:
        return touching_truth(truth, sensors)
    if grips(truth.scene):
        return tuple(without(sensor, "readings in a scene with fingers that grip a body") for sensor in sensors)
    model = _Model(equations(truth.scene), tuple(sensors))
    states = with_rules(model.written, states_of(model.written, of_bodies(truth.trajectory), truth.joints))
    acting = None
    if truth.scene.controllers if isinstance(truth.scene, Mechanism) else ():
        try:
            acting = acting_at(truth)
        except NotModelled as error:
            return tuple(without(sensor, str(error)) for sensor in sensors)
    reasons = _reasons(model, states)
    model = replace(model, sensors=tuple(each for each, reason in zip(sensors, reasons, strict=True) if not reason))
    values = _readings(model, states, acting)
    changes = [np.zeros_like(value) for value in values]
    for pair in _changed(model, states, acting, truth):
        moved = [_readings(model, *each) for each in pair]
        for total, *each in zip(changes, values, *moved, strict=True):
            total += np.max([np.abs(one - each[0]) for one in each[1:]], axis=0)
    known = ~_impacts(model, states, truth)
    rows = iter(zip(values, changes, _evaluated(model, states, acting, terms), strict=True))
    return tuple(
        without(sensor, reason) if reason else with_bounds(truth, *next(rows), known)
        for sensor, reason in zip(sensors, reasons, strict=True)
    )


@dataclass(frozen=True, eq=False)
class _Model:
    """The equations of a scene, and the sensors in it of which there is a model."""

    written: Equations
    sensors: tuple[Sensor, ...]


def _reasons(model: _Model, states: WideArray) -> list[str]:
    """Return why there is no model of each sensor at states (n, c + u); empty if there is one."""
    solved, reasons = solution(model.written, states), []
    for sensor in model.sensors:
        try:
            require_modelled(model.written, solved, sensor)
            reasons.append("")
        except NotModelled as error:
            reasons.append(str(error))
    return reasons


def _readings(model: _Model, states: WideArray, acting: Acting | None) -> list[WideArray]:
    """The readings (n, k) of the sensors at states (n, c + u)."""
    return _evaluated(model, states, acting, reading)


def _evaluated(model: _Model, states: WideArray, acting: Acting | None, of_sensor: Callable[..., WideArray]) -> list[WideArray]:
    """The values (n, k) of a function with the arguments of `reading` for the sensors at states (n, c + u)."""
    written = model.written
    exerted = None if acting is None else efforts(written, states, acting)
    size = max(1, MOST_ENTRIES // max(1, len(written.linkage.inertia) ** 2))
    parts: list[list[WideArray]] = []
    for first in range(0, len(states), size):
        rows = slice(first, first + size)
        here = None if exerted is None else exerted[rows]
        solved = solution(written, states[rows], here)
        moving = kinetics(written, solved)
        parts.append([of_sensor(written, solved, moving, here, sensor) for sensor in model.sensors])
    return [np.concatenate(part) for part in zip(*parts, strict=True)]


def _changed(
    model: _Model, states: WideArray, acting: Acting | None, truth: Truth
) -> Iterator[tuple[tuple[WideArray, Acting | None], tuple[WideArray, Acting | None]]]:
    """Yield the states and efforts with one quantity changed by the bound of its error, in both directions."""
    written, linkage = model.written, model.written.linkage
    velocity = states[:, linkage.coordinates :]
    shifts, slips = _errors(written, states, truth)
    at_rest = (velocity == 0) & (written.friction > 0)
    for index, (held, moving) in written.single.items():
        for _, closed in closed_sides(written.mechanism.joints[index], states[:, held], velocity[:, moving]):
            shifts[:, moving], at_rest[:, moving] = np.where(closed, 0, shifts[:, moving]), at_rest[:, moving] | closed
    slips = np.where(at_rest, 0, slips)
    for column, row in zip(written.independent, written.shares.T, strict=True):
        for size, first in ((shifts[:, column], True), (slips[:, column], False)):
            if not size.any():
                continue
            along = size[:, None] * row
            pair = []
            for sign in (1, -1):
                moved = states.copy()
                if first:
                    moved[:, : linkage.coordinates] += sign * coordinate_rates(linkage, states, along)
                else:
                    moved[:, linkage.coordinates :] += sign * along
                pair.append((moved, acting))
            yield pair[0], pair[1]
    nudges = [] if acting is None else nudged(acting)
    for one, other in zip(nudges[::2], nudges[1::2], strict=True):
        yield (states, one), (states, other)


def _errors(written: Equations, states: WideArray, truth: Truth) -> tuple[WideArray, WideArray]:
    """The bounds (n, u) of the errors of the coordinates along each velocity, and of the velocities themselves."""
    linkage, bounds = written.linkage, truth.bounds
    shifts, slips = (np.zeros((len(states), len(linkage.inertia)), dtype=Wide) for _ in range(2))
    free = [body for body, joint in enumerate(written.mechanism.joint_of) if joint is None]
    for index, element in enumerate(linkage.elements):
        shift, slip = bounds.error, bounds.angular_velocity_error
        if element.kind == "slide":
            shift, slip = bounds.position_error, bounds.velocity_error
            if element.joint is None:  # the origin of the frame of a free body, whose centre of mass has the bounds
                body = next(body for body in free if linkage.ends[body] >= index)
                arm = float(np.sqrt((linkage.centre[body] ** 2).sum()))
                rate = np.sqrt((of_bodies(truth.trajectory).angular_velocity[body] ** 2).sum(axis=1))
                shift = shift + arm * bounds.error
                slip = slip + arm * (bounds.angular_velocity_error + rate * bounds.error)
        shifts[:, element.moving], slips[:, element.moving] = shift[:, None], slip[:, None]
    return shifts, slips


def _impacts(model: _Model, states: WideArray, truth: Truth) -> NDArray[np.bool_]:
    """Return whether a joint hits a rigid stop at each instant (n,), within the bound of its coordinate."""
    written = model.written
    shifts, _ = _errors(written, states, truth)
    hits = np.zeros(len(states), dtype=bool)
    for index, (held, moving) in written.single.items():
        stops = written.mechanism.joints[index].stops
        if stops is None or not stops.rigid:
            continue
        q, v = states[:, held], states[:, written.linkage.coordinates + moving]
        for side, limit in ((1, stops.upper), (-1, stops.lower)):
            if limit is not None:
                hits |= (side * v > 0) & (side * (q - Wide(limit)) >= -shifts[:, moving])
    return hits
