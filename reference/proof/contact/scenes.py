"""The motion of a scene of bodies that touch, in balls."""

from fractions import Fraction
from typing import Any

from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.proof.contact import rolling
from bodycheck.reference.proof.contact.start import Placed, Surroundings, placed, surroundings
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import CLOSED_FORM, Motion, Shown, course
from bodycheck.reference.scene import Plane


def touching(scene: AnyScene) -> Motion:
    """Return the motion of a scene with a plane or with pairs of bodies that touch.

    Raises `NotEnclosed` if there is no proof of it.
    """
    if scene.plane is None:
        raise NotEnclosed("spheres that hit each other")
    plane = surroundings(scene)
    bodies = placed(scene, plane)
    if len(bodies) == 1:
        return _alone(scene, bodies[0], plane)
    raise NotEnclosed("several bodies on a plane")


def _alone(scene: AnyScene, body: Placed, plane: Surroundings) -> Motion:
    """The motion of one body on a plane."""
    law: Any = scene.plane
    if isinstance(scene, Mechanism):
        law = next((pair for pair in scene.contacts), law)
    for kind, there in (("pushes", scene.pushes), ("drag", not isinstance(scene, Mechanism) and scene.drag)):
        if there:
            raise NotEnclosed(f"a body on a plane with {kind}")
    if law.rolling_friction or law.torsional_friction:
        raise NotEnclosed("rolling friction")
    if not rolling.is_round(body.shape):
        raise NotEnclosed("a body that lies, stands or falls on a plane")
    return _round(body, law, plane)


def _round(body: Placed, law: Plane, plane: Surroundings) -> Motion:
    phases = course(rolling.pieces(body, law, plane))

    def at(t: Fraction) -> Shown:
        if not t:
            return Shown([], [body.world])
        position, velocity, spin, turn = phases.at(t)
        return Shown([], [plane.shown(position, turn, body.attitude, velocity, spin)])

    return Motion(CLOSED_FORM, at, changes=phases.changes)
