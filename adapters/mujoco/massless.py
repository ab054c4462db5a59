"""Bodies without mass in MuJoCo, which refuses a moving body without mass.

Bodies that are fixed to each other move as one. If none of them has a mass and one joint leads on from them, their joint and
that joint become joints of one body of MuJoCo, as in its own files: the joints of a body act one after another. Each keeps its
coordinate, and its anchor and axis are given in the frame of the body where all coordinates are zero. MuJoCo then has no body
in between, so that the poses of the bodies without mass come from a second model, in which they have a mass: both models have
the same joints in the same order, and poses and velocities do not depend on masses.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from bodycheck.adapters.contract import SceneUnsupported
from bodycheck.adapters.mechanisms import has_mass, massless_parts
from bodycheck.reference.exact.numbers import Vector3, doubles, vector
from bodycheck.reference.mechanisms import exact
from bodycheck.reference.mechanisms.frames import Place, rotated
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Quaternion, Tensor, Vector

#: MuJoCo's reason against a moving body without mass.
REASON = "MuJoCo refuses the model: mass and inertia of moving bodies must be larger than mjMINVAL"

#: The inertia of bodies without mass in the second model.
UNIT = Tensor(1.0, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))


#: The axes of a frame, by their names.
AXES: dict[str, Vector] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class Mounted:
    """A joint of a body of MuJoCo, and the pose of its frame in the body's frame where all coordinates are zero."""

    joint: Joint
    pose: Place = field(default_factory=Place)

    @property
    def anchor(self) -> Vector:
        """The origin of the joint in the body's frame (m)."""
        return _nearest(self.pose.origin)

    def axis(self, name: str) -> Vector:
        """Return the axis of the joint ("given"), or an axis of its frame ("x", "y" or "z"), along the axes of the body."""
        return _nearest(rotated(self.pose.turn, exact.unit_axis(self.joint) if name == "given" else vector(AXES[name])))


@dataclass(frozen=True)
class Seat:
    """The place of a body in MuJoCo's tree.

    Attributes
    ----------
    parent
        The index of the body, or `WORLD`, in whose element the element of the body is.
    pose
        The pose of its frame in the frame of the parent where all coordinates are zero.
    joints
        Its joints in the order in which they act.
    """

    parent: int
    pose: Place = field(default_factory=Place)
    joints: tuple[Mounted, ...] = ()

    @property
    def position(self) -> Vector:
        """The position of its frame in the frame of the parent (m)."""
        return _nearest(self.pose.origin)

    @property
    def quaternion(self) -> Quaternion:
        """The attitude of its frame in the frame of the parent."""
        w, x, y, z = doubles(self.pose.turn)
        return w, x, y, z


def _nearest(exact_vector: Vector3) -> Vector:
    x, y, z = doubles(exact_vector)
    return x, y, z


def seats(mechanism: Mechanism, order: Iterable[int]) -> dict[int, Seat]:
    """Return the places of the bodies that MuJoCo has, by their indices.

    order: the indices of all bodies, parents first. Raises `SceneUnsupported` for a moving body without mass that MuJoCo would
    refuse.
    """
    left_out = set[int]()
    for part in massless_parts(mechanism):
        _check(mechanism, part)
        left_out.update(part)
    reached, places, joint_of = {WORLD: Seat(WORLD)}, dict[int, Seat](), mechanism.joint_of
    for index in order:
        joint = joint_of[index]
        if joint is None:
            places[index] = Seat(WORLD)
        else:
            above = reached[joint.parent]
            pose = above.pose.then(Place(exact.turn(joint.attitude), vector(joint.position)))
            if index in left_out:
                between = () if joint.type == "fixed" else (Mounted(joint, pose),)
                reached[index] = Seat(above.parent, pose, (*above.joints, *between))
                continue
            back = pose.inverse()
            mounted = tuple(replace(earlier, pose=back.then(earlier.pose)) for earlier in above.joints)
            _check_balls(mechanism.bodies[index], mounted)
            places[index] = Seat(above.parent, pose, (*mounted, Mounted(joint)))
        reached[index] = Seat(index)
    return places


def with_masses(mechanism: Mechanism) -> Mechanism:
    """Return a mechanism in which bodies without mass have one; the mechanism itself if all bodies have a mass."""
    if all(map(has_mass, mechanism.bodies)):
        return mechanism
    bodies = (body if has_mass(body) else replace(body, inertia=UNIT) for body in mechanism.bodies)
    return replace(mechanism, bodies=tuple(bodies))


def _check(mechanism: Mechanism, part: Sequence[int]) -> None:
    """Raise `SceneUnsupported` unless a part without mass has one joint before it and one behind it, and nothing else."""
    before, behind = mechanism.joint_of[part[0]], [joint for joint in mechanism.joints if _leads_on(joint, part)]
    if any(body in part for loop in mechanism.loops for body in loop.bodies):
        obstacle = "a loop holds it"
    elif before is None or (before.type == "free" and before.parent == WORLD):
        obstacle = "it is free"
    elif len(behind) != 1:
        obstacle = f"it carries the joints {', '.join(joint.name for joint in behind)}" if behind else "it carries no joint"
    else:
        return
    name = mechanism.bodies[part[0]].name
    raise SceneUnsupported(f"{REASON}: the body {name} has no mass, and {obstacle}")


def _check_balls(body: JointedBody, joints: Iterable[Mounted]) -> None:
    """Raise `SceneUnsupported` if a ball that acts before the last joint of a body is turned in the frame of this body.

    The coordinates of a ball are along the axes of the frame of the body that MuJoCo has.
    """
    for mounted in joints:
        if mounted.joint.type in ("spherical", "free") and any(doubles(mounted.pose.turn[1:])):
            where = f"is turned in the frame of {body.name}, the next body with a mass"
            raise SceneUnsupported(f"{REASON}, and the ball of {mounted.joint.name} {where}")


def _leads_on(joint: Joint, part: Sequence[int]) -> bool:
    """Return whether a joint moves another body than those of a part against this part."""
    return joint.parent in part and joint.type != "fixed"
