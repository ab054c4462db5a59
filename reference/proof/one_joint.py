"""The motion of one body on a revolute or prismatic joint of the world, in balls.

With springs, dampers and constant forces the equation J q'' = f - d q' - k (q - rest) is linear, and its solution is the
exponential of a matrix. Dry friction adds a constant force against the velocity in phases, whose ends are roots of a closed
form: one root for each phase, which is unique since the equation has second order. A pendulum without other forces has Jacobi's
elliptic functions. Whether a joint sticks is decided by rational numbers at the start, and by balls without zero later.
"""

import contextlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import acb, arb, arb_mat

from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.proof import driven, switching
from bodycheck.reference.proof.balls import (
    Ball,
    Matrix,
    Triple,
    applied,
    ball,
    cross,
    dot,
    product,
    scaled,
    triple,
    turned_about,
    vector_sum,
)
from bodycheck.reference.proof.bodies import as_ball, attitude, inertia, length, sums
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.jacobi import jacobi
from bodycheck.reference.proof.mass import centre_of, mass_of

#: The largest number of phases of a motion with dry friction.
MOST_PHASES = 10_000

#: A function from a time (s) to the coordinate and its velocity.
Coordinate = Callable[[Fraction], tuple[Ball, Ball]]


@dataclass(frozen=True, eq=False)
class OneJoint:
    """The equation of a joint: J q'' = force + rise sin(q) - fall cos(q) - damping q' - stiffness (q - rest), and friction.

    Attributes
    ----------
    inertia, force, damping, stiffness, rest, friction
        Rational numbers, in the units of the joint.
    rise, fall
        The torque of gravity on a revolute joint (N m), as balls.
    start, velocity
        The exact coordinate and its velocity at t = 0.
    """

    inertia: Fraction
    force: Any
    damping: Fraction
    stiffness: Fraction
    rest: Fraction
    friction: Fraction
    rise: Ball
    fall: Ball
    start: Fraction
    velocity: Fraction


def has_one_joint(mechanism: Mechanism) -> bool:
    """Return whether a mechanism is one body on a hinge or slider of the world."""
    alone = len(mechanism.joints) == 1 == len(mechanism.bodies) and mechanism.joints[0].parent == WORLD
    return alone and mechanism.joints[0].type in ("revolute", "prismatic")


def has_closed_form(mechanism: Mechanism) -> bool:
    """Return whether the motion of a mechanism may have a closed form: it has one joint, and is no pendulum with other forces.

    Dry friction and controllers, which trees do not have, count as closed forms, so that their reasons are told.
    """
    if not has_one_joint(mechanism):
        return False
    (joint,) = mechanism.joints
    other = joint.damping or joint.stiffness or joint.effort
    if (
        joint.type == "prismatic"
        or not mechanism.gravity
        or not other
        or joint.friction
        or joint.stops
        or mechanism.controllers
    ):
        return True
    with contextlib.suppress(NotEnclosed):
        *_, one = _read(mechanism)
        return bool(one.rise.is_zero() and one.fall.is_zero())
    return True


def states(mechanism: Mechanism) -> Callable[[Fraction], tuple[tuple[Ball, Ball], Triple, Matrix, Triple, Triple]]:
    """Return a function from a time (s) to the coordinate with its velocity, and the states of the body in balls.

    The states are the position of the centre of mass, the attitude, the velocity, and the angular velocity along the axes of
    the body. The mechanism has one joint (`has_one_joint`). Raises `NotEnclosed` if there is no proof of its motion.
    """
    joint, centre, turn, axis, one = _read(mechanism)
    controller = mechanism.controllers[0] if mechanism.controllers else None
    coordinate = _driven(one, joint.stops, controller) if controller or joint.stops else _coordinate(one)
    origin, in_world = triple(joint.position), applied(turn, axis)

    def at(t: Fraction) -> tuple[tuple[Ball, Ball], Triple, Matrix, Triple, Triple]:
        q, v = coordinate(t)
        if joint.type == "prismatic":
            arm = applied(turn, vector_sum(triple(centre), scaled(q, axis)))
            return (q, v), vector_sum(origin, arm), turn, scaled(v, in_world), (arb(0), arb(0), arb(0))
        now = product(turn, turned_about(axis, q))
        arm = applied(now, triple(centre))
        return (q, v), vector_sum(origin, arm), now, scaled(v, cross(in_world, arm)), scaled(v, axis)

    return at


