"""Read sensors in Simbody by OpenSim: its IMU, and what its joints, actuators and contacts report.

- accelerometer, gyroscope: the signals of OpenSim's `IMU` on a frame at the sensor's pose.
- velocimeter: OpenSim has no such sensor. Its frames have velocities in the ground, and express them along their own axes.
- force_torque: `calcReactionOnChildExpressedInGround` of the joint, about the origin of the child's frame and along the axes of
  the ground; a joint has no reaction along other axes.
- joint_effort: what the actuator of the coordinate reports, plus the constant force on the coordinate.
- contact_force: the record of the contact force, along the axes of the ground.

All of them are computed from the present state when it is realized to accelerations, after a step as well as after a reset, so
that there is no other forward pass.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import Method
from bodycheck.adapters.simbody.mechanisms import Built
from bodycheck.adapters.simbody.touching import Touching
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: A function that returns the reading (k,) of a sensor in a state that is realized to accelerations.
Reading = Callable[[Any], Array]


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why OpenSim does not read a sensor, as `Sensing.lacking` does."""
    if sensor.type == "contact_force" and not touches(scene) and (isinstance(scene, Mechanism) or scene.plane is None):
        return "has no contacts in the model of this scene"
    if sensor.type == "joint_effort" and isinstance(scene, Mechanism) and sensor.joint is not None:
        joint = scene.joints[sensor.joint]
        if not joint.effort and sensor.joint not in scene.driven:
            return f"has no force on the coordinate of the joint {joint.name}"
    return None


def on_body(model: Any, sensors: Sequence[Sensor]) -> list[Reading]:
    """Add sensors to the model of a single body, and return the functions that read them."""
    body = model.getBodySet().get("body")
    return [
        contact(opensim.HuntCrossleyForce.safeDownCast(model.getForceSet().get("contact")))
        if sensor.type == "contact_force"
        else mounted(model, body, number, sensor)
        for number, sensor in enumerate(sensors)
    ]


def on_touching(touched: Touching, sensors: Sequence[Sensor]) -> list[Reading]:
    """Add sensors to the model of bodies that touch, and return the functions that read them."""

    def contact_force(body: int) -> Reading:
        signs = [(1 if pair[1] == body else -1, pair) for pair in touched.forces if body in pair]
        return lambda state: sum((sign * touched.force(state, pair) for sign, pair in signs), start=np.zeros(3))

    return [
        contact_force(sensor.body)
        if sensor.type == "contact_force"
        else mounted(touched.model, touched.bodies[sensor.body], number, sensor)
        for number, sensor in enumerate(sensors)
    ]


def on_joints(mechanism: Mechanism, built: Built, sensors: Sequence[Sensor]) -> list[Reading]:
    """Add sensors to the model of a mechanism, and return the functions that read them."""
    readings = []
    for number, sensor in enumerate(sensors):
        if sensor.type == "force_torque":
            readings.append(reaction(built.joints[sensor.body]))
        elif sensor.type == "joint_effort":
            readings.append(effort(mechanism, built, sensor))
        else:
            readings.append(mounted(built.model, built.bodies[sensor.body], number, sensor))
    return readings


def reader(model: Any, readings: Sequence[Reading]) -> Callable[[Any], tuple[Array, ...]]:
    """Return the function that reads sensors of a model in a state."""

    def read(state: Any) -> tuple[Array, ...]:
        model.realizeAcceleration(state)
        return tuple(reading(state) for reading in readings)

    return read


def mounted(model: Any, body: Any, number: int, sensor: Sensor) -> Reading:
    """Add the frame of a sensor that is mounted on a body, and its IMU, to a model, and return the function that reads it."""
    turn = opensim.Rotation(opensim.Quaternion(*nearest_turn(sensor.attitude)))
    frame = opensim.PhysicalOffsetFrame(f"sensor_{number}", body, opensim.Transform(turn, opensim.Vec3(*sensor.position)))
    body.addComponent(frame)
    if sensor.type == "velocimeter":
        ground = model.getGround()
        return lambda state: np.array(
            ground.expressVectorInAnotherFrame(state, frame.getLinearVelocityInGround(state), frame).to_numpy()
        )
    imu = opensim.IMU()
    imu.setName(f"imu_{number}")
    imu.connectSocket_frame(frame)
    model.addComponent(imu)
    if sensor.type == "accelerometer":
        return lambda state: np.array(imu.calcAccelerometerSignal(state).to_numpy())
    return lambda state: np.array(imu.calcGyroscopeSignal(state).to_numpy())


def reaction(joint: Any) -> Reading:
    """Return the function that reads the force and moment on the child of a joint."""

    def read(state: Any) -> Array:
        moment_and_force = joint.calcReactionOnChildExpressedInGround(state)
        return np.concatenate([moment_and_force.get(1).to_numpy(), moment_and_force.get(0).to_numpy()])

    return read


def effort(mechanism: Mechanism, built: Built, sensor: Sensor) -> Reading:
    """Return the function that reads the effort at a joint, which is that of its actuator and that of a constant force."""
    forces: list[Callable[[Any], float]] = []
    if sensor.joint in mechanism.driven:
        forces.append(built.actuators[mechanism.driven.index(sensor.joint)].getActuation)
    if sensor.joint is not None and mechanism.joints[sensor.joint].effort:
        force = built.model.getForceSet().get(f"effort_{sensor.body}")
        forces.append(opensim.ExpressionBasedCoordinateForce.safeDownCast(force).getForceMagnitude)
    return lambda state: np.array([sum(force(state) for force in forces)])


def contact(force: Any) -> Reading:
    """Return the function that reads the force of a contact on the body of a scene."""

    def read(state: Any) -> Array:
        labels, record = force.getRecordLabels(), force.getRecordValues(state)
        named = {labels.get(index).rpartition("body.")[2]: record.get(index) for index in range(labels.size())}
        return np.array([named[f"force.{axis}"] for axis in "XYZ"])

    return read
