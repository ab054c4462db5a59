"""Towers of bricks and standing cylinders at rest on a plane, in balls: each bears those above it.

The bodies rest if the centre of mass of all that a face bears, projected along gravity, is inside the face and inside the face
below it, and if friction holds at each face. Gaps and overlaps of up to `NONE` of a half-length come from decimals. Bodies that
rest on several others, and spheres, have no proof.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from bodycheck.reference.mechanisms.mechanism import PairContact
from bodycheck.reference.proof.balls import Ball, Triple, ball, dot
from bodycheck.reference.proof.contact.lying import Face, at_height
from bodycheck.reference.proof.contact.start import NONE, Placed, Surroundings
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.scene import Plane


@dataclass(frozen=True, eq=False)
class Block:
    """A body that stands, with its index and its face."""

    index: int
    body: Placed
    face: Face

    @property
    def bottom(self) -> Ball:
        """The height of its lower face above the plane (m)."""
        return self.body.position[2] - self.face.height

    @property
    def top(self) -> Ball:
        """The height of its upper face above the plane (m)."""
        return self.body.position[2] + self.face.height


def check(bodies: list[Placed], law: Callable[[int, int], PairContact | Plane], plane: Surroundings) -> None:
    """Raise `NotEnclosed` unless the bodies of a scene are proved to rest in a tower. law: of two bodies, given by indices."""
    blocks = sorted((_block(index, body) for index, body in enumerate(bodies)), key=lambda each: float(each.bottom.mid()))
    slope = plane.downhill / plane.onto if plane.onto > 0 else None
    if slope is None:
        raise NotEnclosed("bodies that nothing presses on a plane")
    below, under = -1, None
    for number, block in enumerate(blocks):
        gap = block.bottom if under is None else block.bottom - under.top
        if not abs(gap) <= NONE * block.face.smallest:
            raise NotEnclosed("several bodies on a plane that are not in one tower")
        friction = law(below, block.index).friction
        if not math.isinf(friction) and not ball(friction) >= slope:
            raise NotEnclosed("bodies of which it is not decided whether friction holds them")
        centre = _centre([each.body for each in blocks[number:]])
        for rim in (block, *(() if under is None else (under,))):
            x, y, _ = rim.body.position
            fall = (centre[2] - block.bottom) * slope
            if not rim.face.holds(centre[0] + fall - x, centre[1] - y):
                raise NotEnclosed("a tower that may tip over")
        below, under = block.index, block


def _block(index: int, body: Placed) -> Block:
    face = at_height(body)
    still = all(part.is_zero() for part in (*body.velocity, *body.spin))
    if face is None or not still:
        raise NotEnclosed("several bodies on a plane that are not in one tower at rest")
    return Block(index, body, face)


def _centre(bodies: list[Placed]) -> Triple:
    """The common centre of mass of some bodies (m)."""
    whole = ball(sum((body.mass for body in bodies), Fraction(0)))
    x, y, z = (dot([ball(body.mass) for body in bodies], [body.position[i] for body in bodies]) / whole for i in range(3))
    return x, y, z
