"""Read PyBullet's sensors: the force and torque sensors of its joints, and the forces of its contacts.

A force and torque sensor is that of `enableJointForceTorqueSensor`, which `getJointState` reads. PyBullet has its moment about
the centre of mass of the link; with `JOINT_FEEDBACK_IN_JOINT_FRAME`, which is set here because its guide offers it for joints,
about the origin of the joint. Both vectors are along Bullet's frame of the link, which is that of its principal axes. The
force of contacts is the sum of the normal and lateral forces of `getContactPoints`, each along its direction.

Both belong to the last step, and are zero after a reset. PyBullet has neither inertial sensors nor accelerations of links. It
reports the torques of its motors, but not torques that are set.
"""

from collections.abc import Callable, Sequence

import numpy as np
import pybullet

from bodycheck.adapters.contract import Method
from bodycheck.adapters.pybullet.mechanisms import Part
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.sensors.sensor import Sensor, SensorType
from bodycheck.reference.trajectory import Array

#: Why PyBullet does not read a type of sensor.
LACKING: dict[SensorType, str] = {
    "accelerometer": "has no accelerometer, and no function that returns the acceleration of a link",
    "gyroscope": "has no gyroscope; its angular velocities are states",
    "velocimeter": "has no velocimeter; its velocities are states",
    "joint_effort": "reports the torques of its motors, and not torques that are set (TORQUE_CONTROL)",
}


def lacking(_scene: AnyScene, sensor: Sensor, _method: Method) -> str | None:
    """Return why PyBullet does not read a sensor, as `Sensing.lacking` does."""
    return LACKING.get(sensor.type)


def reader(client: int, parts: Sequence[Part], sensors: Sequence[Sensor]) -> Callable[[], tuple[Array, ...]]:
    """Switch on sensors of the bodies of a physics server, and return the function that reads them."""
    # The frame of these sensors is a setting of the process, and not of the server.
    frame = pybullet.JOINT_FEEDBACK_IN_JOINT_FRAME
    pybullet.setPhysicsEngineParameter(jointFeedbackMode=frame, physicsClientId=client)
    for sensor in sensors:
        if sensor.type == "force_torque":
            part = parts[sensor.body]
            pybullet.enableJointForceTorqueSensor(part.tree, part.link, True, physicsClientId=client)

    def read() -> tuple[Array, ...]:
        return tuple(
            (wrench if sensor.type == "force_torque" else contact_force)(client, parts[sensor.body]) for sensor in sensors
        )

    return read


def wrench(client: int, part: Part) -> Array:
    """Return the force and the moment (6,) in the joint of a body."""
    return np.array(pybullet.getJointState(part.tree, part.link, physicsClientId=client)[2])


def contact_force(client: int, part: Part) -> Array:
    """Return the sum (3,) of the forces of the contacts of a body."""
    force = np.zeros(3)
    for point in pybullet.getContactPoints(bodyA=part.tree, linkIndexA=part.link, physicsClientId=client):
        normal, first, second = (np.array(point[index]) for index in (7, 11, 13))
        force += point[9] * normal + point[10] * first + point[12] * second
    return force
