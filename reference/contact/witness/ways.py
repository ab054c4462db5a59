"""The families of motions that have a witness. The first family that a scene belongs to computes its witness."""

from collections.abc import Callable

from bodycheck.reference.contact.witness import (
    balls,
    blocks,
    coins,
    colliding,
    dropped,
    gripped,
    leaning,
    pushing,
    resisting,
    resting,
)
from bodycheck.reference.errors import NotModelled, OutOfReach, within_range
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Witness

#: A family: a function that returns the motion of a scene with a plane at ascending times (n,) >= 0 (s), with the bodies as
#: first axis of its states, or None for a scene of another kind. It raises `NotModelled` or `OutOfReach` for a motion of its
#: kind that it does not follow.
Family = Callable[[AnyScene, Array], Witness | None]

FAMILIES: tuple[Family, ...] = (
    resisting.second,
    balls.second,
    leaning.second,
    coins.second,
    blocks.second,
    dropped.second,
    resting.second,
    pushing.second,
    colliding.second,
)


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The witness of a scene at ascending times (n,) >= 0 (s); None if no family follows its motion."""
    fingers = isinstance(scene, Mechanism) and scene.joints
    families = (gripped.second,) if fingers else FAMILIES if scene.plane is not None else (colliding.second,)
    try:
        with within_range("the second way"):
            return next((witness for family in families if (witness := family(scene, times)) is not None), None)
    except (NotModelled, OutOfReach):
        return None
