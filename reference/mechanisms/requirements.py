"""The parts that a model of a mechanism must have to be exact, derived from the mechanism itself."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from bodycheck.reference.mechanisms.coordinates import VELOCITIES
from bodycheck.reference.mechanisms.exact import inertia
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.reference.mechanisms.mechanism import JointedBody, Mechanism


@dataclass(frozen=True)
class MechanismRequirements:
    """The effects that a model of a mechanism must contain to be exact; what is zero in it is not required.

    Attributes
    ----------
    effects
        The names of the effects: "mechanisms", "gravity", the `effect` of the type of each joint, "armature", "joint damping",
        "joint springs", "joint friction", "joint efforts", "loops", "point masses" where a body has a moment of zero,
        "contacts" where there is a plane, and "pushes".
    degrees_of_freedom
        Number of velocities of its joints and free bodies. Loops, which take some of them away, are not counted.
    """

    effects: tuple[str, ...]
    degrees_of_freedom: int
    kind: ClassVar[Literal["mechanism"]] = "mechanism"

    def names(self) -> tuple[str, ...]:
        """The names of the required effects."""
        return self.effects


def of_mechanism(mechanism: Mechanism) -> MechanismRequirements:
    """The requirements of a mechanism."""
    joints = mechanism.joints
    used = {joint.type for joint in joints}
    effects = {
        "mechanisms": True,
        "gravity": bool(mechanism.gravity),
        **{form.effect: name in used for name, form in JOINT_TYPES.items()},
        "armature": any(joint.armature for joint in joints),
        "joint damping": any(joint.damping for joint in joints),
        "joint springs": any(joint.stiffness for joint in joints),
        "joint friction": any(joint.friction for joint in joints),
        "joint efforts": any(joint.effort for joint in joints),
        "loops": bool(mechanism.loops),
        "point masses": any(_has_zero_moment(body) for body in mechanism.bodies),
        "contacts": mechanism.plane is not None,
        "pushes": bool(mechanism.pushes),
    }
    free = sum(joint is None for joint in mechanism.joint_of)
    velocities = sum(VELOCITIES[joint.type] for joint in joints) + 6 * free
    return MechanismRequirements(tuple(name for name, needed in effects.items() if needed), velocities)


def turns(mechanism: Mechanism) -> bool:
    """Return whether the joints of a mechanism let any body turn."""
    return None in mechanism.joint_of or any(joint.form.turns for joint in mechanism.joints)


def _has_zero_moment(body: JointedBody) -> bool:
    """Return whether a principal moment of a body, and so the determinant of its inertia tensor, is zero."""
    from bodycheck.reference.exact.numbers import NEGLIGIBLE  # mpmath is imported for mechanisms alone

    xx, yy, zz, xy, xz, yz = inertia(body).tensor
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return bool(abs(determinant) <= NEGLIGIBLE * (xx + yy + zz) ** 3)