def _read(mechanism: Mechanism) -> tuple[Joint, tuple[Fraction, Fraction, Fraction], Matrix, Triple, OneJoint]:
    """The joint, the centre of mass of the body in its frame (m), the attitude and the axis of the joint, and its equation."""
    joint, body = _only(mechanism)
    centre = centre_of(body)
    turn = attitude(joint.attitude)
    size = length(triple(joint.axis))
    x, y, z = (part / size for part in triple(joint.axis))
    axis: Triple = (x, y, z)
    return joint, centre, turn, axis, _equation(mechanism, joint, body, centre, turn, axis)


def _only(mechanism: Mechanism) -> tuple[Joint, JointedBody]:
    """The joint and the body of a mechanism that has one of each."""
    joint = mechanism.joints[0]
    for kind, there in (
        ("a loop", mechanism.loops),
        ("a plane", mechanism.plane is not None),
        ("pushes", mechanism.pushes),
        ("stops that cease to act", mechanism.stops_until is not None),
    ):
        if there:
            raise NotEnclosed(kind)
    return joint, mechanism.bodies[0]


def _equation(
    mechanism: Mechanism, joint: Joint, body: JointedBody, centre: tuple[Fraction, ...], turn: Matrix, axis: Triple
) -> OneJoint:
    """The equation of a joint. Raises `NotEnclosed` if its inertia is not rational."""
    mass, gravity, armature = mass_of(body), Fraction(mechanism.gravity), Fraction(joint.armature)
    upwards = turn[2]  # the world's z along the axes of the joint
    force: Any = Fraction(joint.effort)
    rise = fall = arb(0)
    if joint.type == "prismatic":
        moved = mass + armature
        weight = ball(mass * gravity) * dot(upwards, axis)
        force = force if weight.is_zero() else ball(force) - weight
    else:
        a = tuple(map(Fraction, joint.axis))
        square = sums(part * part for part in a)
        rows = inertia(body.inertia)
        if not all(isinstance(value, Fraction) for row in rows for value in row):
            raise NotEnclosed("a solid that is turned by angles, on a joint")
        about_axis = sums(a[i] * rows[i][j] * a[j] for i in range(3) for j in range(3)) / square
        along = sums(x * y for x, y in zip(a, centre, strict=True))
        moved = about_axis + mass * (sums(x * x for x in centre) - along**2 / square) + armature
        across = [x - along * y / square for x, y in zip(centre, a, strict=True)]
        if any(across) and gravity:
            heavy = ball(mass * gravity)
            rise = heavy * dot(upwards, triple(across))
            fall = heavy * dot(upwards, cross(axis, triple(across)))
    numbers = (joint.damping, joint.stiffness, joint.rest, joint.friction)
    damping, stiffness, rest, friction = map(Fraction, numbers)
    (start,), (velocity,) = joint.start or (0.0,), joint.start_velocity or (0.0,)
    return OneJoint(moved, force, damping, stiffness, rest, friction, rise, fall, Fraction(start), Fraction(velocity))


def _coordinate(one: OneJoint) -> Coordinate:
    """The coordinate of a joint as a function of time."""
    if one.rise.is_zero() and one.fall.is_zero():
        return _sliding(one) if one.friction else _linear(one, as_ball(one.force))
    if one.damping or one.stiffness or one.friction or one.force:
        raise NotEnclosed("a pendulum with other forces than gravity")
    return _pendulum(one)


