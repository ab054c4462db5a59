"""The witness of a block that lies flat on a plane: Newton's law with Coulomb's law of friction, integrated in the world frame.

A block that moves is followed by `slide` until it stops or the pushes change. Whether a block at rest stays is decided with a
hundred digits from the numbers of the file. With h the height of the centre of mass, f the friction, N the normal force, n the
normal, and M the moment of the pushes about the centre of mass, the moments balance if the normal force acts at the distance
s = -(h f + n x M) / N from the foot of the centre of mass, and n . (M + s x f) = 0. The block tips where s leaves its face.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness.faces import (
    DECIMALS,
    STILL,
    along_axes,
    along_plane,
    half_lengths,
    in_world,
    numbers,
    wide_vector,
)
from bodycheck.reference.contact.witness.faces import axis as axis_of
from bodycheck.reference.contact.witness.reading import FreeBody, bodies, surface
from bodycheck.reference.contact.witness.searching import Margin, first_negative
from bodycheck.reference.contact.witness.slide import Piece, T, V, slide
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.independent.arithmetic import (
    ROUNDED,
    WIDE_EPS,
    Real,
    Vector,
    Wide,
    cross,
    dot,
    norm,
    plus,
    scaled,
    wide,
)
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.directions import exact_quaternion
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Brick, Cylinder
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, WideArray, Witness

#: A motion: a function from times (k,) since its start (s) to displacements (k, 3), m, and velocities (k, 3), m/s.
Motion = Callable[[WideArray], tuple[WideArray, WideArray]]

#: Name of the way in results.
NAME = "Newton's law in logarithmic time, Gauss-Legendre collocation"

#: The number of roundings of a state in the wide type, relative to its largest terms.
ROUNDINGS = 16.0

#: The part of a half-length by which a load may be outside a face because of the rounding of the numbers that compute it.
ON_BORDER = 32 * WIDE_EPS


@dataclass(frozen=True, eq=False)
class Forces:
    """The forces on a block from one instant to another.

    Attributes
    ----------
    start, end
        The instants (s).
    drive
        The force along the plane, without friction (N).
    press
        The normal force (N).
    moment
        The moment of the pushes about the centre of mass (N m).
    rough
        The sum of the sizes of the moments, below 1e-12 of which a moment is rounding (N m).
    """

    start: Real
    end: Real
    drive: Vector
    press: Real
    moment: Vector
    rough: Real


@dataclass(frozen=True, eq=False)
class Block:
    """A block that lies flat.

    Attributes
    ----------
    body
        The body.
    normal
        The normal of the plane.
    height
        The half-length along the normal (m).
    friction
        The coefficient of friction; it may be infinite.
    """

    body: FreeBody
    normal: Vector
    height: Real
    friction: Real

    def load_at(self, forces: Forces, friction: Vector) -> Vector:
        """The point where the normal force acts, from the foot of the centre of mass (m). friction: its force (N)."""
        lever = plus(scaled(friction, self.height), cross(self.normal, forces.moment))
        return scaled(lever, -1 / forces.press)

    def turning(self, forces: Forces, friction: Vector) -> Real:
        """The moment about the normal (N m), with the normal force where it balances the other moments."""
        return dot(self.normal, plus(forces.moment, cross(self.load_at(forces, friction), friction)))

    def margin(self, along_axes: Any) -> Any:
        """A number that is positive for a point in the face, and negative beyond its border by more than rounding.

        along_axes: the components of the point along the axes of the body (m), as numbers or as arrays.
        """
        halves = wide_vector(half_lengths(self.body)) * (1 + Wide(ON_BORDER))
        if isinstance(self.body.shape, Cylinder):
            return halves[0] ** 2 - along_axes[0] * along_axes[0] - along_axes[1] * along_axes[1]
        flat = [axis for axis in range(3) if abs(dot(axis_of(self.body, axis), self.normal)) <= DECIMALS]
        one, other = (halves[axis] - abs(along_axes[axis]) for axis in flat)
        return np.minimum(one, other)


@dataclass(eq=False)
class Path:
    """The motion so far, at instants (n,), s. Rows before `row` are known.

    Attributes
    ----------
    times
        The instants (s).
    places, velocities
        (n, 3) displacements from the start (m) and velocities (m/s); NaN where they are not known.
    moved, place_error, velocity_error
        The displacement at the end of the motion so far (m), and the bounds of errors there.
    late
        The error of the instant of the last stop (s).
    errors
        (n, 2) bounds of the errors of displacements and velocities.
    events
        The events so far.
    row
        The number of instants so far.
    """

    times: WideArray
    places: WideArray
    velocities: WideArray
    errors: Array
    moved: WideArray = field(default_factory=lambda: np.zeros(3, dtype=Wide))
    place_error: float = 0.0
    velocity_error: float = 0.0
    late: float = 0.0
    events: list[Instant] = field(default_factory=list)
    row: int = 0

    def fill(self, until: Real, motion: Motion, since: Real) -> None:
        """Store states up to an instant (s). motion: maps times after `since` (s) to displacements and velocities."""
        last = int(np.searchsorted(self.times, wide(until) if until < MP.inf else Wide(np.inf), side="right"))
        rows = slice(self.row, last)
        if last > self.row:
            passed = self.times[rows] - wide(since)
            way, velocity = motion(passed)
            self.places[rows], self.velocities[rows] = self.moved + way, velocity
            self.errors[rows, 0] = self.place_error + self.velocity_error * passed.astype(float)
            self.errors[rows, 1] = self.velocity_error
            self.row = last

    def record(self, kind: str, time: Real, error: float = 0.0) -> None:
        """Store an event at an instant (s), with the error of the instant without its rounding to a double (s)."""
        self.events.append(Instant(kind, float(time), error + 2 * EPS * float(time)))


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of one block that lies flat, at ascending times (n,) >= 0 (s); None for a scene of another kind.

    Raises `NotModelled` where the block turns or lifts off, and `OutOfReach` where the integration needs too many steps.
    """
    block = _block(scene)
    if block is None:
        return None
    path = _followed(scene, block, times)
    body, count = block.body, len(times)
    begin = wide_vector(body.position)
    attitude = exact_quaternion([list(row) for row in body.cosines])
    unknown = np.isnan(path.places[:, 0])
    size = np.sqrt((begin.astype(float) ** 2).sum()) + np.sqrt((path.places.astype(float) ** 2).sum(axis=1))
    speeds = np.sqrt((path.velocities.astype(float) ** 2).sum(axis=1))
    rising = abs(float(dot(body.velocity, block.normal)))
    return Witness(
        NAME,
        quaternion=np.where(unknown[:, None], Wide(np.nan), np.tile(attitude, (1, count, 1))),
        angular_velocity=np.zeros((1, count, 3), dtype=Wide),
        position=(begin + path.places)[None],
        velocity=path.velocities[None],
        error=ROUNDINGS * WIDE_EPS,
        position_error=path.errors[:, 0] + ROUNDINGS * WIDE_EPS * size,
        velocity_error=path.errors[:, 1] + ROUNDINGS * WIDE_EPS * speeds + rising,
        events=tuple(path.events),
    )


