"""The truth of sensors on bodies that touch a plane: of round bodies, of flat bodies, and at rest.

The kind of motion at each instant is that of the truth: a body is in flight, rolls, slips, slides or rests. With the normal
force N and the friction mu, a body that slips with the velocity u at its point or face has the friction -mu N u/|u|. A sphere,
or a cylinder across its axis, that rolls is held by the force that keeps u zero. A body that slides and spins at once on its
face has the friction of `sliding`, in two ways whose difference is part of the bound.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.bodies import bodies, of_bodies
from bodycheck.reference.contact.flat.face import face_of
from bodycheck.reference.contact.problem import Problem, problem
from bodycheck.reference.contact.round.alone import cylinder, sphere
from bodycheck.reference.contact.round.ball import Ball, ball
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP, Wide, wide
from bodycheck.reference.exact.pairs import WideArray
from bodycheck.reference.kinematics import cross, dot, multiply
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.loops.vectors import apply, matrices
from bodycheck.reference.mechanisms.mechanism import JointedBody
from bodycheck.reference.requirements import slides
from bodycheck.reference.scene import Cylinder, Ellipsoid, Scene, Sphere
from bodycheck.reference.sensors.bounding import NEAR, with_bounds, without
from bodycheck.reference.sensors.kinetics import on_body, with_accelerations
from bodycheck.reference.sensors.readings import SensorTruth
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.sliding import quadrature
from bodycheck.reference.sliding.balance import direction_of_first_axis
from bodycheck.reference.sliding.friction import friction
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth

#: A function from states (b, n, ...) at the instants of a truth to the accelerations (b, n, 3) of the centres of mass (m/s^2)
#: and the angular accelerations (b, n, 3), rad/s^2, both along the axes of the world.
Accelerations = Callable[[Trajectory], tuple[WideArray, WideArray]]


def touching_truth(truth: Truth, sensors: Sequence[Sensor]) -> tuple[SensorTruth, ...]:
    """Return the true readings of sensors on bodies that touch, at the instants of a truth, with bounds."""
    ways: tuple[Accelerations, ...] = (_at_rest,)
    reason = ""
    try:
        ways = accelerations_of(truth)
    except NotModelled as error:  # only the sensors that read no acceleration and no force are modelled
        reason = str(error)
    modelled = [sensor for sensor in sensors if not reason or sensor.type in ("gyroscope", "velocimeter")]
    readings = iter(_with_bounds(truth, modelled, ways))
    return tuple(next(readings) if sensor in modelled else without(sensor, reason) for sensor in sensors)


def _with_bounds(truth: Truth, sensors: Sequence[Sensor], ways: Sequence[Accelerations]) -> list[SensorTruth]:
    """Return the true readings of sensors with bounds, by accelerations in one way or several ways."""
    states = of_bodies(truth.trajectory)
    values, *others = [_readings(truth, sensors, states, way) for way in ways]
    changes = [np.zeros_like(value) for value in values]
    for other in others:
        for total, value, each in zip(changes, values, other, strict=True):
            total += np.abs(each - value)
    for pair in _changed(truth, states):
        moved = [_readings(truth, sensors, each, ways[0]) for each in pair]
        for total, value, one, other in zip(changes, values, *moved, strict=True):
            total += np.maximum(np.abs(one - value), np.abs(other - value))
    known = ~_impacts(truth)
    return [with_bounds(truth, value, change, np.abs(value), known) for value, change in zip(values, changes, strict=True)]


def _readings(truth: Truth, sensors: Sequence[Sensor], states: Trajectory, way: Accelerations) -> list[WideArray]:
    """The readings (n, k) of sensors at states (b, n, ...)."""
    moving = with_accelerations(states, *way(states))
    forces = forces_of(truth, moving.acceleration)
    readings = []
    for sensor in sensors:
        given, centre = bodies(truth.scene)[sensor.body].given, np.zeros(3)
        if isinstance(given, JointedBody):
            centre = np.array(exact.nearest_inertia(given).centre)
        arm = np.array(sensor.position, dtype=Wide) - centre
        mounted = sensor.form.mounted
        readings.append(on_body(sensor, arm, truth.scene.gravity, moving) if mounted else forces[sensor.body])
    return readings


def _changed(truth: Truth, states: Trajectory) -> Iterator[tuple[Trajectory, Trajectory]]:
    """Yield the states with a component of each body's attitude or velocities changed by the bound of its error, both ways."""
    bounds = truth.bounds
    for axis in np.eye(3):
        turns = [
            np.concatenate([np.ones((len(states), 1)), sign / 2 * bounds.error[:, None] * axis], axis=1).astype(Wide)
            for sign in (1, -1)
        ]
        turned: list[Any] = [multiply(states.quaternion.astype(Wide), each[None]) for each in turns]
        yield replace(states, quaternion=turned[0]), replace(states, quaternion=turned[1])
        for name in ("velocity", "angular_velocity"):
            shift, moving = getattr(bounds, f"{name}_error")[:, None] * axis, getattr(states, name).astype(Wide)
            yield replace(states, **{name: moving + shift}), replace(states, **{name: moving - shift})


