"""The readings that sensors should have at given states, at which the equations of motion hold."""

from collections.abc import Sequence

import numpy as np

from bodycheck.reference.bodies import of_bodies
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.mechanisms.loops.vectors import apply
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.sensors.equations import Equations, Solution, equations, solution, states_of
from bodycheck.reference.sensors.kinetics import Kinetics, kinetics, on_body, terms_on_body, with_accelerations
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.sensors.wrenches import require_unique, terms_of_wrench, wrench
from bodycheck.reference.trajectory import Array, Trajectory


def expected(scene: AnyScene, sensors: Sequence[Sensor], states: Trajectory, efforts: Array | None = None) -> tuple[Array, ...]:
    """Return what each sensor should read (n, k) at given states (n, ...) or (b, n, ...).

    Parameters
    ----------
    scene
        The scene.
    sensors
        The sensors.
    states
        The states, at which the equations of motion hold. The coordinates of joints follow from them.
    efforts
        (n, j) efforts of the controllers of the joints in `Mechanism.driven` (N m or N), without the forces of elastic stops,
        which follow from the states; zero if None.

    Returns
    -------
    tuple of arrays
        The readings. They are NaN if the reference has no model of a sensor; gyroscopes and velocimeters need none.

    Raises
    ------
    OutOfReach
        If it is undecided which joints at rest begin to move.
    """
    shape = (len(states),)
    if scene.plane is not None:
        no_motion = with_accelerations(of_bodies(states), *[np.full(of_bodies(states).position.shape, np.nan, Wide)] * 2)
        return tuple(
            on_body(sensor, np.array(sensor.position, Wide), scene.gravity, no_motion).astype(float)
            if sensor.form.mounted
            else np.full((*shape, len(sensor.form.components)), np.nan)
            for sensor in sensors
        )
    written = equations(scene)
    seen = of_bodies(states)
    solved = solution(written, states_of(written, seen), efforts)
    moving = kinetics(written, solved, seen)
    answers = []
    for sensor in sensors:
        try:
            require_modelled(written, solved, sensor)
            answers.append(reading(written, solved, moving, efforts, sensor).astype(float))
        except NotModelled:
            answers.append(np.full((*shape, len(sensor.form.components)), np.nan))
    return tuple(answers)


def accelerations(scene: AnyScene, states: Trajectory, efforts: Array | None = None) -> tuple[Array, Array]:
    """Return the accelerations at given states (n, ...) or (b, n, ...); the arguments are those of `expected`.

    Returns the accelerations (b, n, 3) of the centres of mass, world (m/s^2), and the angular accelerations (b, n, 3) along the
    axes of the bodies (rad/s^2).

    Raises `NotModelled` for bodies that touch a plane or each other.
    """
    if scene.plane is not None:
        raise NotModelled("accelerations of bodies that touch, from their states alone")
    written, seen = equations(scene), of_bodies(states)
    moving = kinetics(written, solution(written, states_of(written, seen), efforts), seen)
    turning = apply(np.swapaxes(moving.axes, 2, 3), moving.turning)
    return moving.acceleration.astype(float), turning.astype(float)


def require_modelled(written: Equations, solved: Solution, sensor: Sensor) -> None:
    """Raise `NotModelled` if the reference has no model of a sensor of a scene without contacts."""
    if sensor.type == "force_torque":
        require_unique(written, solved, sensor.body)


def reading(
    written: Equations, solved: Solution, moving: Kinetics, efforts: Array | WideArray | None, sensor: Sensor
) -> WideArray:
    """The readings (s, k) of a sensor of a scene without contacts. efforts: as of `expected`."""
    linkage = written.linkage
    if sensor.type == "contact_force":  # nothing touches
        return np.zeros((len(solved.states), 3), dtype=Wide)
    if sensor.type == "force_torque":
        return wrench(written, solved, moving, sensor.body)
    if sensor.type == "joint_effort":
        assert sensor.joint is not None  # a sensor of a joint
        constant = np.full((len(solved.states), 1), written.mechanism.joints[sensor.joint].effort, dtype=Wide)
        driven = written.mechanism.driven
        return (
            constant if efforts is None or sensor.joint not in driven else constant + efforts[:, [driven.index(sensor.joint)]]
        )
    return on_body(sensor, arm_of(written, sensor), float(linkage.gravity), moving)


def terms(
    written: Equations, solved: Solution, moving: Kinetics, efforts: Array | WideArray | None, sensor: Sensor
) -> WideArray:
    """The sizes (s, k) or (s, 1) of the terms that `reading` adds up; the arguments are the same."""
    if sensor.type == "force_torque":
        return terms_of_wrench(written, moving, sensor.body)
    if not sensor.form.mounted:
        return np.abs(reading(written, solved, moving, efforts, sensor))
    return terms_on_body(sensor, arm_of(written, sensor), float(written.linkage.gravity), moving)


def arm_of(written: Equations, sensor: Sensor) -> WideArray:
    """The place (3,) of a sensor relative to the centre of mass, in the frame of the body (m)."""
    centre = written.linkage.centre[sensor.body] if written.framed else np.zeros(3, dtype=Wide)
    return np.asarray(np.array(sensor.position, dtype=Wide) - centre)
