"""Read what Rapier reports of bodies, joints and contacts, in a simulation of their own.

The angular velocity of a body, and the velocity of a point on it (`velocity_at_point`), are in the world frame. The wrench of a
joint is the sum of its impulses over the time step, along the axes of the joint's frame. With substeps, the impulses are those
of the last one. The force of contacts is the total impulse of the body's pairs over the time step. Rapier reports the impulses
along the normals of contacts there, without friction.

Rapier has no accelerations of bodies.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.adapters.rapier.mechanisms import turn_of
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

LACKING = {"accelerometer": "has no accelerations of bodies", "joint_effort": "has no efforts in joints"}


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why Rapier does not read a sensor, as `Sensing.lacking` does."""
    return LACKING.get(sensor.type)


def reader(
    scene: AnyScene, sensor: Sensor, point: Array, views: tuple[Any, Sequence[Any], Sequence[Any]], timestep: float
) -> Callable[[], Array]:
    """Return the function that reads a sensor.

    Parameters
    ----------
    scene, sensor
        The scene and the sensor.
    point
        The place (3,) of the sensor in Rapier's frame of its body.
    views
        Rapier's world, and its views of the bodies and of the joints.
    timestep
        The time step (s).
    """
    world, bodies, joints = views
    body = bodies[sensor.body]

    def velocity() -> Array:
        return np.array(body.velocity_at_point(body.position.transform_point(tuple(point.tolist()))).to_tuple())

    def wrench() -> Array:
        assert isinstance(scene, Mechanism)  # sensors of joints are only in mechanisms
        assert sensor.joint is not None
        parts = np.array(joints[sensor.joint].impulses).reshape(2, 3) / timestep
        # The adapter turns the joint's frame to have the axis along x; the turn back gives the joint's frame of the case.
        return rotate(turn_of(scene.joints[sensor.joint]), parts).ravel()

    def touch() -> Array:
        total = np.zeros(3)
        for pair in world.narrow_phase.contact_pairs():
            # The normals of a pair, and its impulse, point from the first to the second body.
            sign = (pair.collider2 in body.colliders) - (pair.collider1 in body.colliders)
            total += sign * np.array(pair.total_impulse().to_tuple())
        return total / timestep

    match sensor.type:
        case "gyroscope":
            return lambda: np.array(body.angvel.to_tuple())
        case "velocimeter":
            return velocity
        case "force_torque":
            return wrench
        case _:
            return touch
