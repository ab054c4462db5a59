"""Read sensors in Drake: its sensor systems, and the output ports of its plant.

- accelerometer, gyroscope: Drake's systems `Accelerometer`, with the vector of gravity of the plant, and `Gyroscope`.
- velocimeter: Drake has no such system. The port of velocities of bodies has the velocity of a body's origin, which
  `SpatialVelocity.Shift` moves to the place of the sensor.
- force_torque: the port of reaction forces, on the child at the origin of its frame and along its axes.
- joint_effort: the port of net actuation, with an actuator at the joint of each such sensor.
- contact_force: the port of generalized contact forces of a free body, whose last three components are a force in the world.

The ports of a continuous plant are computed from its present state. Those of a discrete plant keep by default the values of its
last step, and are zero before the first one. With the option `sensors=forward`, they are configured to be computed from the
present state too (`use_sampled_output_ports = False`).
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform
from pydrake.systems.sensors import Accelerometer, Gyroscope

from bodycheck.adapters.contract import Method
from bodycheck.adapters.drake.mechanisms import body_name, joint_name
from bodycheck.adapters.drake.models import Model
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array

#: A function that returns a copy of the present reading (k,) of a sensor.
Reading = Callable[[], Array]


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why Drake does not read a sensor, as `Sensing.lacking` does."""
    if sensor.type == "contact_force" and scene.plane is None:
        return "has no contacts in the model of this scene"
    return None


def reader(model: Model, scene: AnyScene, sensors: Sequence[Sensor]) -> Callable[[], tuple[Array, ...]]:
    """Return the function that reads sensors in the model of a scene."""
    readings = [reading(model, scene, sensor) for sensor in sensors]
    return lambda: tuple(each() for each in readings)


def reading(model: Model, scene: AnyScene, sensor: Sensor) -> Reading:
    """Return the function that reads a sensor in the model of a scene."""
    plant = model.plant
    body = plant.GetBodyByName(body_name(sensor.body) if isinstance(scene, Mechanism) else "body")
    pose = RigidTransform(Quaternion(nearest_turn(sensor.attitude)), sensor.position)
    match sensor.type:
        case "accelerometer":
            return measured(Accelerometer(body, pose, plant.gravity_field().gravity_vector()), model)
        case "gyroscope":
            return measured(Gyroscope(body, pose), model)
        case "velocimeter":
            return speed(model, body, pose)
        case "force_torque":
            return reaction(model, plant.GetJointByName(joint_name(sensor.joint or 0)))
        case "joint_effort":
            start = plant.GetJointActuatorByName(joint_name(sensor.joint or 0)).input_start()
            return components(model, plant.get_net_actuation_output_port(), slice(start, start + 1))
        case "contact_force":
            port = plant.get_generalized_contact_forces_output_port(body.model_instance())
            return components(model, port, slice(3, 6))


def measured(system: Any, model: Model) -> Reading:
    """Return the function that reads one of Drake's sensor systems, whose inputs have the names of ports of the plant."""
    plant, context = model.plant, system.CreateDefaultContext()
    inputs = [system.get_input_port(index) for index in range(system.num_input_ports())]
    connected = [(port, plant.GetOutputPort(port.get_name())) for port in inputs]

    def read() -> Array:
        for port, output in connected:
            port.FixValue(context, output.Eval(model.context))
        return np.array(system.get_output_port().Eval(context))

    return read


def speed(model: Model, body: Any, pose: Any) -> Reading:
    """Return the function that reads the velocity of the origin of a pose on a body, along the axes of the pose."""
    plant, index = model.plant, body.index()

    def read() -> Array:
        turn = plant.get_body_poses_output_port().Eval(model.context)[index].rotation()
        velocity = plant.get_body_spatial_velocities_output_port().Eval(model.context)[index]
        shifted = velocity.Shift(turn.multiply(pose.translation()))
        return np.array(turn.multiply(pose.rotation()).inverse().multiply(shifted.translational()))

    return read


def reaction(model: Model, joint: Any) -> Reading:
    """Return the function that reads the force and moment on the child of a joint."""
    port, index = model.plant.get_reaction_forces_output_port(), joint.index()

    def read() -> Array:
        force = port.Eval(model.context)[index]
        return np.concatenate([force.translational(), force.rotational()])

    return read


def components(model: Model, port: Any, part: slice) -> Reading:
    """Return the function that reads some components of an output port of numbers."""
    return lambda: np.array(port.Eval(model.context)[part])
