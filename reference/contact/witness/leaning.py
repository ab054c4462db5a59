"""The witness of a body that leans on an edge or on its rim and falls: the balance of moments about the contact, integrated.

All moments are about the level axis a through the contact that is perpendicular to the arm r from the contact to the centre of
mass. It is a principal axis of the inertia J about the contact. With s and c the sine and the cosine of the angle between the
arm and the vertical, and w the angular velocity about a,

    ds/dt = w c,    dc/dt = -w s,    a J a dw/dt = |r| m g s.

The force of the plane is the mass times the acceleration of the centre of mass minus the weight; the motion ends where friction
does not hold this force, or another corner reaches the plane. The units of length, time and force are |r|, sqrt(|r| / g) and
m g.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness.faces import (
    AXES,
    DECIMALS,
    along_axes,
    along_plane,
    half_lengths,
    in_world,
    wide_vector,
)
from bodycheck.reference.contact.witness.reading import FreeBody, bodies, surface
from bodycheck.reference.contact.witness.searching import Margin, first_negative, rate_at
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.independent.arithmetic import (
    WIDE_EPS,
    Real,
    Vector,
    Wide,
    applied,
    cross,
    dot,
    minus,
    norm,
    plus,
    scaled,
    transposed,
    wide,
    wide_matrix,
)
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.integration.collocation import FINEST, Derivatives, steps
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Brick, Cylinder
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, WideArray, Witness

#: Name of the way in results.
NAME = "balance of moments about the contact, Gauss-Legendre collocation"

#: The number of nodes of a step, the size of the first step, and the largest number of evaluations of the equations.
STAGES, FIRST, MOST = 20, 0.5, 20_000

#: The factor by which an error may exceed the sum of the last terms of the series of all steps so far.
SAFETY = 8.0

#: The number of roundings of a state in the wide type.
ROUNDINGS = 16.0

#: The factor by which the forces at the contact may change faster than the state.
STIFFEST = 16.0

#: The indices of the components of a state.
S, C, W = range(3)


@dataclass(frozen=True, eq=False)
class Leaning:
    """A body that leans.

    Attributes
    ----------
    body
        The body.
    contact
        The place of the contact (m), world frame.
    arm
        The arm from the contact to the centre of mass along the axes of the body (m).
    corners
        The other corners, from the contact, in the plane of the fall and along the axes of the body (m).
    ahead, about
        The level unit vector towards which the body falls, and the axis of its fall, world frame.
    sluggish
        The inertia about this axis, divided by the mass and the square of the arm.
    apart
        The distance of the contact from the plane divided by the arm, plus the tilt of the edge (rad); both count as zero.
    """

    body: FreeBody
    contact: Vector
    arm: Vector
    corners: list[Vector]
    ahead: Vector
    about: Vector
    sluggish: Real
    apart: float

    @property
    def begin(self) -> tuple[Real, Real]:
        """The sine and the cosine of the angle between the arm and the vertical at the start."""
        arm = scaled(in_world(self.body, self.arm), 1 / norm(self.arm))
        return dot(arm, self.ahead), arm[2]

    @property
    def growth(self) -> float:
        """The rate at which a small error grows at most, in the units of the fall: that of an upright body."""
        return float(1 / MP.sqrt(self.sluggish))


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of a body that leans and is released from rest, at ascending times (n,) >= 0 (s); None for another scene."""
    leaning = _leaning(scene)
    if leaning is None:
        return None
    length, unit = norm(leaning.arm), MP.sqrt(norm(leaning.arm) / MP.mpf(scene.gravity))
    t = times.astype(Wide) / wide(unit)
    margins = _margins(leaning, surface(scene).friction)
    start = wide_vector((*leaning.begin, MP.zero))
    states, errors = np.full((len(t), 3), np.nan, dtype=Wide), np.zeros(len(t))
    states[t == 0] = start
    row, error = int((t == 0).sum()), 0.0
    events: tuple[Instant, ...] = ()
    for step in steps(_equations(leaning), start, stages=STAGES, first=FIRST, most=MOST, memory=1):
        error += SAFETY * max(step.error, FINEST) * float(step.size * np.abs(step.slopes).max())
        ends = {kind: instant for kind, margin in margins.items() if (instant := first_negative(step, margin)) is not None}
        kind = min(ends, key=lambda each: ends[each], default=None)
        until = step.end if kind is None else ends[kind]
        last = int(np.searchsorted(t, until, side="right"))
        states[row:last], errors[row:last], row = step.at(t[row:last]), error, last
        if kind is not None and until <= t[-1]:
            grown = (error + leaning.apart) * float(np.cosh(leaning.growth * until))
            late = STIFFEST * grown / rate_at(step, margins[kind], until) * float(unit)
            time = float(until) * float(unit)
            events = (Instant(kind, time, late + 2 * EPS * time),)
        if kind is not None or row == len(t):
            break
    return _witness(leaning, t, states, errors + leaning.apart, wide(length), wide(unit), events)