def _driven(one: OneJoint, stops: Stops | None, controller: Controller | None) -> Coordinate:
    """The coordinate of a joint with a controller or with stops."""
    if not (one.rise.is_zero() and one.fall.is_zero()):
        raise NotEnclosed("a controller or a stop beside the torque of gravity")
    plant = driven.Plant(one.inertia, one.force, one.damping, one.stiffness, one.rest, one.start, one.velocity)
    if controller is None or controller.rate is None:
        return switching.coordinate(plant, one.friction, stops, controller)
    if one.friction or stops:
        raise NotEnclosed("a sampled law beside dry friction or stops")
    return driven.sampled(plant, controller)


def _linear(one: OneJoint, force: Ball) -> Coordinate:
    return lambda t: _moved(one, force, ball(one.start), ball(one.velocity), ball(t))


def _moved(one: OneJoint, force: Ball, q: Ball, v: Ball, t: Ball) -> tuple[Ball, Ball]:
    """The coordinate and its velocity after a time under a constant force, by the exponential of a matrix."""
    whole = ball(one.inertia)
    spring, damper = ball(one.stiffness) / whole, ball(one.damping) / whole
    constant = (force + ball(one.stiffness * one.rest)) / whole
    flow = arb_mat(3, 3, [arb(0), t, arb(0), -spring * t, -damper * t, constant * t, arb(0), arb(0), arb(0)]).exp()
    return flow[0, 0] * q + flow[0, 1] * v + flow[0, 2], flow[1, 0] * q + flow[1, 1] * v + flow[1, 2]


@dataclass(frozen=True, eq=False)
class _Phase:
    """A phase of a motion with dry friction: its start, the state there, and the sign of the velocity, 0 where it sticks."""

    begin: Ball
    q: Ball
    v: Ball
    sign: int


def _sliding(one: OneJoint) -> Coordinate:
    """The motion with dry friction, phase by phase; its phases are found as far as they are asked for."""
    force, friction = as_ball(one.force), ball(one.friction)
    v0 = (one.velocity > 0) - (one.velocity < 0)
    phases = [_Phase(arb(0), ball(one.start), ball(one.velocity), v0 or _breaking(one, ball(one.start), at_start=True))]

    def at(t: Fraction) -> tuple[Ball, Ball]:
        time = ball(t)
        while phases[-1].sign and len(phases) < MOST_PHASES:
            last = phases[-1]
            length_of_phase = _until_rest(one, force - last.sign * friction, last)
            if length_of_phase is None or not last.begin + length_of_phase < time:
                break
            end = last.begin + length_of_phase
            q, _ = _moved(one, force - last.sign * friction, last.q, last.v, length_of_phase)
            phases.append(_Phase(end, q, arb(0), _breaking(one, q, at_start=False)))
        now = next((phase for phase in reversed(phases) if phase.begin <= time), None)
        if now is None or (now is not phases[-1] and not phases[phases.index(now) + 1].begin > time):
            raise NotEnclosed("an instant at which a joint may change its direction")
        if not now.sign:
            return now.q, arb(0)
        return _moved(one, force - now.sign * friction, now.q, now.v, time - now.begin)

    return at


def _breaking(one: OneJoint, q: Ball, *, at_start: bool) -> int:
    """The direction in which a joint at rest begins to move; 0 if dry friction holds it."""
    if at_start and isinstance(one.force, Fraction):
        exact = one.force - one.stiffness * (one.start - one.rest)
        return 0 if abs(exact) <= one.friction else (1 if exact > 0 else -1)
    pull = as_ball(one.force) - ball(one.stiffness) * (q - ball(one.rest))
    if abs(pull) < ball(one.friction):
        return 0
    if abs(pull) > ball(one.friction):
        return 1 if pull > 0 else -1
    raise NotEnclosed("a joint of which it is not decided whether it sticks")


