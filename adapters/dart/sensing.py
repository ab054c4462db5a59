"""Read what DART has of sensors: velocities and accelerations of frames, forces in joints, and forces of contacts.

A frame of DART's (`SimpleFrame`) at the place and along the axes of a sensor has the velocity, the angular velocity and the
acceleration of its origin relative to the world, along its own axes. DART has no accelerometer: this acceleration does not
contain gravity. A wrench is the body force of DART's `getBodyForce`, which the parent transmits through the joint, about the
origin and along the axes of the child. An effort is the force of the joint, and the force of contacts is the sum over the
contacts of the last step.

After a step, the accelerations of joints, and with them the forces, are those at its start, but DART computes the accelerations
of frames from them at the positions and velocities at its end. `computeForwardDynamics` computes all for the present state, but
without the forces of constraints.
"""

from collections.abc import Callable, Sequence
from typing import Any

import dartpy as dart
import numpy as np

from bodycheck.adapters.contract import Method
from bodycheck.adapters.dart.bodies import pose
from bodycheck.adapters.mechanisms import stops_of
from bodycheck.reference.mechanisms.exact import nearest_turn
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.trajectory import Array


def lacking(scene: AnyScene, sensor: Sensor, method: Method) -> str | None:
    """Return why DART does not read a sensor, as `Sensing.lacking` does."""
    dynamic = sensor.type not in ("gyroscope", "velocimeter")
    if method.option("sensors") == "forward" and dynamic and constrained(scene, method):
        return "computes no forces of constraints (contacts, loops, stops, dry friction) in its forward dynamics"
    if isinstance(scene, Mechanism) and scene.plane is None and sensor.type == "contact_force":
        return "has no shapes of the bodies of mechanisms here"
    return None


def constrained(scene: AnyScene, method: Method) -> bool:
    """Return whether DART has constraints in a scene."""
    if not isinstance(scene, Mechanism) or scene.plane is not None:
        return scene.plane is not None
    return bool(scene.loops) or any(joint.friction or stops_of(joint, method) is not None for joint in scene.joints)


def reader(
    world: "dart.simulation.World", bodies: Sequence[Any], sensors: Sequence[Sensor], method: Method
) -> Callable[[], tuple[Array, ...]]:
    """Return the function that reads sensors on bodies of the skeletons in a world."""
    skeletons, forward = (
        {body.getSkeleton().getName(): body.getSkeleton() for body in bodies},
        method.option("sensors") == "forward",
    )
    readers = [reading(world, bodies[sensor.body], sensor, number) for number, sensor in enumerate(sensors)]

    def read() -> tuple[Array, ...]:
        if forward:
            for skeleton in skeletons.values():
                skeleton.computeForwardDynamics()
        return tuple(np.array(each()) for each in readers)

    return read


def reading(world: "dart.simulation.World", body: Any, sensor: Sensor, number: int) -> Callable[[], Any]:
    """Return the function that reads a sensor on a body, or of its joint to its parent."""
    match sensor.type:
        case "force_torque":
            return lambda: np.roll(body.getBodyForce(), 3)  # DART has the moment before the force
        case "joint_effort":
            return lambda: [body.getParentJoint().getForce(0)]
        case "contact_force":
            return lambda: contact_force(world, body)
    frame = dart.dynamics.SimpleFrame(body, f"sensor {number}", pose(sensor.position, nearest_turn(sensor.attitude)))
    ground = dart.dynamics.Frame.World()
    if sensor.type == "gyroscope":
        return lambda: frame.getAngularVelocity(ground, frame)
    if sensor.type == "velocimeter":
        return lambda: frame.getLinearVelocity(ground, frame)
    return lambda: frame.getLinearAcceleration(ground, frame)


def contact_force(world: "dart.simulation.World", body: Any) -> Array:
    """Return the sum (3,) of the forces of the contacts of a body. Each acts on the first object of its contact."""
    force, name = np.zeros(3), body.getSkeleton().getName()
    for contact in world.getLastCollisionResult().getContacts():
        first = contact.collisionObject1.getShapeFrame().asShapeNode().getSkeleton().getName()
        force += contact.force if first == name else -contact.force
    return force