def _impacts(truth: Truth) -> NDArray[np.bool_]:
    """Return whether an impact happens at each instant (n,), within the bound of its time."""
    hits = np.zeros(len(truth.trajectory), dtype=bool)
    for event in truth.events:
        if event.kind == "impact":
            hits |= np.abs(truth.trajectory.t - event.time) <= event.error
    return hits


def accelerations_of(truth: Truth) -> tuple[Accelerations, ...]:
    """Return the accelerations as a function of the states, in the kind of motion that the truth has at each instant.

    Several functions are several ways to the same accelerations. Raises `NotModelled` for other motions of bodies that touch.
    """
    scene = truth.scene
    if truth.interfaces:
        return (_at_rest,)
    if isinstance(scene, Scene) and scene.plane is not None:
        if slides(scene):
            return lambda states: _sliding(scene, states), lambda states: _sliding_by_law(scene, states)
        task = problem(scene)
        if not scene.pushes and (rolling := _rolling(task)) is not None:
            return (lambda states: _round(scene, truth, rolling, states),)
        if face_of(task.bodies[0]) is not None and not np.nan_to_num(truth.trajectory.angular_velocity).any():
            return (lambda states: _flat(scene, truth, states),)
    raise NotModelled("accelerations and forces of such a motion of bodies that touch")


def forces_of(truth: Truth, accelerations: WideArray) -> WideArray:
    """The resultants (b, n, 3) of contacts on bodies with accelerations (b, n, 3) at the instants of a truth, world (N)."""
    masses = np.array([body.mass for body in bodies(truth.scene)], dtype=Wide)[:, None, None]
    forces: WideArray = masses * (accelerations + np.array([0, 0, truth.scene.gravity], dtype=Wide))
    return forces - np.stack([_pushes(truth, body) for body in range(len(masses))])


def _pushes(truth: Truth, body: int) -> WideArray:
    """The sum (n, 3) of the pushes on a body at the instants of a truth, world (N)."""
    t, total = truth.trajectory.t, np.zeros((len(truth.trajectory), 3), dtype=Wide)
    for push in truth.scene.pushes:
        if push.body == body:
            total += np.where(((t >= push.start) & (t < push.end))[:, None], np.array(push.force, dtype=Wide), 0)
    return total


def _at_rest(states: Trajectory) -> tuple[WideArray, WideArray]:
    still = np.zeros(states.position.shape, dtype=Wide)
    return still, still


def _rolling(task: Problem) -> Ball | None:
    """The round body of a problem: a sphere, or a cylinder on its side; None for any other problem."""
    if all(way(task, np.zeros(1)) is None for way in (sphere, cylinder)):
        return None
    match (body := task.bodies[0]).shape:
        case Cylinder(radius, _):
            return ball(task, body, radius, body.moments[2])
        case Sphere(radius) | Ellipsoid((radius, _, _)):
            return ball(task, body, radius, body.moments[0])
    return None


def _axes(scene: Scene) -> tuple[WideArray, WideArray]:
    """The unit normal (3,) of the plane and its direction downhill (3,), world."""
    assert scene.plane is not None
    cosine, sine = MP.cos_sin(MP.mpf(scene.plane.incline))
    zero = Wide(0)
    return np.array([wide(sine), zero, wide(cosine)]), np.array([wide(cosine), zero, -wide(sine)])


def _round(scene: Scene, truth: Truth, rolling: Ball, states: Trajectory) -> tuple[WideArray, WideArray]:
    """The accelerations of a round body."""
    normal, downhill = _axes(scene)
    flies, rolls = _phases(scene, truth, rolling)
    slip = _slip(rolling, normal, states)
    size = np.sqrt(dot(slip, slip))[:, None]
    # A body that is released on a slope too steep to roll begins to slip downhill.
    direction = np.where(size > 0, slip / np.where(size > 0, size, 1), downhill if rolling.downhill else np.zeros(3))
    held = -rolling.downhill * rolling.ratio / (1 + rolling.ratio) * downhill
    pull = np.where(rolls[:, None], held, -rolling.braking * direction)
    pull = np.where(flies[:, None], 0, pull)
    turning = cross(np.broadcast_to(-normal, pull.shape), pull) / (rolling.ratio * rolling.radius)
    falling = np.where(flies, -rolling.onto, 0)[:, None] * normal
    return (rolling.downhill * downhill + pull + falling)[None], turning[None]


