"""The motion of a scene of bodies that touch, in balls."""

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from flint import arb

from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Mechanism, shape_of
from bodycheck.reference.proof.balls import UNIT, applied, ball, size_of, transposed
from bodycheck.reference.proof.contact import braking, colliding, gripping, lying, resisting, rolling, standing
from bodycheck.reference.proof.contact.start import NONE, Placed, Surroundings, placed, radius_of, surroundings
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import CLOSED_FORM, Motion, Piece, Shown, course
from bodycheck.reference.scene import Cylinder, Plane


def touching(scene: AnyScene) -> Motion:
    """Return the motion of a scene with a plane or with pairs of bodies that touch.

    Raises `NotEnclosed` if there is no proof of it.
    """
    if isinstance(scene, Mechanism) and scene.joints:
        return gripping.gripped(scene)
    plane = surroundings(scene)
    bodies = placed(scene, plane)
    if len(bodies) == 1:
        return _alone(scene, bodies[0], plane)
    assert isinstance(scene, Mechanism)
    if any(law.rolling_friction or law.torsional_friction for law in scene.contact_laws):
        raise NotEnclosed("rolling friction of several bodies")
    if len(bodies) == 2 and all(radius_of(body.shape) is not None for body in bodies) and not scene.pushes:
        return _two(scene, bodies, plane)
    if scene.pushes:
        raise NotEnclosed("pushes on several bodies that touch")
    if scene.plane is None:
        raise NotEnclosed("several bodies that touch without a plane")
    standing.check(bodies, lambda one, other: _law(scene, one, other), plane)
    return Motion(CLOSED_FORM, lambda _: Shown([], [], [body.world for body in bodies]), changes=lambda _: [])


def _law(scene: Mechanism, one: int, other: int) -> Any:
    """The law of two bodies, given by their indices, of which one may be the plane; None if they do not touch."""
    pair = min(one, other), max(one, other)
    return next((each for each in scene.contacts if each.bodies == pair), scene.plane)


def _meet(scene: Mechanism) -> colliding.Meet:
    """Return a function that says whether two spheres in flight touch exactly at a time: gravity moves both alike."""
    one, other = (body.start for body in scene.bodies)
    assert one is not None
    assert other is not None
    pairs = zip((*one.position, *one.velocity), (*other.position, *other.velocity), strict=True)
    apart = [Fraction(b) - Fraction(a) for a, b in pairs]
    reach = sum((Fraction(radius_of(shape_of(body)) or 0) for body in scene.bodies), Fraction(0))
    return lambda t: sum((x + v * t) ** 2 for x, v in zip(apart[:3], apart[3:], strict=True)) == reach**2


def _two(scene: Mechanism, bodies: list[Placed], plane: Surroundings) -> Motion:
    """The motion of two spheres."""
    law = _law(scene, 0, 1)
    if law is None:
        raise NotEnclosed("bodies that pass through each other")
    laws = [None if scene.plane is None else _law(scene, WORLD, index) for index in (0, 1)]
    motion = course(colliding.pieces(bodies, law, laws, plane, None if scene.plane else _meet(scene)))

    def at(t: Fraction) -> Shown:
        if not t:
            return Shown([], [], [body.world for body in bodies])
        states = motion.at(t)
        return Shown([], [], [(x, turn, v, applied(transposed(turn), spin)) for x, turn, v, spin in states])

    return Motion(CLOSED_FORM, at, changes=motion.changes)


def _alone(scene: AnyScene, body: Placed, plane: Surroundings) -> Motion:
    """The motion of one body on a plane."""
    law: Any = scene.plane
    if isinstance(scene, Mechanism):
        law = next((pair for pair in scene.contacts), law)
    elif scene.drag:
        raise NotEnclosed("drag on a plane")
    if law.rolling_friction or law.torsional_friction:
        return _round(resisting.pieces(body, law, plane), body, plane)
    face = lying.face_of(body)
    if face is not None and _slides(scene, body, plane):
        states = braking.states(body, law, plane)
        return Motion(CLOSED_FORM, lambda t: Shown([], [], [states(ball(t)) if t else body.world]))
    if face is not None:
        return _lying(scene, body, face, law, plane)
    if radius_of(body.shape) is None and not isinstance(body.shape, Cylinder):
        raise NotEnclosed("a body that stands on an edge, or falls on a plane")
    if scene.pushes:
        raise NotEnclosed("pushes on a round body")
    return _round(rolling.pieces(body, law, plane), body, plane)


def _slides(scene: AnyScene, body: Placed, plane: Surroundings) -> bool:
    """Return whether a body that lies flat does so across its axis K on a level plane, with friction over an area."""
    if isinstance(scene, Mechanism) or plane.incline or scene.pushes or scene.plane is None or math.isinf(scene.plane.friction):
        return False
    return bool(size_of((body.attitude[0][2], body.attitude[1][2])) <= NONE)


def _lying(scene: AnyScene, body: Placed, face: lying.Face, law: Plane, plane: Surroundings) -> Motion:
    if any(not part.is_zero() for part in body.spin):
        raise NotEnclosed("a block that spins under a push or on an incline")
    pieces = course(lying.pieces(body, face, law, plane, scene.pushes))

    def at(t: Fraction) -> Shown:
        if not t:
            return Shown([], [], [body.world])
        (x, y), (u, v) = pieces.at(t)
        still = (arb(0), arb(0), arb(0))
        return Shown([], [], [plane.shown((x, y, body.position[2]), UNIT, body.attitude, (u, v, arb(0)), still)])

    return Motion(CLOSED_FORM, at, changes=pieces.changes)


def _round(pieces: Iterator[Piece], body: Placed, plane: Surroundings) -> Motion:
    phases = course(pieces)

    def at(t: Fraction) -> Shown:
        if not t:
            return Shown([], [], [body.world])
        position, velocity, spin, turn = phases.at(t)
        return Shown([], [], [plane.shown(position, turn, body.attitude, velocity, spin)])

    return Motion(CLOSED_FORM, at, changes=phases.changes)
