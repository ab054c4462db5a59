"""A brick between two fingers on the world, in balls: it is held, or falls along them from rest.

The fingers slide on level joints along an axis of the world and press the brick with constant and equal forces N at the same
height, on the vertical line through its centre of mass, so that friction bears at most 2 mu N without a moment. The brick is
held for m g <= 2 mu N, which rational numbers decide, ties included; else it falls with g - 2 mu N/m until a contact leaves a
face. Where faces touch, two planes of symmetry through the line of the fall leave no moment, however the force is distributed.
"""

import math
from fractions import Fraction

from flint import arb

from bodycheck.reference.mechanisms.control import Controller
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.proof.balls import UNIT, Triple, ball, triple
from bodycheck.reference.proof.contact.start import NONE
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import CLOSED_FORM, Motion, Shown
from bodycheck.reference.scene import Brick, Solid, Sphere

#: Why there is no proof of other bodies on joints that touch.
OTHERS = "bodies on joints that touch, except two fingers on the world that press a brick at rest"


def gripped(scene: Mechanism) -> Motion:
    """Return the motion of a brick between two fingers. Raises `NotEnclosed` for any other bodies on joints that touch."""
    free = [index for index, joint in enumerate(scene.joint_of) if joint is None]
    alone = scene.plane is None and not scene.pushes and not scene.loops
    if len(scene.joints) > 2:
        raise NotEnclosed("fingers on a carriage, or more than two")
    if not alone or len(free) != 1 or len(scene.joints) != 2 or len(scene.contacts) != 2:
        raise NotEnclosed(OTHERS)
    body = scene.bodies[free[0]]
    held, pairs = _solid(body), {law.bodies: law.friction for law in scene.contacts}
    frictions = {pairs.get((min(free[0], joint.child), max(free[0], joint.child))) for joint in scene.joints}
    (one, reach), (other, other_reach) = (_press(scene, index, body) for index in (0, 1))
    friction = frictions.pop()
    if friction is None or frictions or one != -other or scene.joints[0].position[2] != scene.joints[1].position[2]:
        raise NotEnclosed(OTHERS)
    fall = Fraction(0)
    if not math.isinf(friction):
        fall = max(fall, Fraction(scene.gravity) - 2 * Fraction(friction) * abs(one) / Fraction(held.mass))

    def at(t: Fraction) -> Shown:
        fallen = fall * t * t / 2
        if not fallen < min(reach, other_reach):
            raise NotEnclosed("a brick that falls out of its fingers")
        bodies = [_state(scene, index, fallen, fall * t) for index in range(3)]
        return Shown([arb(0), arb(0)], [arb(0), arb(0)], bodies)  # type: ignore[arg-type]

    return Motion(CLOSED_FORM, at, changes=lambda _: [])


def _state(scene: Mechanism, index: int, fallen: Fraction, speed: Fraction) -> tuple[Triple, object, Triple, Triple]:
    """The state of a body, of which the free one has fallen so far (m) and falls with a speed (m/s)."""
    joint, start, still = scene.joint_of[index], scene.bodies[index].start, (arb(0), arb(0), arb(0))
    if joint is not None:
        return triple(joint.position), UNIT, still, still
    assert start is not None  # the body is free
    x, y, z = map(Fraction, start.position)
    return triple((x, y, z - fallen)), UNIT, (arb(0), arb(0), ball(-speed)), still


def _solid(body: JointedBody) -> Solid:
    """The solid of which a body consists, along its axes about its origin, and at rest along those of the world."""
    given, start = body.inertia, body.start
    if not isinstance(given, Solid) or given != Solid(given.shape, given.mass) or body.shape is not None:
        raise NotEnclosed(OTHERS)
    if start is not None and start != BodyStart(start.position):
        raise NotEnclosed(OTHERS)
    return given


def _press(scene: Mechanism, index: int, body: JointedBody) -> tuple[Fraction, Fraction]:
    """The force (N), signed along x or y, with which a finger presses a brick, and the fall (m) after which it leaves it."""
    joint, start = scene.joints[index], body.start
    shape, finger = _solid(body).shape, _solid(scene.bodies[joint.child]).shape
    laws = [law for law in scene.controllers if law.joint == index]
    plain = Joint(
        joint.name, "prismatic", WORLD, joint.child, joint.position, axis=joint.axis, start=(0.0,), start_velocity=(0.0,)
    )
    along = [axis for axis in range(3) if joint.axis[axis]]
    if joint != plain or len(along) != 1 or along == [2] or len(laws) != 1 or not isinstance(shape, Brick) or start is None:
        raise NotEnclosed(OTHERS)
    if not isinstance(laws[0].effort, float) or laws[0] != Controller(index, "effort", effort=laws[0].effort):
        raise NotEnclosed("fingers whose forces change")
    apart = [Fraction(a) - Fraction(b) for a, b in zip(start.position, joint.position, strict=True)]
    halves = [Fraction(half) for half in shape.semi_axes]
    if isinstance(finger, Sphere):
        thickness, overlap = Fraction(finger.radius), halves[2]
    elif isinstance(finger, Brick):
        thickness, overlap = Fraction(finger.semi_axes[along[0]]), halves[2] + Fraction(finger.semi_axes[2])
    else:
        raise NotEnclosed(OTHERS)
    normal, (side,) = along[0], (axis for axis in (0, 1) if axis != along[0])
    force = Fraction(laws[0].effort) * (1 if joint.axis[normal] > 0 else -1)
    touches = abs(ball(abs(apart[normal]) - thickness - halves[normal])) <= NONE * ball(halves[normal])
    below = ball(abs(apart[side])) <= NONE * ball(halves[side])
    if not below:
        raise NotEnclosed("fingers that press a body aside of the vertical line through its centre of mass")
    if not touches or not force * apart[normal] > 0 or not abs(apart[2]) < overlap:
        raise NotEnclosed(OTHERS)
    return force, overlap + apart[2]
