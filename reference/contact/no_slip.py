"""The friction that engines are given where nothing slips: engines have no infinite coefficient."""

import math
from dataclasses import replace

from bodycheck.reference.contact.ways import ends
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import touches

#: By how much the friction that engines are given is larger than the smallest one that holds.
MARGIN = 2.0


def finite(scene: AnyScene, duration: float) -> AnyScene:
    """A scene in which every infinite coefficient of friction is twice the smallest one that holds along the truth.

    duration: of the run (s). Raises `NotModelled` as `ways.ends` does.
    """
    if not touches(scene) or scene.plane is None:
        return scene
    contacts = scene.contacts if isinstance(scene, Mechanism) else ()
    if not any(map(math.isinf, (scene.plane.friction, *(pair.friction for pair in contacts)))):
        return scene
    smallest = ends(scene, duration).friction
    plane = replace(scene.plane, friction=_finite(scene.plane.friction, smallest))
    if not isinstance(scene, Mechanism):
        return replace(scene, plane=plane)
    limited = tuple(replace(pair, friction=_finite(pair.friction, smallest)) for pair in contacts)
    return replace(scene, plane=plane, contacts=limited)


def _finite(friction: float, smallest: float) -> float:
    return MARGIN * smallest if math.isinf(friction) else friction
