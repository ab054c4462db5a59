"""The ways that compute motions of bodies that touch. The first way that models a scene computes its motion.

Two spheres that hit each other are the last way. It starts from the scene, since it needs all digits of the file, and needs no
plane. Bodies on joints, which are fingers that grip a free body, have a way of their own.

Engines have no infinite coefficient of friction: `finite` replaces it by a coefficient that is large enough to prevent slip.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bodycheck.reference.contact import dropped
from bodycheck.reference.contact.coin.way import rolling_coin
from bodycheck.reference.contact.flat import block
from bodycheck.reference.contact.gripping import way as way_of_grips
from bodycheck.reference.contact.leaning import rod
from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.piles import pushed, rest
from bodycheck.reference.contact.problem import Problem
from bodycheck.reference.contact.problem import problem as problem_of
from bodycheck.reference.contact.resistance import motion as resistance
from bodycheck.reference.contact.round.alone import cylinder, sphere
from bodycheck.reference.contact.spheres import way as way_of_spheres
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.requirements import grips, touches
from bodycheck.reference.trajectory import Array

#: A way: a function that returns the motion of a problem at ascending times (n,) >= 0 (s), or None for a problem that is not of
#: its kind. It raises `NotModelled`, with the reason, for a problem of its kind without a known motion or inequality.
Way = Callable[[Problem, Array], ContactMotion | None]

WAYS: tuple[Way, ...] = (
    resistance.sphere,
    sphere,
    cylinder,
    rod.motion,
    rolling_coin,
    block.motion,
    rest.motion,
    pushed.motion,
    dropped.motion,
)

#: The reason why a motion has no truth.
NO_WAY = "such a motion of bodies that touch (docs/truth.md lists those that it models)"

#: The factor by which the coefficient of friction for engines exceeds the smallest coefficient that holds.
MARGIN = 2.0


def contact_motion(problem: Problem, times: Array) -> ContactMotion:
    """The motion of bodies on a plane at ascending times (n,) >= 0 (s). Raises `NotModelled` if no way models the problem."""
    if (motion := _on_plane(problem, times)) is None:
        raise NotModelled(NO_WAY)
    return motion


def motion_of(scene: AnyScene, times: Array) -> ContactMotion:
    """The motion of bodies that touch at ascending times (n,) >= 0 (s). Raises `NotModelled` if no way models the scene."""
    if grips(scene):
        return way_of_grips.motion(scene, times)
    motion = None if scene.plane is None else _on_plane(problem_of(scene), times)
    if motion is None and isinstance(scene, Mechanism):
        if any(law.rolling_friction or law.torsional_friction for law in scene.contact_laws):
            raise NotModelled("rolling or torsional friction of spheres that hit each other")
        motion = way_of_spheres.motion(scene, times)
    if motion is None:
        raise NotModelled(NO_WAY)
    return motion


def _on_plane(problem: Problem, times: Array) -> ContactMotion | None:
    return next((motion for way in WAYS if (motion := way(problem, times)) is not None), None)


@functools.lru_cache(maxsize=8)
def ends(scene: AnyScene, duration: float) -> ContactMotion:
    """The motion of a scene of bodies that touch, at the start and at the end of a run. duration: of the run (s).

    An engine's run of the scene needs two of its results: the friction that prevents slip, and the loads between bodies at
    rest. The result is cached, so that a process that runs the scene with many methods computes it once. Raises `NotModelled`
    as `motion_of` does.
    """
    return motion_of(scene, np.array([0.0, duration]))


def finite(scene: AnyScene, duration: float) -> AnyScene:
    """The scene, with `MARGIN` times the smallest coefficient that holds in place of every infinite coefficient of friction.

    duration: of the run (s). Raises `NotModelled` as `ends` does.
    """
    if not touches(scene):
        return scene
    contacts = scene.contacts if isinstance(scene, Mechanism) else ()
    if not any(math.isinf(law.friction) for law in (scene.plane, *contacts) if law is not None):
        return scene
    smallest = ends(scene, duration).friction
    plane = None if scene.plane is None else replace(scene.plane, friction=_finite(scene.plane.friction, smallest))
    if not isinstance(scene, Mechanism):
        return replace(scene, plane=plane)
    limited = tuple(replace(pair, friction=_finite(pair.friction, smallest)) for pair in contacts)
    return replace(scene, plane=plane, contacts=limited)


def _finite(friction: float, smallest: float) -> float:
    return MARGIN * smallest if math.isinf(friction) else friction
