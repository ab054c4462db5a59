"""What a scene requires of a model of it: derived from the scene, never declared."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from bodycheck.reference.lying import NotFlat, planar_state
from bodycheck.reference.scene import Scene, Vector

Symmetry = Literal["sphere", "symmetric", "asymmetric"]


@dataclass(frozen=True)
class Requirements:
    """What must be in a model for it to be exact; what is not here changes nothing.

    translation: whether the centre of mass leaves where it is. rotation: about the normal of a plane on which the body lies
    flat, which takes one moment (planar), or in space, which takes all of them unless some are equal. degrees_of_freedom: of
    the coordinates alone, however the body happens to start: three for a translation, three for a rotation in space, and
    three together, x, y and yaw, on a plane.
    """

    gravity: bool
    translation: bool
    rotation: Literal["none", "planar"] | Symmetry
    contact: bool
    friction: bool
    drag: bool
    degrees_of_freedom: int

    def names(self) -> tuple[str, ...]:
        """What is required, by the names of the fields."""
        kinds = ("gravity", "translation", "rotation", "contact", "friction", "drag")
        return tuple(kind for kind in kinds if getattr(self, kind) not in (False, "none"))


def requirements(scene: Scene) -> Requirements:
    """What a scene requires; a plane counts as touched."""
    if scene.plane is not None:
        flat = lies_flat(scene)
        return Requirements(
            gravity=bool(scene.gravity),
            translation=True,
            rotation="planar" if flat else symmetry(scene.body.moments),
            contact=True,
            friction=scene.plane.friction * scene.gravity > 0,
            drag=scene.drag > 0,
            degrees_of_freedom=3 if flat else 6,
        )
    translation = bool(scene.gravity) or any(scene.initial.velocity)
    rotation = symmetry(scene.body.moments) if any(scene.initial.angular_velocity) else "none"
    return Requirements(
        gravity=bool(scene.gravity),
        translation=translation,
        rotation=rotation,
        contact=False,
        friction=False,
        drag=translation and scene.drag > 0,
        degrees_of_freedom=3 * translation + 3 * (rotation != "none"),
    )


def symmetry(moments: Vector) -> Symmetry:
    """How many principal moments are equal, all their digits being compared: nearly symmetric is asymmetric."""
    kinds: dict[int, Symmetry] = {1: "sphere", 2: "symmetric", 3: "asymmetric"}
    return kinds[len(set(moments))]


def lies_flat(scene: Scene) -> bool:
    """Whether the body lies on a plane on a face that it has."""
    try:
        planar_state(scene)
    except NotFlat:
        return False
    return True


def missing(scene: Scene, modelled: Collection[str]) -> str | None:
    """What a scene requires and is not among what is modelled, by the names of `Requirements`; None where nothing is."""
    return ", ".join(name for name in requirements(scene).names() if name not in modelled) or None