def _block(scene: AnyScene) -> Block | None:
    """The block of a scene; None if the scene has more bodies, or its body does not lie flat or spins."""
    free, plane = bodies(scene), surface(scene)
    if len(free) != 1 or not isinstance(free[0].shape, Brick | Cylinder):
        return None
    (body,), normal = free, plane.normal
    faces = (2,) if isinstance(body.shape, Cylinder) else (0, 1, 2)
    upright = [axis for axis in faces if norm(along_plane(axis_of(body, axis), normal)) <= DECIMALS]
    if not upright or any(body.rates):
        return None
    height = half_lengths(body)[upright[0]]
    if abs(dot(body.position, normal) - height) > DECIMALS * height:
        return None
    if abs(dot(body.velocity, normal)) > DECIMALS * norm(along_plane(body.velocity, normal)):
        return None
    return Block(body, normal, height, plane.friction)


def _forces(scene: AnyScene, block: Block) -> list[Forces]:
    """The forces on a block, from 0 to infinity. Raises `NotModelled` if nothing presses the block on the plane."""
    body, normal = block.body, block.normal
    marks = sorted({MP.zero, MP.inf, *(MP.mpf(time) for push in scene.pushes for time in (push.start, push.end))})
    weight = scaled((MP.zero, MP.zero, MP.mpf(-1)), body.mass * MP.mpf(scene.gravity))
    collected = []
    for start, end in pairwise(marks):
        pushes = [push for push in scene.pushes if push.start <= start < push.end]
        pushed = [numbers(push.force) for push in pushes]
        arms = [in_world(body, numbers(push.point)) for push in pushes]
        force = plus(weight, *pushed)
        press = -dot(force, normal)
        if press <= 0:
            raise NotModelled("a block that nothing presses on the plane")
        moment = plus(STILL, *(cross(arm, each) for arm, each in zip(arms, pushed, strict=True)))
        rough = sum(((norm(arm) + block.height) * norm(each) for arm, each in zip(arms, pushed, strict=True)), MP.zero)
        collected.append(Forces(start, end, along_plane(force, normal), press, moment, rough))
    return collected


