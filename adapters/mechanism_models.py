"""Larger models of a mechanism: the same motion with more coordinates than it needs.

- `three-hinges`: each ball joint is replaced by three hinges, about x, then y, then z of the turned frame. They are in gimbal
  lock where the second angle is a right angle.
- `free-bodies`: all bodies are free, and constraints keep points of each body on points of another one: one point for a ball
  joint, two points for a hinge, 1 m apart on its axis, and three points for a fixed joint.

`three-hinges` needs ball joints without damping, because hinges cannot damp the angular velocity of a ball. `free-bodies` needs
bodies with a mass, and joints in which nothing acts and which follow no other joint, because no joint is left between the
bodies.
"""

import math
from dataclasses import replace

import numpy as np

from bodycheck.adapters.contract import Model, SceneUnsupported
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms import exact, kinematics
from bodycheck.reference.mechanisms.mechanism import BodyStart, Joint, Loop, Mechanism
from bodycheck.reference.scene import Vector
from bodycheck.reference.schemes.coordinates import angles
from bodycheck.reference.trajectory import Array

#: The models, from the smallest to the largest, each with a description of what it adds to the model before.
ADDS = {
    "joints": "one joint of the engine for each joint, in its coordinates",
    "three-hinges": "three hinges in place of each ball",
    "free-bodies": "free bodies, held together by constraints at points",
}

_AXES: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def models(mechanism: Mechanism, integrator: str) -> dict[str, Model]:
    """Return the models of a mechanism by name, as `Models.models` does; empty if there is only one."""
    names = [name for name in ADDS if lacking(mechanism, name) is None]
    mark = "," if ":" in integrator else ":"
    return {name: Model(f"{integrator}{mark}model={name}", ADDS[name]) for name in names} if len(names) > 1 else {}


def lacking(mechanism: Mechanism, model: str) -> str | None:
    """Return why a mechanism does not have the named model; None if it has."""
    joints = mechanism.joints
    if model == "three-hinges":
        balls = [joint for joint in joints if joint.type == "spherical"]
        if not balls:
            return "there is no ball"
        return "a ball has damping" if any(joint.damping for joint in balls) else None
    if model == "free-bodies":
        if other := sorted({joint.type for joint in joints} - {"revolute", "spherical", "fixed", "free"}):
            return f"points do not make {' and '.join(other)} joints"
        if not all(exact.nearest_inertia(body).mass for body in mechanism.bodies):
            return "a body has no mass"
        if any(joint.mimic for joint in joints):
            return "a joint follows another"
        acting = any(
            joint.armature or joint.damping or joint.stiffness or joint.friction or joint.effort or joint.stops
            for joint in joints
        )
        return "something acts on its joints" if acting or mechanism.controllers else None
    return None


def check(mechanism: Mechanism, model: str | None) -> None:
    """Raise `SceneUnsupported` if a mechanism does not have the named model. Accept None, which names no model."""
    if model is None:
        return
    reason = lacking(mechanism, model) if model in ADDS else f"there are: {', '.join(ADDS)}"
    if reason is not None:
        raise SceneUnsupported(f"no model {model!r} of this mechanism: {reason}")


def free_bodies(mechanism: Mechanism) -> Mechanism:
    """Return the mechanism with free bodies that loops hold together in place of the joints."""
    start = kinematics.initial(mechanism)
    bodies = []
    for index, body in enumerate(mechanism.bodies):
        position, attitude, velocity, spin = (
            tuple(part[index, 0].tolist())
            for part in (start.position, start.quaternion, start.velocity, start.angular_velocity)
        )
        bodies.append(replace(body, start=BodyStart(position, attitude, velocity, spin)))
    loops = [loop for joint in mechanism.joints for loop in _held(joint)]
    return replace(mechanism, bodies=tuple(bodies), joints=(), loops=(*loops, *mechanism.loops))


def _held(joint: Joint) -> list[Loop]:
    """Return the loops that keep points of a joint's child on points of its parent."""
    points: dict[str, tuple[Vector, ...]] = {
        "spherical": ((0.0, 0.0, 0.0),),
        "revolute": ((0.0, 0.0, 0.0), exact.nearest_axis(joint)),
        "fixed": ((0.0, 0.0, 0.0), *_AXES),
    }
    turn, loops = np.array(exact.nearest_turn(joint.attitude)), []
    for point in points.get(joint.type, ()):
        x, y, z = (np.array(joint.position) + rotate(turn, np.array(point))).tolist()
        loops.append(Loop((joint.parent, joint.child), ((x, y, z), point)))
    return loops


def hinge_motion(position: Array, velocity: Array) -> tuple[Array, Array]:
    """Return the angles and rates (3,) of three hinges from the quaternion (4,) and the angular velocity (3,) of a ball."""
    w, x, y, z = position.tolist()
    turned = angles((w, x, y, z))
    _, b, c = turned
    p, q, r = velocity.tolist()
    first = (p * math.cos(c) - q * math.sin(c)) / math.cos(b)
    return np.array(turned), np.array([first, p * math.sin(c) + q * math.cos(c), r - first * math.sin(b)])
