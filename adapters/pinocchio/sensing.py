"""Read what Pinocchio computes for sensors: accelerations, velocities and forces of its joints, at places on them.

Pinocchio has no sensors, but has the quantities of which users make them:

- accelerometer: `classicAcceleration` at a place on a joint, from the joint's velocity `data.v` and from `data.a_gf`, its
  spatial acceleration minus that of gravity.
- gyroscope, velocimeter: `getFrameVelocity` at a place on a joint, along its own axes.
- force_torque: `data.f`, the force that a joint exerts, along the axes and about the origin of its frame. The frame of the last
  joint of a child is that of the child. A body that is fixed to another has no joint, but a frame of its own, for which
  `computeSupportedForceByFrame` returns the force that it and all bodies beyond it bear.
- contact_force: the impulses of contacts of the solver ADMM, divided by the time step.

A step leaves in the data the last evaluation of the accelerations by the integrator: at the start of the step, or at the last
stage of a Runge-Kutta scheme. Data that were just created contain zeros. With the option `sensors=forward`, `rnea` computes the
data again, at the present state and with its accelerations; without accelerations, as of bodies in contact,
`forwardKinematics` does. Efforts at joints are arguments of Pinocchio's functions and are not read.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import Method, SensingSimulation
from bodycheck.adapters.pinocchio import flights, mechanisms, single, touching
from bodycheck.adapters.pinocchio.joints import UNIVERSE
from bodycheck.adapters.pinocchio.mechanism_model import Built, inertia_of, placement
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism, depth_first
from bodycheck.reference.requirements import grips, touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Placed:
    """A sensor on a joint of a model.

    Attributes
    ----------
    sensor
        The sensor.
    joint
        The index of the joint in the model that moves its body.
    pose
        The pose of the sensor's axes in the frame of the joint.
    frame
        The index of the frame in the model, if the body of a force_torque sensor is fixed to another one.
    """

    sensor: Sensor
    joint: int
    pose: pin.SE3
    frame: int | None = None


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why Pinocchio does not read a sensor, as `Sensing.lacking` does."""
    if grips(scene):
        return "has no sensors of bodies between fingers, whose contacts the adapter solves"
    forward = method.option("sensors") == "forward"
    if sensor.type == "joint_effort":
        return "has no sensor of efforts at joints, which are arguments of its functions"
    if sensor.type == "contact_force":
        if not touches(scene):
            return "has no forces of contacts beside its solver, which this model does not use or does not report"
        return "has forces of contacts in its steps only" if forward else None
    if sensor.type == "accelerometer" and not hasattr(pin, "classicAcceleration"):
        return "has no accelerations of points in this release"
    if isinstance(scene, Mechanism) and not touches(scene):
        return lacking_on_joints(scene, sensor, method)
    if sensor.type == "accelerometer" and (touches(scene) or scene.plane is not None):
        return "has no accelerations of bodies in contact, only impulses"
    return None


def lacking_on_joints(mechanism: Mechanism, sensor: Sensor, method: Method) -> str | None:
    """Return why Pinocchio does not read a sensor of a mechanism; None if it does."""
    if mechanism.loops and method.option("sensors") != "forward":
        return "has no velocities and accelerations of joints along their own axes in the data after a step with loops"
    if sensor.type not in ("accelerometer", "force_torque"):
        return None
    if sensor.type == "force_torque" and mechanism.loops:
        return "has no forces of joints that include those of the constraints of loops"
    if any(joint.mimic for joint in mechanism.joints) and method.option("sensors") != "forward":
        return "has no forward dynamics of joints that follow others, whose data would have the accelerations"
    if sensor.joint is None:
        return None
    if method.option("model") == "free-bodies":
        return f"has no joint {mechanism.joints[sensor.joint].name} in the model free-bodies"
    if mechanism.joints[sensor.joint].type == "fixed" and not hasattr(pin, "computeSupportedForceByFrame"):
        return "has no forces of bodies that are fixed to others in this release"
    return None


