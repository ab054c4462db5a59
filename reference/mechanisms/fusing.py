"""The mass properties of bodies with all bodies that are fixed to them, in exact arithmetic."""

from bodycheck.reference.exact.inertia import MassProperties, joined
from bodycheck.reference.exact.numbers import vector
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.frames import Place, placed
from bodycheck.reference.mechanisms.mechanism import Joint, JointedBody, Mechanism


def frame_of(joint: Joint) -> Place:
    """The frame of a joint in the frame of its parent, if its coordinates are zero."""
    return Place(exact.turn(joint.attitude), vector(joint.position))


def _properties(body: JointedBody) -> MassProperties:
    inertia = exact.inertia(body)
    return MassProperties(inertia.mass, inertia.centre, inertia.tensor)


def fused(mechanism: Mechanism, body: int) -> MassProperties:
    """The mass properties of a body together with all bodies that are fixed to it, in its frame."""
    parts, frames = [_properties(mechanism.bodies[body])], [(body, Place())]
    for carrier, pose in frames:
        for joint in mechanism.joints:
            if joint.parent == carrier and joint.type == "fixed":
                frames.append((joint.child, pose.then(frame_of(joint))))
                parts.append(placed(_properties(mechanism.bodies[joint.child]), frames[-1][1]))
    return joined(parts) if len(parts) > 1 else parts[0]
