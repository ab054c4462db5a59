"""The contents that an exact model of a scene or of a mechanism must have, derived from the scene itself."""

import math
from collections.abc import Collection
from dataclasses import asdict, dataclass, fields
from typing import ClassVar, Literal, TypeGuard

from bodycheck.reference.errors import NotFlat
from bodycheck.reference.mechanisms.coordinates import VELOCITIES
from bodycheck.reference.mechanisms.exact import has_zero_moment, nearest_inertia
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.planar import planar_state
from bodycheck.reference.scene import Scene, Vector

#: How many principal moments of a body are equal: all three, two, or none.
Symmetry = Literal["sphere", "symmetric", "asymmetric"]

#: The kind of motion in a scene: a flight with rotation, a flight without rotation, a flight with drag, contact with a plane,
#: or the motion of bodies on joints.
Kind = Literal["turning", "translation", "drag", "contact", "mechanism"]


@dataclass(frozen=True)
class Requirements:
    """The effects that a model must contain to be exact; effects that change nothing in the scene are not required.

    Attributes
    ----------
    gravity
        Whether gravity acts.
    translation
        Whether the centre of mass moves.
    rotation
        "none" for a body that does not rotate; "planar" for a body that lies flat and rotates about the normal of the plane
        only, for which one moment of inertia is enough; otherwise the symmetry of its moments, all of which count.
    contact
        Whether there is a plane; the body then counts as touching it.
    friction
        Whether friction acts on the plane.
    incline
        Whether the plane is inclined.
    restitution
        Whether impacts give back a part of the velocity.
    rolling
        Whether the body does not lie flat (it is round, lies on an edge or a corner, or falls on the plane), or friction is
        infinite, so that nothing slips.
    drag
        Whether drag acts on a body that moves.
    rolling_friction, torsional_friction
        Whether a moment along the plane, or about its normal, brakes the rotation of the body.
    pushes
        Whether constant forces act on the body.
    degrees_of_freedom
        Number of coordinates of the model: three for a translation, three for a rotation in space, even about a fixed axis, and
        three in all (x, y and yaw) for a body that lies flat.
    """

    gravity: bool
    translation: bool
    rotation: Literal["none", "planar"] | Symmetry
    contact: bool
    friction: bool
    drag: bool
    degrees_of_freedom: int
    incline: bool = False
    restitution: bool = False
    rolling: bool = False
    pushes: bool = False
    rolling_friction: bool = False
    torsional_friction: bool = False

    @property
    def kind(self) -> Kind:
        """The kind of the scene: the first of contact, drag, rotation and translation that it requires."""
        if self.contact:
            return "contact"
        if self.drag:
            return "drag"
        return "translation" if self.rotation == "none" else "turning"

    def names(self) -> tuple[str, ...]:
        """The names of the required effects, which are those of their fields."""
        kinds = (
            "gravity",
            "translation",
            "rotation",
            "contact",
            "friction",
            "incline",
            "restitution",
            "rolling",
            "rolling friction",
            "torsional friction",
            "drag",
            "pushes",
        )
        return tuple(kind for kind in kinds if getattr(self, kind.replace(" ", "_")) not in (False, "none"))


@dataclass(frozen=True)
class MechanismRequirements:
    """The effects that a model of a mechanism must contain to be exact; effects whose parameters are zero are not required.

    Attributes
    ----------
    effects
        The names of the effects: "mechanisms", "gravity", the `effect` of the type of each joint, "armature", "joint damping",
        "joint springs", "joint friction", "joint efforts", "mimic joints", "controllers", "rigid stops", "elastic stops",
        "stops that cease to act", "loops", "point masses" where a body with a mass has a moment of zero, "massless bodies",
        "contacts" where bodies touch, "contacts without a plane", "contacts of bodies on joints", "rolling friction",
        "torsional friction", and "pushes".
    degrees_of_freedom
        Number of velocities of its joints and free bodies without those of joints that follow others. The velocities that loops
        take away are not subtracted.
    """

    effects: tuple[str, ...]
    degrees_of_freedom: int
    kind: ClassVar[Literal["mechanism"]] = "mechanism"

    def names(self) -> tuple[str, ...]:
        """The names of the required effects."""
        return self.effects


