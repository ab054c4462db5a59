"""Read MuJoCo's sensors, in a simulation of their own.

A sensor of a case becomes sensors of MuJoCo in the XML of the scene: `accelerometer`, `gyro` and `velocimeter` at a site;
`force` and `torque` at a site in the child's frame; `jointactuatorfrc` for the effort of a joint; and `contact` with the net
force of all contacts of a body, in releases that have it. The efforts at joints are forces of motors here, because MuJoCo has
no sensor of applied and passive forces.

`mj_step` computes sensors with the accelerations at the start of the step, and then moves on: after a step they belong to its
start, in `RK4` to its first stage. `mj_forward` computes them for the present state.

The options `sensordelay` and `sensorinterval` are MuJoCo's delay of sensors and the interval between their readings, in steps.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np

from bodycheck.adapters.contract import Law, Method, Option, Range, SensingSimulation, Simulation
from bodycheck.adapters.mechanisms import massless_parts
from bodycheck.adapters.mujoco import mechanisms, single, touching
from bodycheck.adapters.mujoco.contact import numbers_written
from bodycheck.adapters.mujoco.driving import Actuated
from bodycheck.adapters.mujoco.models import MODELS_WITH_CONTACT, Joints, compiled_model
from bodycheck.adapters.mujoco.stepping import Stepper, external_force
from bodycheck.adapters.stepping import TakingLaws
from bodycheck.adapters.touching import Pushed, TouchingBody, touching_bodies
from bodycheck.reference.kinematics import multiply, rotate
from bodycheck.reference.mechanisms.exact import nearest_inertia, nearest_turn
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import free_bodies_touch, touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor, SensorType, split
from bodycheck.reference.trajectory import Array

#: MuJoCo's sensors at a site for a type of sensor.
AT_SITES: dict[SensorType, tuple[str, ...]] = {
    "accelerometer": ("accelerometer",),
    "gyroscope": ("gyro",),
    "velocimeter": ("velocimeter",),
    "force_torque": ("force", "torque"),
}

#: The most steps of a delay, of which MuJoCo keeps as many readings, and of an interval.
MOST_STEPS = 1000

STEPS = Option(f"a whole number of steps from 1 to {MOST_STEPS}", numbers=((Range(1, MOST_STEPS, whole=True),),))

#: The options of sensors; releases before 3.5 have none.
OPTIONS = {"sensordelay": STEPS, "sensorinterval": STEPS} if hasattr(mujoco.MjModel, "sensor_delay") else {}


@dataclass(frozen=True)
class Placed:
    """A sensor in MuJoCo's model.

    Attributes
    ----------
    sensor
        The sensor.
    part
        The name of the model's joint if the sensor is a joint_effort sensor, else of its body.
    position, attitude
        The pose of its axes in the frame of the model's body.
    """

    sensor: Sensor
    part: str
    position: Array
    attitude: Array


class Motors(Actuated):
    """The driven joints of a model, each with a motor, in data that is stepped.

    The callback of passive forces sets the efforts of laws, because MuJoCo computes passive forces before actuators.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, names: Sequence[str]) -> None:
        super().__init__(model, data, names)
        self.motors = [model.actuator(name).id for name in names]
        self.constant = data.ctrl[self.motors]
        self.held = self.constant

    def apply(self, efforts: Array) -> None:
        """Exert efforts (j,) from now on, in addition to the constant ones."""
        self.held = self.constant + efforts
        self.data.ctrl[self.motors] = self.held

    def force(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Exert the efforts of the law, as a callback of MuJoCo."""
        data.ctrl[self.motors] = self.held + self.law(data.time, data.qpos[self.in_q], data.qvel[self.in_v])


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why MuJoCo does not read a sensor, as `Sensing.lacking` does."""
    model = method.option("model")
    if sensor.type == "contact_force" and not hasattr(mujoco.mjtSensor, "mjSENS_CONTACT"):
        return "has no sensor of the force of contacts in this release"
    if isinstance(scene, Mechanism):
        if sensor.joint is not None and model == "free-bodies":
            return f"has no joint {scene.joints[sensor.joint].name} in the model {model}"
        if sensor.type != "joint_effort" and any(sensor.body in part for part in massless_parts(scene)):
            return f"has no body {scene.bodies[sensor.body].name}, which has no mass"
    elif sensor.type in ("accelerometer", "contact_force") and braked(scene, method):
        return f"has neither the weight nor the plane of the scene in the model {model}"
    return None


def braked(scene: Scene, method: Method) -> bool:
    """Return whether friction is an external force in the model of a scene, without a plane that bears the body."""
    return scene.plane is not None and not touches(scene) and single.model_of(scene, method) not in MODELS_WITH_CONTACT


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if free_bodies_touch(scene):
        return _touching(scene, sensors, method)
    if isinstance(scene, Mechanism):
        return _mechanism(scene, sensors, method)
    model = single.model_of(scene, method)
    xml, joints = description_of_body(scene, sensors, method, model)
    stepper = single.started(xml, joints)
    stepper.force = single.external_force(scene, method, model, stepper.data)
    return _sensing(stepper, stepper, sensors, method)


def description_of_body(scene: Scene, sensors: Sequence[Sensor], method: Method, model: str) -> tuple[str, Joints]:
    """Return the XML of a model of a single body with sensors, and its joints. Raises `SceneUnsupported`."""
    xml, joints = single.description(scene, method, model)
    turn = np.array(joints.turn)
    placed = [
        Placed(each, "body", rotate(turn, np.array(each.position)), multiply(turn, attitude_of(each))) for each in sensors
    ]
    return with_sensors(xml, placed, method), joints


def _touching(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of bodies that touch."""
    bodies = touching_bodies(scene)
    simulation = touching.started(scene, bodies, description_of_touching(scene, bodies, sensors, method), method)
    return reading_pushed(simulation, _sensing(simulation, simulation.simulation, sensors, method))


def description_of_touching(scene: AnyScene, bodies: Sequence[TouchingBody], sensors: Sequence[Sensor], method: Method) -> str:
    """Return the XML of bodies that touch, with sensors. Raises `SceneUnsupported`.

    The frames of the bodies have their origins at the centres of mass.
    """
    centres = [nearest_inertia(body).centre for body in scene.bodies] if isinstance(scene, Mechanism) else [(0.0, 0.0, 0.0)]
    placed = [
        Placed(each, bodies[each.body].name, np.subtract(each.position, centres[each.body]), attitude_of(each))
        for each in sensors
    ]
    return with_sensors(touching.document(scene, bodies, method), placed, method)


def reading_pushed(simulation: Pushed[Any], sensing: SensingSimulation) -> SensingSimulation:
    """Return a simulation whose sensors are read with the pushes that act from the present step on."""

    def read() -> tuple[Array, ...]:
        simulation.switch()
        return sensing.read()

    return SensingSimulation(simulation, read)


def _mechanism(scene: Mechanism, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a mechanism, whose efforts are forces of motors."""
    driven = [scene.joints[joint].name for joint in scene.driven]
    mechanism, xml, sensing = description_of_mechanism(scene, sensors, method)
    model = compiled_model(sensing)
    data = begun(model, mechanism)
    stepper = Stepper(model, data, mechanisms.seen_states(mechanism, xml, method.option("model") == "three-hinges"))
    if not driven:
        return _sensing(stepper, stepper, sensors, method)
    motors = Motors(model, data, driven)

    def follow(law: Law) -> None:
        motors.follow(law)
        stepper.force = motors.force

    return _sensing(TakingLaws(stepper, motors.state, motors.apply, follow), stepper, sensors, method)


def description_of_mechanism(scene: Mechanism, sensors: Sequence[Sensor], method: Method) -> tuple[Mechanism, str, str]:
    """Return the mechanism that the model of a method simulates, its XML, and its XML with sensors and motors.

    A joint has a motor of its name if it is driven, has an effort, or has a joint_effort sensor. Raises `SceneUnsupported`.
    """
    driven = [scene.joints[joint].name for joint in scene.driven]
    effective = [scene.joints[each.joint].name for each in sensors if each.type == "joint_effort" and each.joint is not None]
    mechanism, xml = mechanisms.described(scene, method)
    constant = [joint.name for joint in mechanism.joints if joint.effort]
    placed = [_placed(scene, each) for each in sensors]
    return mechanism, xml, with_sensors(xml, placed, method, tuple(dict.fromkeys((*driven, *effective, *constant))))


def begun(model: mujoco.MjModel, mechanism: Mechanism) -> mujoco.MjData:
    """Return the data of a mechanism at t = 0, with its constant efforts as the controls of motors."""
    data = mujoco.MjData(model)
    mechanisms.begin(model, data, mechanism)
    data.qfrc_applied[:] = 0
    for joint in mechanism.joints:
        if joint.effort:
            data.actuator(joint.name).ctrl[0] = joint.effort
    return data


def _placed(scene: Mechanism, sensor: Sensor) -> Placed:
    """Return a sensor in the model of a mechanism, whose bodies have the frames of the case."""
    joint = None if sensor.joint is None else scene.joints[sensor.joint].name
    part = joint if sensor.type == "joint_effort" and joint is not None else scene.bodies[sensor.body].name
    return Placed(sensor, part, np.array(sensor.position), attitude_of(sensor))


def attitude_of(sensor: Sensor) -> Array:
    """Return the quaternion (4,) from the axes of a sensor to those of the body's frame."""
    return np.array(nearest_turn(sensor.attitude))


def _sensing(simulation: Simulation, stepper: Stepper, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return a simulation and the function that reads its sensors, which are MuJoCo's last ones."""
    stepper.pool = None  # a rollout need not leave the sensors of its last step
    model, data, forward = stepper.model, stepper.data, method.option("sensors") == "forward"
    first = model.nsensordata - sum(len(sensor.form.components) for sensor in sensors)

    def read() -> tuple[Array, ...]:
        if forward:
            with external_force(stepper.force):
                mujoco.mj_forward(model, data)
        return split(sensors, data.sensordata[first:].copy())

    return SensingSimulation(simulation, read)


def with_sensors(xml: str, sensors: Sequence[Placed], method: Method, motors: Sequence[str] = ()) -> str:
    """Return the XML of a model with sensors, and with motors at joints with these names."""
    root = ElementTree.fromstring(xml)
    bodies = {body.get("name"): body for body in root.iter("body")}
    timing = timing_of(method)
    element = ElementTree.SubElement(root, "sensor")
    for number, placed in enumerate(sensors):
        match placed.sensor.type:
            case "joint_effort":
                ElementTree.SubElement(element, "jointactuatorfrc", {"joint": placed.part, **timing})
            case "contact_force":
                # The force is that of the first body on the second one.
                whole = {"body2": placed.part, "data": "force", "reduce": "netforce"}
                ElementTree.SubElement(element, "contact", {**whole, **timing})
            case kind:
                site = f"sensor {number}"
                pose = {"pos": numbers_written(*placed.position), "quat": numbers_written(*placed.attitude)}
                ElementTree.SubElement(bodies[placed.part], "site", {"name": site, **pose})
                for name in AT_SITES[kind]:
                    ElementTree.SubElement(element, name, {"site": site, **timing})
    if motors:
        actuators = ElementTree.SubElement(root, "actuator")
        for name in motors:
            ElementTree.SubElement(actuators, "motor", name=name, joint=name)
    return ElementTree.tostring(root, encoding="unicode")


def timing_of(method: Method) -> dict[str, str]:
    """Return the attributes of a sensor for the options of its delay and its interval."""
    delay, interval = (int(method.option(name) or 0) for name in ("sensordelay", "sensorinterval"))
    if not delay and not interval:
        return {}
    times = {"delay": delay, "interval": interval}
    # MuJoCo keeps the readings of the delay and the present one.
    written = {name: numbers_written(steps * method.timestep) for name, steps in times.items() if steps}
    return {"nsample": str(delay + 1), **written}
