"""A block that lies flat on a plane in balls: it rests, is pushed, slides straight or across the fall line, and tips.

Between the instants at which pushes begin and end, a constant force D drives the block along the plane, and a constant force N
presses it on the plane. It rests for |D| <= mu N; while it slides, friction mu N is against its velocity. On a level plane all
forces are rational numbers, so that a force that equals the friction is seen to hold. On an incline, whose angle is rational,
sine and cosine have no rational relation, so that more digits decide.

With the height h of the centre of mass, the friction F, and the sum w over pushes of (height of the point) (force along the
plane) - (position of the point along the plane) (force along the normal), the normal forces act at (w - h F)/N from the foot of
the centre. The block tips if this point is outside its face.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from bodycheck.reference.proof.balls import Ball, applied, ball, size_of, transposed, triple
from bodycheck.reference.proof.contact.slipping import Pair, Slip, slipping
from bodycheck.reference.proof.contact.start import NONE, Placed, Surroundings
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.motions import Piece
from bodycheck.reference.scene import Brick, Cylinder, Plane, Push

#: A force along the plane and one on the plane, per mass: rational numbers on a level plane, otherwise balls (m/s^2).
Drive = tuple[Any, Any]


@dataclass(frozen=True, eq=False)
class Face:
    """The face of a block: the height of its centre of mass, the edges with half-lengths, or the radius of a disk (m)."""

    height: Ball
    edges: tuple[tuple[Pair, Ball], ...]
    radius: Ball | None

    def bears(self, x: Ball, y: Ball) -> bool:
        """Return whether a point, from the foot of the centre of mass, is in the face, borders included."""
        margins = [half * (1 + NONE) - abs(x * a + y * b) for (a, b), half in self.edges]
        if self.radius is not None:
            margins.append(self.radius * (1 + NONE) - size_of((x, y)))
        if all(margin >= 0 for margin in margins):
            return True
        if any(margin < 0 for margin in margins):
            return False
        raise NotEnclosed("a block of which it is not decided whether it tips")

    def holds(self, x: Ball, y: Ball) -> bool:
        """Return whether a point, from the foot of the centre of mass, is known to be inside the face."""
        inside = all(abs(x * a + y * b) < half for (a, b), half in self.edges)
        return inside and (self.radius is None or bool(size_of((x, y)) < self.radius))

    @property
    def smallest(self) -> Ball:
        """The distance of the foot of the centre of mass from the border."""
        halves = [half for _, half in self.edges]
        return self.radius if self.radius is not None else halves[0].min(halves[1])


def face_of(body: Placed) -> Face | None:
    """Return the face on which a body lies; None for a body that does not lie flat on the plane."""
    face = at_height(body)
    return face if face is not None and abs(body.position[2] - face.height) <= NONE * face.height else None


def at_height(body: Placed) -> Face | None:
    """Return the face of a brick or cylinder that is parallel to the plane, at any height; None for another body."""
    columns = transposed(body.attitude)
    match body.shape:
        case Brick(semi_axes):
            halves = tuple(map(ball, semi_axes))
            axes: tuple[int, ...] = (0, 1, 2)
        case Cylinder(radius, half_length):
            halves, axes = (ball(radius), ball(radius), ball(half_length)), (2,)
        case _:
            return None
    up = next((axis for axis in axes if size_of(columns[axis][:2]) <= NONE), None)
    if up is None:
        return None
    if isinstance(body.shape, Cylinder):
        return Face(halves[2], (), halves[0])
    return Face(halves[up], tuple(((columns[i][0], columns[i][1]), halves[i]) for i in range(3) if i != up), None)


@dataclass(frozen=True, eq=False)
class Load:
    """The forces on a block from one instant to another (s): D/m and N/m (m/s^2), and w/m (m^2/s^2)."""

    begin: Fraction
    end: Fraction | None
    drive: Drive
    press: Any
    lever: Pair


def pieces(body: Placed, face: Face, law: Plane, plane: Surroundings, pushes: tuple[Push, ...]) -> Iterator[Piece]:
    """Return the pieces of the motion of a block, whose states are the position and the velocity along the plane."""
    position: Pair = (body.position[0], body.position[1])
    velocity: Pair = (body.velocity[0], body.velocity[1])
    moved = False
    for load in _loads(body, plane, pushes):
        time = ball(load.begin)
        end = None if load.end is None else ball(load.end)
        while end is None or not time >= end:
            rests = _rests(load, law, velocity)
            if not _stays(load, face, law, velocity, rests=rests):
                yield Piece(time, time, _resting(position, velocity), (("tip", 0),))
                return
            if rests:
                if moved:
                    yield Piece(time, time, _resting(position, velocity), (("rest", 0),))
                yield Piece(time, end, _resting(position, velocity))
                moved = False
                break
            if velocity[0].is_zero() and velocity[1].is_zero():
                yield Piece(time, time, _resting(position, velocity), (("slip", 0),))
            moved = True
            slide = _sliding(load, law, velocity)
            stops = None if slide.duration is None else time + slide.duration
            if stops is None or (end is not None and stops > end):
                yield Piece(time, end, _along(position, slide))
                if end is None:
                    return
                velocity, path = slide.at(end - time)
                position = (position[0] + path[0], position[1] + path[1])
                break
            if end is not None and not stops < end:
                raise NotEnclosed("a block of which it is not decided whether it stops before a push changes")
            assert slide.ended is not None
            yield Piece(time, stops, _along(position, slide))
            time = stops
            position, velocity = (position[0] + slide.ended[0], position[1] + slide.ended[1]), (arb(0), arb(0))


def _resting(position: Pair, velocity: Pair) -> Any:
    return lambda _: (position, velocity)


def _along(position: Pair, slide: Slip) -> Any:
    def states(t: Ball) -> tuple[Pair, Pair]:
        velocity, path = slide.at(t)
        return (position[0] + path[0], position[1] + path[1]), velocity

    return states


def _loads(body: Placed, plane: Surroundings, pushes: tuple[Push, ...]) -> Iterator[Load]:
    """Yield the forces on a block, one interval after another."""
    ends = {Fraction(end) for push in pushes for end in (push.start, push.end) if 0 < end < math.inf}
    instants = [Fraction(0), *sorted(ends), None]
    back = transposed(plane.to_world)
    for begin, end in itertools.pairwise(instants):
        assert begin is not None
        (x, press), y, u, v = plane.along, 0 * plane.along[0], arb(0), arb(0)
        for push in pushes:
            if not push.start <= begin < push.end:
                continue
            fx, fy, fz = (Fraction(part) / body.mass for part in push.force)
            if plane.incline:
                fx, fy, fz = applied(back, triple((fx, fy, fz)))
            px, py, pz = applied(body.attitude, triple(push.point))
            x, y, press = x + fx, y + fy, press - fz
            a, b, c = (part if isinstance(part, arb) else ball(part) for part in (fx, fy, fz))
            u, v = u + pz * a - px * c, v + pz * b - py * c
        yield Load(begin, end, (x, y), press, (u, v))


def _as_balls(values: tuple[Any, ...]) -> tuple[Ball, ...]:
    return tuple(value if isinstance(value, arb) else ball(value) for value in values)


def _rests(load: Load, law: Plane, velocity: Pair) -> bool:
    if not (velocity[0].is_zero() and velocity[1].is_zero()):
        return False
    if math.isinf(law.friction):
        return True
    (x, y), brake = load.drive, load.press * Fraction(law.friction) if isinstance(load.press, Fraction) else None
    if brake is not None:
        return bool(x * x + y * y <= brake * brake)
    margin = (ball(law.friction) * load.press) ** 2 - x * x - y * y
    if margin >= 0 or margin < 0:
        return bool(margin >= 0)
    raise NotEnclosed("a block of which it is not decided whether it rests")


def _sliding(load: Load, law: Plane, velocity: Pair) -> Slip:
    """The slide of a block, whose drive is turned to be along x."""
    (x, y), (press,) = _as_balls(load.drive), _as_balls((load.press,))
    brake = ball(law.friction) * press
    if y.is_zero() and x >= 0:
        return slipping(velocity, x, brake)
    size = size_of((x, y))
    c, s = x / size, y / size
    if y.is_zero():
        c, s = arb(-1), arb(0)
    u, v = velocity
    turned = slipping((c * u + s * v, c * v - s * u), size, brake)

    def back(pair: Pair) -> Pair:
        return c * pair[0] - s * pair[1], s * pair[0] + c * pair[1]

    def at(t: Ball) -> tuple[Pair, Pair]:
        now, path = turned.at(t)
        return back(now), back(path)

    return Slip(turned.duration, None, at, None if turned.ended is None else back(turned.ended))


def _stays(load: Load, face: Face, law: Plane, velocity: Pair, *, rests: bool) -> bool:
    """Return whether a block does not tip as a piece of its motion begins."""
    (x, y), (press,) = _as_balls(load.drive), _as_balls((load.press,))
    if not press > 0:
        raise NotEnclosed("a block that may lift off")
    moves = not (velocity[0].is_zero() and velocity[1].is_zero())
    if rests:
        force = (-x, -y)
    else:
        direction = velocity if moves else (x, y)
        brake = -ball(law.friction) * press / size_of(direction)
        force = (brake * direction[0], brake * direction[1])
    (u, v), h = load.lever, face.height
    stays = face.bears((u - h * force[0]) / press, (v - h * force[1]) / press)
    turns = moves and not (x * velocity[1] - y * velocity[0]).is_zero()
    if stays and turns and not h * ball(law.friction) < face.smallest:
        raise NotEnclosed("a slide across the fall line in which a block may tip")
    return stays