def _followed(scene: AnyScene, block: Block, times: Array) -> Path:
    """The motion of a block at times (n,), s, until it tips."""
    count, last = len(times), float(np.max(times, initial=0.0))
    places, velocities = (np.full((count, 3), np.nan, dtype=Wide) for _ in range(2))
    path = Path(times.astype(Wide), places, velocities, np.zeros((count, 2)))
    velocity = along_plane(block.body.velocity, block.normal)
    moves = any(velocity)
    for forces in _forces(scene, block):
        time = forces.start
        while time < forces.end and time <= last:
            rests = not any(velocity) and bool(norm(forces.drive) <= block.friction * forces.press)
            friction = scaled(forces.drive, MP.mpf(-1)) if rests else _braking(block, forces, velocity)
            rounding = ROUNDED * block.height * norm(friction)
            if abs(block.turning(forces, friction)) > DECIMALS * forces.rough + rounding:
                raise NotModelled("a push that turns a block about the normal of the plane")
            if block.margin(wide_vector(along_axes(block.body, block.load_at(forces, friction)))) < 0:
                path.record("tip", time)
                path.fill(time, _uniform(velocity, STILL), time)
                return path
            if rests and moves:
                path.record("rest", time, path.late)
            elif not rests and not any(velocity):
                path.record("slip", time, path.late)
            moves, path.late = not rests, 0.0
            if rests or not any(velocity):
                acceleration = STILL if rests else scaled(plus(forces.drive, friction), 1 / block.body.mass)
                time, velocity = _uniformly(path, forces, time, acceleration)
            elif (slid := _slid(block, forces, path, time, velocity, last)) is None:
                return path
            else:
                time, velocity = slid
    return path


def _braking(block: Block, forces: Forces, velocity: Vector) -> Vector:
    """The force of friction (N) on a block that slides with a velocity (m/s), or begins to slip along the drive."""
    if MP.isinf(block.friction):
        raise NotModelled("a block that moves along a plane on which nothing slips")
    direction = velocity if any(velocity) else forces.drive
    return scaled(direction, -block.friction * forces.press / norm(direction))


def _uniform(velocity: Vector, acceleration: Vector) -> Motion:
    """The motion from a velocity (m/s) with an acceleration (m/s^2)."""
    first, rate = wide_vector(velocity), wide_vector(acceleration)

    def motion(passed: WideArray) -> tuple[WideArray, WideArray]:
        t = passed[:, None]
        return first * t + rate * t * t / 2, first + rate * t

    return motion


