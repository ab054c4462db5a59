"""Read Exudyn's sensors: of bodies and links, of joints, and the forces of contacts.

`SensorBody`, and `SensorKinematicTree` on a link of a tree, have the local acceleration, angular velocity and velocity of a
place. They are along the axes of the body, because these sensors have no axes of their own, and the acceleration does not
contain gravity. The axes of a tree's links are chosen by the adapter, and are turned back to the body's. `SensorObject` of a
joint between bodies has the force and the torque of its constraints along the axes of the joint at its first marker, which is
the parent's; forces of springs, dampers and efforts are those of other objects. Trees have no forces in joints. The force of
contacts is that of `GeneralContact` on the coordinates of the position of a body.

The force is that of the child on the parent. The torque of `ObjectJointRevoluteZ` consists of the multipliers of its two
constraints: with a moment about y alone, its x component differs from zero, and not its y component.

Explicit solvers have no acceleration before the first step, and Exudyn returns zero for it.
"""

from collections.abc import Callable, Sequence
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface

from bodycheck.adapters.contract import Method
from bodycheck.adapters.exudyn import kinematic_trees
from bodycheck.adapters.exudyn.jointed_bodies import Assembly, turn_of
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.sensors.sensor import Sensor, SensorType
from bodycheck.reference.trajectory import Array

#: Exudyn's quantity for a type of sensor.
QUANTITIES: dict[SensorType, str] = {
    "accelerometer": "AccelerationLocal",
    "gyroscope": "AngularVelocityLocal",
    "velocimeter": "VelocityLocal",
}


def lacking(scene: AnyScene, sensor: Sensor, _method: Method) -> str | None:
    """Return why Exudyn does not read a sensor, as `Sensing.lacking` does."""
    if sensor.type == "joint_effort":
        return "has no sensor of the efforts of joints"
    if not isinstance(scene, Mechanism) or touches(scene):
        return None
    if sensor.type == "contact_force":
        return "has no shapes of the bodies of mechanisms here"
    if not kinematic_trees.fits(scene):
        joint = None if sensor.joint is None else scene.joints[sensor.joint]
        spherical = joint is not None and joint.type == "spherical"
        return "has no sensor of the torque in a ball joint" if spherical else None
    if sensor.type == "force_torque":
        return "has no sensor of the forces in the joints of its kinematic trees"
    _, places = kinematic_trees.linked(scene)
    if places[sensor.body].link < 0:
        return f"has no link for {scene.bodies[sensor.body].name}, which does not move"
    return None


def of_single_body(
    system: "exudyn.MainSystem", body: Any, contacts: "exudyn.GeneralContact | None", sensors: Sequence[Sensor]
) -> Callable[[], tuple[Array, ...]]:
    """Add sensors on a body that is alone to a system, and return the function that reads them."""
    if contacts is not None and any(sensor.type == "contact_force" for sensor in sensors):
        contacts.computeContactForces = True
    numbers = [None if sensor.type == "contact_force" else on_body(system, body, sensor) for sensor in sensors]

    def contact_force() -> Array:
        return np.zeros(3) if contacts is None else np.array(contacts.GetSystemODE2RhsContactForces(copy=True)[:3])

    def read() -> tuple[Array, ...]:
        return tuple(contact_force() if number is None else values(system, number) for number in numbers)

    return read


def of_touching(
    system: "exudyn.MainSystem",
    bodies: Sequence[Any],
    contacts: Sequence[tuple[tuple[int, int], Any]],
    sensors: Sequence[Sensor],
) -> Callable[[], tuple[Array, ...]]:
    """Add sensors of bodies that touch to a system, and return the function that reads them.

    contacts: their numbers, each with the indices of its two bodies.
    """

    def contact_force(body: int) -> Callable[[], Array]:
        # The force of a contact is that on the first of its markers, and the plane has the second.
        signs = [(-1 if pair[1] == body and pair[0] != WORLD else 1, number) for pair, number in contacts if body in pair]
        return lambda: sum((sign * force_of(system, number) for sign, number in signs), start=np.zeros(3))

    readers = [
        contact_force(sensor.body)
        if sensor.type == "contact_force"
        else reading(system, on_body(system, bodies[sensor.body], sensor))
        for sensor in sensors
    ]
    return lambda: tuple(each() for each in readers)


def force_of(system: "exudyn.MainSystem", contact: Any) -> Array:
    """Return the present force (3,), in N and in the world, of a contact on the first of its markers."""
    return np.array(system.GetObjectOutput(contact, exudyn.OutputVariableType.Force))


def of_bodies(
    system: "exudyn.MainSystem", assembly: Assembly, mechanism: Mechanism, sensors: Sequence[Sensor]
) -> Callable[[], tuple[Array, ...]]:
    """Add sensors of jointed bodies to a system, and return the function that reads them."""
    readers = []
    for sensor in sensors:
        joint = mechanism.joint_of[sensor.body]
        if sensor.type == "force_torque" and joint is not None:
            readers.append(wrench(system, assembly.joints[sensor.body], turn_of(joint)))
        else:
            readers.append(reading(system, on_body(system, assembly.bodies[sensor.body], sensor)))
    return lambda: tuple(each() for each in readers)


def of_tree(
    system: "exudyn.MainSystem", tree: Any, mechanism: Mechanism, sensors: Sequence[Sensor]
) -> Callable[[], tuple[Array, ...]]:
    """Add sensors on links of a kinematic tree to a system, and return the function that reads them."""
    _, places = kinematic_trees.linked(mechanism)
    readers = []
    for sensor in sensors:
        frame = places[sensor.body]
        number = system.AddSensor(
            itemInterface.SensorKinematicTree(
                objectNumber=tree,
                linkNumber=frame.link,
                localPosition=frame.after(np.array(sensor.position), frame.turn).origin,
                outputVariableType=getattr(exudyn.OutputVariableType, QUANTITIES[sensor.type]),
                writeToFile=False,
            )
        )
        readers.append(reading(system, number, conjugate(frame.turn)))
    return lambda: tuple(each() for each in readers)


def on_body(system: "exudyn.MainSystem", body: Any, sensor: Sensor) -> Any:
    """Add a sensor at its place on a body to a system, and return its number."""
    return system.AddSensor(
        itemInterface.SensorBody(
            bodyNumber=body,
            localPosition=[*sensor.position],
            outputVariableType=getattr(exudyn.OutputVariableType, QUANTITIES[sensor.type]),
            writeToFile=False,
        )
    )


def wrench(system: "exudyn.MainSystem", joint: Any, turn: Array) -> Callable[[], Array]:
    """Add sensors of the force and the torque of a joint to a system, and return the function that reads them (6,)."""
    kinds = exudyn.OutputVariableType.ForceLocal, exudyn.OutputVariableType.TorqueLocal
    numbers = [
        system.AddSensor(itemInterface.SensorObject(objectNumber=joint, outputVariableType=kind, writeToFile=False))
        for kind in kinds
    ]
    return lambda: np.concatenate([rotate(turn, values(system, number)) for number in numbers])


def reading(system: "exudyn.MainSystem", number: Any, turn: Array | None = None) -> Callable[[], Array]:
    """Return the function that reads a sensor, and turns the reading by a quaternion if one is given."""
    return lambda: values(system, number) if turn is None else rotate(turn, values(system, number))


def values(system: "exudyn.MainSystem", number: Any) -> Array:
    """Return the present values of a sensor."""
    return np.array(system.GetSensorValues(number))