def _leaning(scene: AnyScene) -> Leaning | None:
    """The body that leans on a level plane; None if a scene has no such body alone, at rest and not pushed."""
    free = bodies(scene)
    if len(free) != 1 or scene.pushes or surface(scene).normal[0] or not scene.gravity:
        return None
    (body,) = free
    if any(body.rates) or any(body.velocity):
        return None
    upward = along_axes(body, AXES[2])
    sections = _section(body, upward)
    if sections is None:
        return None
    (first, second), tilt = sections
    corners = [plus(scaled(first, MP.mpf(one)), scaled(second, MP.mpf(other))) for one in (-1, 1) for other in (-1, 1)]
    lowest = min(corners, key=lambda corner: dot(corner, upward))
    arm, contact = scaled(lowest, MP.mpf(-1)), plus(body.position, in_world(body, lowest))
    level = along_plane(arm, upward)
    if abs(contact[2]) > DECIMALS * norm(arm) or norm(level) <= DECIMALS * norm(arm):
        return None
    others = [minus(corner, lowest) for corner in corners if corner is not lowest]
    ahead = in_world(body, scaled(level, 1 / norm(level)))
    about = cross(AXES[2], ahead)
    axis = along_axes(body, about)
    moment = applied(body.tensor, axis)
    if norm(minus(moment, scaled(axis, dot(moment, axis)))) > DECIMALS * norm(moment):
        raise NotModelled("a body that does not fall about a principal axis")
    sluggish = 1 + dot(moment, axis) / (body.mass * dot(arm, arm))
    apart = float(abs(contact[2]) / norm(arm) + tilt)
    return Leaning(body, contact, arm, others, ahead, about, sluggish, apart)


def _section(body: FreeBody, upward: Vector) -> tuple[tuple[Vector, Vector], Real] | None:
    """Half the sides of the body's rectangle in the plane of its fall, along its axes (m), and the tilt of its edge (rad).

    None for a body that does not lean on an edge or on its rim. upward: the vertical along the axes of the body.
    """
    match body.shape:
        case Brick():
            level = [axis for axis in range(3) if abs(upward[axis]) <= DECIMALS]
            if len(level) != 1:
                return None
            one, other = (scaled(AXES[axis], half_lengths(body)[axis]) for axis in range(3) if axis != level[0])
            return (one, other), abs(upward[level[0]])
        case Cylinder():
            across = (upward[0], upward[1], MP.zero)
            round_about = body.tensor[0][0] == body.tensor[1][1]
            if min(norm(across), abs(upward[2])) <= DECIMALS or not round_about:
                return None
            side = scaled(across, half_lengths(body)[0] / norm(across))
            return (side, scaled(AXES[2], half_lengths(body)[2])), MP.zero
        case _:
            return None


def _equations(leaning: Leaning) -> Derivatives:
    """The derivatives (n, 3) of states (n, 3)."""
    mobility = wide(1 / leaning.sluggish)

    def derivatives(states: WideArray) -> WideArray:
        sine, cosine, rate = states.T
        return np.stack([rate * cosine, -rate * sine, mobility * sine], axis=1)

    return derivatives


def _margins(leaning: Leaning, friction: Real) -> dict[str, Margin]:
    """The conditions under which the contact stays where it is, each by the event with which it ends."""
    mobility = wide(1 / leaning.sluggish)
    turned = [scaled(in_world(leaning.body, corner), 1 / norm(leaning.arm)) for corner in leaning.corners]
    corners = np.array([wide_vector((dot(corner, leaning.ahead), corner[2])) for corner in turned])

    def held(states: WideArray) -> WideArray:
        sine, cosine, rate = states.T
        turning, pulling = mobility * sine, rate * rate
        normal = 1 - turning * sine - pulling * cosine
        if MP.isinf(friction):
            return np.asarray(normal)
        return np.asarray(wide(friction) * normal - np.abs(turning * cosine - pulling * sine))

    def above(states: WideArray) -> WideArray:
        sine, cosine = _turned(leaning, states)
        return np.asarray((np.outer(cosine, corners[:, 1]) - np.outer(sine, corners[:, 0])).min(axis=1))

    return {"slip": held, "impact": above}


def _turned(leaning: Leaning, states: WideArray) -> tuple[WideArray, WideArray]:
    """The sine and the cosine (n,) of the angle by which a body has turned in states (n, 3)."""
    first_sine, first_cosine = (wide(part) for part in leaning.begin)
    sine, cosine, _ = states.T
    return sine * first_cosine - cosine * first_sine, cosine * first_cosine + sine * first_sine


def _witness(
    leaning: Leaning, t: WideArray, states: WideArray, errors: Array, length: Wide, unit: Wide, events: tuple[Instant, ...]
) -> Witness:
    """The witness with states (n, 3) at times t (n,), in units of the fall, and their errors (n,) before they have grown."""
    body, rate = leaning.body, states[:, W] / unit
    about, begin = wide_vector(leaning.about), wide_matrix(body.cosines)
    skew = wide_matrix(transposed([cross(leaning.about, each) for each in AXES]))
    sine, cosine = _turned(leaning, states)
    turn = np.eye(3, dtype=Wide) + sine[:, None, None] * skew + (1 - cosine)[:, None, None] * (skew @ skew)
    cosines, known = turn @ begin, ~np.isnan(sine)
    attitude = np.full((len(t), 4), np.nan, dtype=Wide)
    attitude[known] = quaternion_of(cosines[known])
    arm, position = begin @ wide_vector(leaning.arm), wide_vector(body.position)
    grown = (errors + ROUNDINGS * WIDE_EPS) * np.cosh(leaning.growth * t.astype(float))
    speed, fastest = float(length / unit), 2 * leaning.growth
    return Witness(
        NAME,
        quaternion=attitude[None],
        angular_velocity=(rate[:, None] * (about @ begin))[None],
        position=position + (turn @ arm - arm)[None],
        velocity=(rate[:, None] * (turn @ np.cross(about, arm)))[None],
        error=grown,
        angular_velocity_error=grown * (1 + fastest) / float(unit),
        position_error=float(length) * grown + ROUNDINGS * WIDE_EPS * float(np.abs(position).max()),
        velocity_error=speed * grown * (1 + fastest),
        events=events,
    )