def requirements(scene: Scene) -> Requirements:
    """The requirements of a scene."""
    if scene.plane is not None:
        flat, rough = lies_flat(scene), math.isinf(scene.plane.friction)
        return Requirements(
            gravity=bool(scene.gravity),
            translation=True,
            rotation="planar" if flat else symmetry(scene.body.moments),
            contact=True,
            friction=scene.plane.friction * scene.gravity > 0,
            drag=scene.drag > 0,
            degrees_of_freedom=3 if flat else 6,
            incline=bool(scene.plane.incline),
            restitution=not flat and bool(scene.plane.restitution),
            rolling=not flat or rough,
            pushes=bool(scene.pushes),
            rolling_friction=scene.plane.rolling_friction > 0,
            torsional_friction=scene.plane.torsional_friction > 0,
        )
    translation = bool(scene.gravity) or any(scene.initial.velocity) or bool(scene.pushes)
    rotation = symmetry(scene.body.moments) if any(scene.initial.angular_velocity) else "none"
    return Requirements(
        gravity=bool(scene.gravity),
        translation=translation,
        rotation=rotation,
        contact=False,
        friction=False,
        drag=translation and scene.drag > 0,
        degrees_of_freedom=3 * translation + 3 * (rotation != "none"),
        pushes=bool(scene.pushes),
    )


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
        "mimic joints": any(joint.mimic for joint in joints),
        "controllers": bool(mechanism.controllers),
        "rigid stops": any(joint.stops is not None and joint.stops.rigid for joint in joints),
        "elastic stops": any(joint.stops is not None and not joint.stops.rigid for joint in joints),
        "stops that cease to act": mechanism.stops_until is not None,
        "loops": bool(mechanism.loops),
        "point masses": any(nearest_inertia(body).mass and has_zero_moment(body) for body in mechanism.bodies),
        "massless bodies": not all(nearest_inertia(body).mass for body in mechanism.bodies),
        "contacts": touches(mechanism),
        "contacts without a plane": touches(mechanism) and mechanism.plane is None,
        "contacts of bodies on joints": grips(mechanism),
        "rolling friction": any(law.rolling_friction for law in mechanism.contact_laws),
        "torsional friction": any(law.torsional_friction for law in mechanism.contact_laws),
        "pushes": bool(mechanism.pushes),
    }
    free = sum(joint is None for joint in mechanism.joint_of)
    velocities = sum(VELOCITIES[joint.type] for joint in joints if joint.mimic is None) + 6 * free
    return MechanismRequirements(tuple(name for name, needed in effects.items() if needed), velocities)


def symmetry(moments: Vector) -> Symmetry:
    """The symmetry of a body with these principal moments (kg m^2).

    All digits are compared, so that a nearly symmetric body is asymmetric.
    """
    kinds: dict[int, Symmetry] = {1: "sphere", 2: "symmetric", 3: "asymmetric"}
    return kinds[len(set(moments))]


def lies_flat(scene: Scene) -> bool:
    """Return whether the body lies flat on the plane of the scene; see `planar.planar_state`."""
    try:
        planar_state(scene)
    except NotFlat:
        return False
    return True


def touches(scene: AnyScene) -> bool:
    """Return whether the motion is computed by `contact`.

    `contact` computes mechanisms with a plane or with pairs that touch, and a single body on a plane without drag, except a
    body that lies flat on a level plane with finite friction, without rolling or torsional friction and without pushes.
    """
    if isinstance(scene, Mechanism):
        return scene.plane is not None or bool(scene.contacts)
    if scene.plane is None or scene.drag:
        return False
    needed = requirements(scene)
    moments = needed.rolling_friction or needed.torsional_friction
    return needed.incline or needed.rolling or moments or needed.pushes


def grips(scene: AnyScene) -> TypeGuard[Mechanism]:
    """Return whether bodies on joints touch others, as fingers do."""
    return isinstance(scene, Mechanism) and bool(scene.joints) and bool(scene.contacts)


def free_bodies_touch(scene: AnyScene) -> bool:
    """Return whether `touches` is True and no body is on a joint."""
    return touches(scene) and not grips(scene)


def slides(scene: AnyScene) -> TypeGuard[Scene]:
    """Return whether the motion is computed by `sliding`: the scene is one body on a plane, and `touches` is False."""
    return isinstance(scene, Scene) and scene.plane is not None and not touches(scene)


def turns(mechanism: Mechanism) -> bool:
    """Return whether the joints of a mechanism let any body turn."""
    return None in mechanism.joint_of or any(joint.form.turns for joint in mechanism.joints)


def needs(scene: AnyScene) -> Requirements | MechanismRequirements:
    """The requirements of any scene."""
    return of_mechanism(scene) if isinstance(scene, Mechanism) else requirements(scene)


#: The names of a row of requirements: the fields of `Requirements`, and the effects of a mechanism.
COLUMNS = (*(field.name for field in fields(Requirements)), "mechanism")


def as_row(scene: AnyScene) -> dict[str, bool | str | int]:
    """The requirements of any scene by `COLUMNS`.

    The effects of a mechanism except gravity are a list in words in the last column, which other scenes do not have.
    """
    if not isinstance(scene, Mechanism):
        return asdict(requirements(scene))
    needed = of_mechanism(scene)
    effects = ", ".join(name for name in needed.names() if name not in ("mechanisms", "gravity"))
    row: dict[str, bool | str | int] = dict.fromkeys(COLUMNS, False)
    row["gravity"], row["rotation"], row["mechanism"] = bool(scene.gravity), "none", effects
    row["degrees_of_freedom"] = needed.degrees_of_freedom
    return row


def missing(scene: AnyScene, modelled: Collection[str]) -> str | None:
    """The required effects that a model lacks, as a list in words, or None if it lacks nothing.

    modelled: the effects that the model contains, by the names of the fields of `Requirements`, and for mechanisms by the names
    that `MechanismRequirements.names` gives.
    """
    return ", ".join(name for name in needs(scene).names() if name not in modelled) or None
