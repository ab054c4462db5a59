"""Read what SAPIEN has of sensors: the incoming joint forces of articulations, and the impulses of contacts.

PhysX's incoming joint force of a link is along the axes of the joint in the child and about its origin, which is that of the
child's frame. The adapter turns these axes, so that the joint's axis is x, and turns the readings back to the child's frame.
The force of contacts is the sum of the impulses on a body divided by the time step; they have normal parts alone, and no
friction. Both belong to the last step, and are zero after a reset. SAPIEN has neither inertial sensors nor accelerations of
links on the CPU.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.adapters.sapien.mechanisms import turn_of
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.sensors.sensor import Sensor, SensorType
from bodycheck.reference.trajectory import Array

#: Why SAPIEN does not read a type of sensor.
LACKING: dict[SensorType, str] = {
    "accelerometer": "has no accelerometer, and no function that returns the acceleration of a link",
    "gyroscope": "has no gyroscope; its angular velocities are states",
    "velocimeter": "has no velocimeter; its velocities are states",
    "joint_effort": "has no sensor of efforts; qf has those that are set",
}


def lacking(scene: AnyScene, sensor: Sensor, _method: Method) -> str | None:
    """Return why SAPIEN does not read a sensor, as `Sensing.lacking` does."""
    if sensor.type == "contact_force" and isinstance(scene, Mechanism) and scene.plane is None:
        return "has no shapes of the bodies of mechanisms here"
    return LACKING.get(sensor.type)


def of_joints(mechanism: Mechanism, links: Sequence[Any], sensors: Sequence[Sensor]) -> Callable[[], tuple[Array, ...]]:
    """Return the function that reads force and torque sensors of a mechanism, from the links of its bodies."""
    sensed = [(links[sensor.body], turn_of(joint)) for sensor in sensors if (joint := mechanism.joint_of[sensor.body])]

    def read() -> tuple[Array, ...]:
        return tuple(wrench(link, turn) for link, turn in sensed)

    return read


def wrench(link: Any, turn: Array) -> Array:
    """Return the force and moment (6,) in the joint of a link, along the child's axes. turn: see `turn_of`."""
    force, moment = np.array(link.articulation.link_incoming_joint_forces[link.index], dtype=np.float64).reshape(2, 3)
    return np.concatenate([rotate(turn, force), rotate(turn, moment)])


def of_contacts(system: Any, bodies: Sequence[Any], sensors: Sequence[Sensor]) -> Callable[[], tuple[Array, ...]]:
    """Return the function that reads sensors of contacts of bodies in a scene of PhysX."""

    def read() -> tuple[Array, ...]:
        return tuple(contact_force(system, bodies[sensor.body]) for sensor in sensors)

    return read


def contact_force(system: Any, body: Any) -> Array:
    """Return the sum (3,) of the forces of the contacts of a body. The impulses of a contact act on its first body."""
    impulse: Array = np.zeros(3)
    for contact in system.get_contacts():
        sign = (contact.bodies[0] == body) - (contact.bodies[1] == body)
        for point in contact.points:
            impulse += sign * point.impulse
    return impulse / float(system.timestep)