def _slip(rolling: Ball, normal: WideArray, states: Trajectory) -> WideArray:
    """The velocity (n, 3) of the point of contact of a round body along the plane, world (m/s)."""
    velocity = states.velocity[0].astype(Wide)
    spin = apply(matrices(states.quaternion[0].astype(Wide)), states.angular_velocity[0].astype(Wide))
    along = velocity - dot(velocity, normal)[:, None] * normal
    slip: WideArray = along - rolling.radius * cross(spin, np.broadcast_to(normal, spin.shape))
    return slip


def _phases(scene: Scene, truth: Truth, rolling: Ball) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return whether a round body is in flight, and whether it rolls or rests, at each instant (n,) of a truth."""
    trajectory, bounds, (normal, _) = truth.trajectory, truth.bounds, _axes(scene)
    height = np.abs(dot(trajectory.position, normal.astype(float)) - float(rolling.radius))
    rise = np.abs(dot(trajectory.velocity, normal.astype(float)))
    flies = (height > NEAR * bounds.position_error) | (rise > NEAR * bounds.velocity_error)
    rates = np.sqrt(dot(trajectory.angular_velocity, trajectory.angular_velocity))
    doubt = bounds.velocity_error + float(rolling.radius) * (bounds.angular_velocity_error + rates * bounds.error)
    slip = _slip(rolling, normal, of_bodies(trajectory))
    return flies, ~flies & rolling.grips & (np.sqrt(dot(slip, slip)) <= NEAR * doubt)


def _flat(scene: Scene, truth: Truth, states: Trajectory) -> tuple[WideArray, WideArray]:
    """The accelerations of a block that slides without turning, or rests."""
    assert scene.plane is not None
    normal, _ = _axes(scene)
    drive = _pushes(truth, 0) / Wide(scene.body.mass) - np.array([0, 0, scene.gravity], dtype=Wide)
    press = -dot(drive, normal)
    drive = drive + press[:, None] * normal
    velocity, moves = states.velocity[0].astype(Wide), _moves(truth)
    velocity = np.where(moves[:, None], velocity - dot(velocity, normal)[:, None] * normal, drive)
    size = np.sqrt(dot(velocity, velocity))
    brake = press * Wide(scene.plane.friction) if math.isfinite(scene.plane.friction) else np.full_like(press, np.inf)
    rests = ~moves & (size <= brake * (1 + 8 * np.finfo(Wide).eps))
    braking = np.where(rests, 0, np.where(np.isfinite(brake), brake, 0) / np.where(size > 0, size, 1))
    accelerated = np.where(rests[:, None], 0, drive - braking[:, None] * velocity)
    accelerated = np.where(np.isnan(truth.trajectory.position), np.nan, accelerated)
    return accelerated[None], np.zeros((1, len(truth.trajectory), 3), dtype=Wide)


def _moves(truth: Truth) -> NDArray[np.bool_]:
    """Return whether a body slides at each instant (n,) of a truth."""
    velocity = truth.trajectory.velocity
    return np.asarray(np.sqrt(dot(velocity, velocity)) > NEAR * truth.bounds.velocity_error)


def _sliding(scene: Scene, states: Trajectory) -> tuple[WideArray, WideArray]:
    """The accelerations of a body that slides on its face on a level plane, by quadrature over the face."""
    flat = quadrature.flat(scene)
    velocity, rate = states.velocity[0].astype(float), states.angular_velocity[0, :, 2].astype(float)
    yaw = direction_of_first_axis(states.quaternion[0].astype(float))
    planar = quadrature.accelerations(flat, yaw, np.column_stack([velocity[:, :2], flat.gyration * rate])).astype(Wide)
    return _in_space(planar[:, :2], planar[:, 2] / flat.gyration)


def _sliding_by_law(scene: Scene, states: Trajectory) -> tuple[WideArray, WideArray]:
    """The accelerations of a body that slides on its face on a level plane, by the closed forms of friction."""
    assert scene.plane is not None
    law = friction(scene.body, scene.plane, scene.gravity)
    yaw = direction_of_first_axis(states.quaternion[0].astype(float))
    turn = np.exp(1j * yaw)
    velocity, rate = states.velocity[0].astype(float), states.angular_velocity[0, :, 2].astype(float)
    along = (velocity[:, 0] + 1j * velocity[:, 1]) / turn
    rows = [
        law(float(v.real), float(v.imag), float(w)) if v or w else (0.0, 0.0, 0.0) for v, w in zip(along, rate, strict=True)
    ]
    forces = np.array(rows).reshape(-1, 3)
    pull = (forces[:, 0] + 1j * forces[:, 1]) * turn / scene.body.mass
    return _in_space(np.column_stack([pull.real, pull.imag]).astype(Wide), forces[:, 2] / Wide(scene.body.moments[2]))


def _in_space(planar: WideArray, turning: WideArray) -> tuple[WideArray, WideArray]:
    """Accelerations in space (1, n, 3) from those along the plane (n, 2) and about its normal (n,)."""
    zero = np.zeros_like(turning)
    return np.column_stack([planar, zero])[None], np.column_stack([zero, zero, turning])[None]
