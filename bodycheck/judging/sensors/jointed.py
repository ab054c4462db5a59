"""The conventions of sensors of joints and of contacts, and the frames of bodies."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from bodycheck.judging.sensors.laws import Frame, Laws, Source, differences, largest, laws
from bodycheck.judging.sensors.past import Past
from bodycheck.reference.bodies import bodies
from bodycheck.reference.kinematics import conjugate, dot, multiply, rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.sensors.errors import FORCE, MOMENT
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: The quaternion of the world's axes.
_NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])


def frames_of_body(past: Past, body: int) -> dict[Frame, Array]:
    """Return the quaternions (lags, n, 4) to the world from a body's axes, from the frame of its joint, and from the world."""
    frames: dict[Frame, Array] = {"body": past.states.quaternion[body][past.rows]}
    joint = past.scene.joint_of[body] if isinstance(past.scene, Mechanism) else None
    if joint is not None:
        fixed = np.broadcast_to(np.array(exact.nearest_turn(joint.attitude)), frames["body"].shape)
        parent = fixed if joint.parent == WORLD else multiply(past.states.quaternion[joint.parent][past.rows], fixed)
        frames["joint"] = parent
    frames["world"] = np.broadcast_to(_NO_TURN, frames["body"].shape)
    return frames


def contact_force(past: Past, sensor: Sensor, values: Array) -> Laws:
    """Return the conventions of the force of contacts on a body, which should be `values` (lags, n, 3)."""
    frames = frames_of_body(past, sensor.body)
    return laws(past, {"solver": values}, {"world": frames.pop("world"), **frames})


def joint_effort(past: Past, sensor: Sensor, values: Array) -> Laws:
    """Return the conventions of the effort of a joint, which should be `values` (lags, n, 1)."""
    mechanism, number = _joint_of(past, sensor)
    joint, motion = mechanism.joints[number], kinematics.joints(mechanism, past.states)
    held, moving = (slices.start for slices in places(mechanism)[number])
    position, velocity = motion.position[past.rows, held], motion.velocity[past.rows, moving]
    passive = -joint.stiffness * (position - joint.rest) - joint.damping * velocity
    return laws(past, {"solver": values}, {}, {"with spring and damping": passive[..., None]})


def wrench(past: Past, sensor: Sensor, values: Array, part: slice) -> Laws:
    """Return the conventions of the force or the moment of a joint's wrench, which should be `values` (lags, n, 6).

    part: `FORCE` or `MOMENT`.
    """
    mechanism, number = _joint_of(past, sensor)
    joint, rows, h = mechanism.joints[number], past.rows, past.timestep
    bodies_beyond = beyond(mechanism, joint.child)
    weight = np.zeros((len(past.states.position), *past.linear.shape[1:]))
    weight[..., 2] = mechanism.gravity
    weight = _resultant(past, joint.child, bodies_beyond, weight[:, rows], np.zeros_like(weight)[:, rows])[..., part]
    departures = {"gravity with the other sign": -2 * weight, "without gravity": -weight}
    if part == MOMENT:
        centre = np.array(exact.nearest_inertia(mechanism.bodies[joint.child]).centre)
        departures["about the centre of mass"] = -np.cross(centre, values[..., FORCE])
    if joint.type in ("revolute", "prismatic") and part == (MOMENT if joint.type == "revolute" else FORCE):
        axis = np.array(exact.nearest_axis(joint))
        armature = joint.armature * joint_acceleration(past, joint)[rows]
        departures["with the armature"] = armature[..., None] * axis
        departures["without the component along the axis"] = -dot(values[..., part], axis)[..., None] * axis
    sources: dict[Source, Array] = {"solver": values[..., part]}
    delayed: dict[Source, Array] = {}
    if h:
        since = [exactly[:, rows] - exactly[:, rows[:1]] for exactly in (past.linear, past.angular)]
        present = replace(past, rows=np.broadcast_to(rows[:1], rows.shape))
        delayed["velocities"] = (values[:1] + _resultant(present, joint.child, bodies_beyond, *since))[..., part]
        linear, angular = past.states.velocity[:, rows], past.states.angular_velocity[:, rows]
        changes = [
            np.stack([differences(one)[:2] / h for one in each]) - exactly[:, rows][:, :2]
            for each, exactly in ((linear, past.linear), (angular, past.angular))
        ]
        sources["velocities"] = values[:2, ..., part] + _resultant(past, joint.child, bodies_beyond, *changes)[..., part]
    size = largest(np.linalg.norm(weight, axis=-1))
    differenced: dict[Source, float] = {"velocities": size * largest(past.states.velocity) / h} if h else {}
    return laws(past, sources, frames_of_body(past, joint.child), departures, None, size, differenced, delayed)