def _uniformly(path: Path, forces: Forces, time: Real, acceleration: Vector) -> tuple[Real, Vector]:
    """Follow a block from rest with an acceleration (m/s^2) until the forces change. Returns the instant and the velocity."""
    path.velocity_error = 0.0
    path.fill(forces.end, _uniform(STILL, acceleration), time)
    passed = forces.end - time
    if MP.isinf(passed):
        return forces.end, STILL
    path.moved = path.moved + wide_vector(scaled(acceleration, passed * passed / 2))
    return forces.end, scaled(acceleration, passed)


def _slid(block: Block, forces: Forces, path: Path, time: Real, velocity: Vector, last: float) -> tuple[Real, Vector] | None:
    """Follow a block that slides from a velocity (m/s) until it stops, the forces change, or the instant `last` is past (s).

    Returns the instant (s) and the velocity (m/s) then; None if the block tips.
    """
    mass, end, force = block.body.mass, forces.end - time, norm(forces.drive)
    longest = Wide(np.inf) if MP.isinf(end) else wide(end)
    ahead = scaled(forces.drive, 1 / force) if force else scaled(velocity, 1 / norm(velocity))
    basis = ahead, cross(block.normal, ahead)
    along, across = (dot(velocity, axis) for axis in basis)
    turns = abs(across) > ROUNDED * norm(velocity)
    begin = wide_vector((along, across if turns else MP.zero))
    axes = np.array([wide_vector(axis) for axis in basis])
    brake = block.friction * forces.press
    excess, friction = wide((force - brake) / mass), wide(brake / mass)
    for piece in slide(begin, excess, friction):
        path.velocity_error = max(path.velocity_error, piece.error * float(piece.speed))
        tip = _tips(piece, _tipping(block, forces, axes)) if turns else Wide(np.inf)
        until = min(longest, piece.until, tip)
        instant = forces.end if until == longest else time + MP.convert(until)
        path.fill(instant, _along(piece, axes), time)
        if until == tip:
            path.record("tip", instant, path.velocity_error * float(piece.time / piece.speed))
            return None
        if piece.stopped or until == longest or instant > last:
            break
    (way,), (left,) = piece.at(np.array([piece.step.end])) if until == piece.until else piece.states(np.array([until]))
    path.moved = path.moved + way @ axes
    path.place_error += path.velocity_error * float(until)
    if piece.stopped and until < longest:
        path.late = path.velocity_error / float(-excess if left[0] > 0 else excess + 2 * friction)
        return instant, STILL
    return instant, plus(*(scaled(each, MP.convert(part)) for each, part in zip(basis, left, strict=True)))


def _along(piece: Piece, axes: WideArray) -> Motion:
    """The motion of a piece of a slide in the world. axes: (2, 3) axes along the plane."""

    def motion(passed: WideArray) -> tuple[WideArray, WideArray]:
        ways, velocities = piece.states(passed)
        return ways @ axes, velocities @ axes

    return motion


def _tips(piece: Piece, margin: Margin) -> Wide:
    """The time since the start of a slide at which a block tips (s); infinite if it does not tip along a piece."""
    tips = first_negative(piece.step, margin)
    return Wide(np.inf) if tips is None else Wide(piece.step.at(np.array([tips]))[0, T] * piece.time)


def _tipping(block: Block, forces: Forces, axes: WideArray) -> Margin:
    """The margin of the load in the face of a block that slides, as a function of the states of a slide along axes (2, 3)."""
    to_body = axes @ np.array([wide_vector(row) for row in block.body.cosines])
    arm = wide_vector(along_axes(block.body, scaled(cross(block.normal, forces.moment), -1 / forces.press)))
    reach = wide(block.friction * block.height)

    def margin(states: WideArray) -> WideArray:
        velocities = states[:, V]
        directions = velocities / np.sqrt((velocities * velocities).sum(axis=1))[:, None]
        return np.asarray(block.margin((arm + reach * directions @ to_body).T))

    return margin
