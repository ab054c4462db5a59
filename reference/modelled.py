"""The scenes that the reference has a model of.

Processes that run engines use this module too, and need no other part of the truth.
"""

import functools

import numpy as np

from bodycheck.reference.errors import NotFlat, NotModelled, OutOfReach, within_range
from bodycheck.reference.inertia import IDENTITY
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.planar import planar_state
from bodycheck.reference.requirements import touches
from bodycheck.reference.sliding.friction import footprint_of


def missing_model(scene: AnyScene) -> str | None:
    """The feature of a scene that the reference has no model of, in words, or None if the reference can model the scene."""
    if touches(scene):
        return _missing_contact(scene)
    if scene.pushes:
        return "pushes on what touches nothing"
    if isinstance(scene, Mechanism) or scene.plane is None:
        return None
    if scene.drag:
        return "drag on a body that slides"
    if scene.body.axes != IDENTITY:
        return "a sliding body whose frame is not that of its principal axes"
    try:
        planar_state(scene)
        footprint_of(scene.body.shape, scene.plane.law)
    except NotFlat as error:
        return str(error)
    return None


@functools.lru_cache(maxsize=64)
def _missing_contact(scene: AnyScene) -> str | None:
    """Return the feature of a scene with contact that the reference has no model of, in words, or None."""
    from bodycheck.reference.contact.ways import motion_of  # the ways of contact are imported where they are needed

    try:
        with within_range("the motion"):
            motion_of(scene, np.zeros(1))
    except NotModelled as error:
        return str(error)
    except OutOfReach:  # the motion raises it too, whatever the instants
        return None
    return None