def prepare_sensing(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a scene with sensors, as `Sensing.prepare_sensing` does."""
    if touches(scene):
        return _touching(scene, sensors, method)
    if isinstance(scene, Mechanism):
        return _mechanism(scene, sensors, method)
    return _single(scene, sensors, method)


def _single(scene: Scene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a body in flight, or lying flat on a plane."""
    joints = single.jointed(scene, method)
    model, data = joints.model, joints.model.createData()
    loop = single.loop(single.step_of(scene, method, joints, data), joints)
    body = pin.SE3(np.eye(3) if joints.attitude is None else joints.attitude, np.zeros(3))
    placed = [Placed(each, joints.joint, body * pose_of(each)) for each in sensors]
    acceleration = None if scene.plane is not None else flights.acceleration_of(scene, model, data, 1)

    def forward() -> None:
        if acceleration is None:
            pin.forwardKinematics(model, data, *loop.state)
        else:
            pin.rnea(model, data, *loop.state, acceleration(*loop.state, 0.0).copy())

    return SensingSimulation(loop, reader(model, data, placed, method, forward))


def _mechanism(scene: Mechanism, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of a mechanism."""
    mechanism = mechanisms.modelled(scene, method)
    built = mechanisms.built_for(mechanism, method)
    model, frames = built.model, add_frames(mechanism, built)
    assembled = mechanisms.assembled(mechanism, built, method)
    loop, data = assembled.loop, assembled.data
    # The states of a sample must not change the data that sensors read.
    rows = mechanisms.states_of(model, model.createData(), built.places, mechanisms.centres_of(mechanism))
    loop.rows = lambda seen: rows(seen[:, : model.nq], seen[:, model.nq :])
    placed = []
    for sensor in sensors:
        joint, frame = built.places[sensor.body]
        placed.append(Placed(sensor, joint, frame * pose_of(sensor), frames.get(sensor.body)))

    def forward() -> None:
        pin.rnea(model, data, *loop.state, np.array(assembled.acceleration(*loop.state, 0.0)))

    return SensingSimulation(assembled.simulation, reader(model, data, placed, method, forward))


def _touching(scene: AnyScene, sensors: Sequence[Sensor], method: Method) -> SensingSimulation:
    """Return the simulation of bodies that touch; the frames of their joints have their origins at the centres of mass."""
    contacts = touching.built(scene, method)
    loop, data = touching.simulated(contacts), contacts.data
    centres = mechanisms.centres_of(scene) if isinstance(scene, Mechanism) else np.zeros((1, 3))
    placed = []
    for sensor in sensors:
        pose = pose_of(sensor)
        pose.translation -= centres[sensor.body]
        placed.append(Placed(sensor, contacts.joints[sensor.body], pose))

    def forward() -> None:
        pin.forwardKinematics(contacts.model, data, *loop.state)

    read_data = reader(contacts.model, data, placed, method, forward)

    def read() -> tuple[Array, ...]:
        pushed = contacts.exerted / method.timestep
        return tuple(
            pushed[sensor.body].copy() if sensor.type == "contact_force" else reading
            for sensor, reading in zip(sensors, read_data(), strict=True)
        )

    return SensingSimulation(loop, read)


def reader(
    model: pin.Model, data: pin.Data, sensors: Sequence[Placed], method: Method, forward: Callable[[], object]
) -> Callable[[], tuple[Array, ...]]:
    """Return the function that reads sensors in the data of a model.

    forward: computes the data again at the present state, which a method with the option `sensors=forward` does before.
    """

    def read() -> tuple[Array, ...]:
        if method.option("sensors") == "forward":
            forward()
        return tuple(np.array(reading(model, data, each)) for each in sensors)

    return read


def reading(model: pin.Model, data: pin.Data, placed: Placed) -> Array:
    """Return the present reading of a sensor in the data of a model; NaN if the data do not have it."""
    joint, pose = placed.joint, placed.pose
    match placed.sensor.type:
        case "accelerometer":
            return np.asarray(pin.classicAcceleration(data.v[joint], data.a_gf[joint], pose))
        case "gyroscope":
            return np.asarray(pin.getFrameVelocity(model, data, joint, pose, pin.ReferenceFrame.LOCAL).angular)
        case "velocimeter":
            return np.asarray(pin.getFrameVelocity(model, data, joint, pose, pin.ReferenceFrame.LOCAL).linear)
        case "force_torque" if placed.frame is not None:
            return np.asarray(pin.computeSupportedForceByFrame(model, data, placed.frame).vector)
        case "force_torque":
            return np.asarray(data.f[joint].vector)
        case _:
            return np.full(len(placed.sensor.form.components), np.nan)


def pose_of(sensor: Sensor) -> pin.SE3:
    """Return the pose of a sensor's axes in the frame of its body."""
    return placement(sensor.position, nearest_turn(sensor.attitude))


def add_frames(mechanism: Mechanism, built: Built) -> dict[int, int]:
    """Add a frame of each joint and of each fixed body to a model, and return those of fixed bodies, by their indices.

    The inertia of a fixed body is a part of that of its joint already.
    """
    model, of_bodies, fixed = built.model, {WORLD: UNIVERSE}, dict[int, int]()
    for index in depth_first(mechanism):
        joint, (number, frame) = mechanism.joint_of[index], built.places[index]
        previous = of_bodies[WORLD if joint is None else joint.parent]
        if joint is not None and joint.type == "fixed":
            name, inertia = f"fixed {mechanism.bodies[index].name}", inertia_of(mechanism.bodies[index])
            added = pin.Frame(name, number, previous, frame, pin.FrameType.FIXED_JOINT, inertia)
            of_bodies[index] = fixed[index] = model.addFrame(added, False)
            continue
        start = UNIVERSE if joint is None or joint.parent == WORLD else built.places[joint.parent][0]
        chain = [number]
        while model.parents[chain[-1]] != start:
            chain.append(model.parents[chain[-1]])
        for each in reversed(chain):
            previous = model.addJointFrame(each, previous)
        of_bodies[index] = previous
    return fixed