def _until_rest(one: OneJoint, force: Ball, phase: _Phase) -> Ball | None:
    """The time until the velocity of a phase is zero again; None if this never happens.

    The velocity obeys v'' + 2 g v' + w^2 v = 0 with g = damping / 2 J and w^2 = stiffness / J.
    """
    whole = ball(one.inertia)
    v, push = phase.v, (force - ball(one.stiffness) * (phase.q - ball(one.rest)) - ball(one.damping) * phase.v) / whole
    g = one.damping / (2 * one.inertia)
    kind = g * g - one.stiffness / one.inertia
    sign = phase.sign
    v, push = sign * v, sign * push  # the velocity is positive within the phase
    slope = push + ball(g) * v
    if kind < 0:
        w = ball(-kind).sqrt()
        return arb.pi() / w if v.is_zero() else arb.atan2(v, -slope / w) / w
    if v.is_zero() or slope >= 0:  # without vibrations a velocity that begins at zero, or like this, does not come back to it
        return None
    if kind == 0:
        return _positive(-v / slope)
    root = ball(kind).sqrt()
    # v = exp(-g t) (v cosh(root t) + slope / root sinh(root t)) is zero where tanh(root t) = -v root / slope.
    ratio = -v * root / slope
    if ratio > 1:
        return None
    return _positive(ratio.atanh() / root)


def _positive(value: Ball) -> Ball:
    if not value > 0:
        raise NotEnclosed("a joint of which it is not decided when it comes to rest")
    return value


def _pendulum(one: OneJoint) -> Coordinate:
    """A pendulum under gravity alone, by Jacobi's functions of the half of its angle from the lowest position."""
    size = (one.rise * one.rise + one.fall * one.fall).sqrt()
    kappa, lowest = size / ball(one.inertia), arb.atan2(-one.fall, -one.rise)
    rate = kappa.sqrt()
    theta, speed = ball(one.start) - lowest, ball(one.velocity)
    pull = one.rise * ball(one.start).sin() - one.fall * ball(one.start).cos()
    if not one.velocity and pull.is_zero():
        return lambda _: (ball(one.start), arb(0))
    half_sine = (theta / 2).sin()
    whole = speed * speed / (4 * kappa) + half_sine * half_sine
    turns = round(float(theta.mid()) / (2 * math.pi))
    if whole < 1:
        return _swinging(theta, turns, speed, rate, whole, half_sine, lowest)
    if whole > 1:
        return _circling(one, theta, speed, rate, whole, lowest)
    raise NotEnclosed("a pendulum that may end upright")


def _swinging(theta: Ball, turns: int, speed: Ball, rate: Ball, m: Ball, half_sine: Ball, lowest: Ball) -> Coordinate:
    """A pendulum that swings: sin(theta / 2) = k sn(u, k^2), theta' = 2 k rate cn(u, k^2)."""
    k = m.sqrt()
    parity = -1 if turns % 2 else 1  # of the half angle, as it is counted from the nearest lowest position
    functions, _ = jacobi(m)
    begin = acb.elliptic_f(acb(arb.atan2(parity * half_sine / k, speed / (2 * rate * k))), acb(m)).real

    def at(t: Fraction) -> tuple[Ball, Ball]:
        sn, cn, _ = functions(begin + rate * ball(t))
        return lowest + 2 * turns * arb.pi() + 2 * (k * sn).asin(), 2 * k * rate * cn

    return at


def _circling(one: OneJoint, theta: Ball, speed: Ball, rate: Ball, whole: Ball, lowest: Ball) -> Coordinate:
    """A pendulum that turns over: theta / 2 is the amplitude of u with the modulus 1 / whole, theta' = 2 rate k dn(u)."""
    m, k = 1 / whole, whole.sqrt()
    functions, quarter = jacobi(m)
    sign = 1 if one.velocity > 0 else -1
    half = sign * theta / 2
    turns = round(float(half.mid()) / math.pi)
    begin = acb.elliptic_f(acb(half - turns * arb.pi()), acb(m)).real + 2 * turns * quarter

    def at(t: Fraction) -> tuple[Ball, Ball]:
        u = begin + rate * k * ball(t)
        full = round(float((u / (2 * quarter)).mid()))
        sn, cn, dn = functions(u - 2 * quarter * full)
        return lowest + sign * 2 * (arb.atan2(sn, cn) + full * arb.pi()), sign * 2 * rate * k * dn

    return at