def beyond(mechanism: Mechanism, body: int) -> list[int]:
    """Return the indices of a body and of all bodies that hang on it."""
    return [body, *(index for joint in mechanism.joints if joint.parent == body for index in beyond(mechanism, joint.child))]


def joint_acceleration(past: Past, joint: Joint) -> Array:
    """Return the acceleration (N,) of the coordinate of a revolute or prismatic joint (rad/s^2 or m/s^2)."""
    child, parent = partial(_point_acceleration, past, joint.child), partial(_point_acceleration, past, joint.parent)
    turn = past.states.quaternion[joint.child]
    axis = rotate(turn, np.broadcast_to(np.array(exact.nearest_axis(joint)), (*turn.shape[:-1], 3)))
    origin = _origin(past, joint.child)
    if joint.type == "prismatic":
        return dot(axis, child(origin) - parent(origin))
    return dot(axis, _angular(past, joint.child) - _angular(past, joint.parent))


def _joint_of(past: Past, sensor: Sensor) -> tuple[Mechanism, int]:
    """Return the mechanism and the index of the joint of a sensor of a joint."""
    assert isinstance(past.scene, Mechanism)
    assert sensor.joint is not None
    return past.scene, sensor.joint


def _origin(past: Past, body: int) -> Array:
    """Return the origin (N, 3) of a body's frame (m)."""
    assert isinstance(past.scene, Mechanism)
    turn = past.states.quaternion[body]
    centre = np.broadcast_to(np.array(exact.nearest_inertia(past.scene.bodies[body]).centre), (*turn.shape[:-1], 3))
    return past.states.position[body] - rotate(turn, centre)


def _angular(past: Past, body: int) -> Array:
    """Return the angular acceleration (N, 3) of a body or of the world, along the axes of the world (rad/s^2)."""
    if body == WORLD:
        return np.zeros_like(past.angular[0])
    return rotate(past.states.quaternion[body], past.angular[body])


def _point_acceleration(past: Past, body: int, points: Array) -> Array:
    """Return the accelerations (N, 3) of points (N, 3) that are fixed in a body or in the world (m/s^2)."""
    if body == WORLD:
        return np.zeros_like(points)
    rate = rotate(past.states.quaternion[body], past.states.angular_velocity[body])
    arm = points - past.states.position[body]
    return past.linear[body] + np.cross(_angular(past, body), arm) + np.cross(rate, np.cross(rate, arm))


def _resultant(past: Past, child: int, members: Sequence[int], linear: Array, angular: Array) -> Array:
    """Return the wrench (lags, n, 6) on a child for additional accelerations of the bodies beyond its joint.

    Parameters
    ----------
    past, child, members
        The past, the child of the joint, and the indices of the bodies beyond the joint.
    linear, angular
        The additional accelerations (b, lags, n, 3), as those of `Past`, at the first lags.
    """
    rows = past.rows[: linear.shape[1]]
    masses, origin = bodies(past.scene), _origin(past, child)[rows]
    force, moment = np.zeros(linear.shape[1:]), np.zeros(linear.shape[1:])
    for index in members:
        push = masses[index].mass * linear[index]
        turning = rotate(past.states.quaternion[index][rows], angular[index] @ masses[index].tensor)
        force += push
        moment += np.cross(past.states.position[index][rows] - origin, push) + turning
    back = conjugate(past.states.quaternion[child][rows])
    return np.concatenate([rotate(back, force), rotate(back, moment)], axis=-1)
