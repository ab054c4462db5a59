"""Motions in balls: the states at a time, and motions that consist of pieces, such as flights between impacts."""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from bodycheck.reference.proof.balls import Ball, Matrix, Triple, ball
from bodycheck.reference.proof.enclosure import NotEnclosed

#: The method of proofs by closed forms.
CLOSED_FORM = "closed form in ball arithmetic"

#: The largest number of pieces of a motion.
MOST_PIECES = 100_000


@dataclass(frozen=True, eq=False)
class Shown:
    """The states of a motion at an instant in balls: the coordinates and velocities of joints, and the states of each body."""

    position: list[Ball]
    velocity: list[Ball]
    bodies: list[tuple[Triple, Matrix, Triple, Triple]]

    @property
    def radius(self) -> float:
        """The largest radius of a ball; infinite if one has no bound."""
        entries = [*self.position, *self.velocity]
        for position, attitude, velocity, rates in self.bodies:
            entries += [*position, *velocity, *rates, *(entry for line in attitude for entry in line)]
        return max(float(entry.rad()) for entry in entries) if all(entry.is_finite() for entry in entries) else math.inf


#: A function from a time (s) to the states at it.
States = Callable[[Fraction], Shown]


@dataclass(frozen=True, eq=False)
class Change:
    """An event: its kind, the index of the body, and its time (s)."""

    kind: str
    body: int
    time: Ball


@dataclass(frozen=True, eq=False)
class Motion:
    """The method of a proof, and the states as a function of time.

    Attributes
    ----------
    way, states
        The method and the states.
    until
        The time (s) until which it has them; None if it has all.
    changes
        A function from a time (s) to the events until then; None for a motion without events.
    """

    way: str
    states: States
    until: Fraction | None = None
    changes: Callable[[Fraction], list[Change]] | None = None


@dataclass(frozen=True, eq=False)
class Piece:
    """A piece of a motion.

    Attributes
    ----------
    begin, end
        Its times (s); no end if it lasts for ever.
    at
        A function from the time since its begin (s) to states, which are balls and tuples of balls.
    events
        The kinds of the events at its end, each with the index of its body.
    jumps
        Whether the states jump at its end. At the end itself, the states are those of this piece.
    ends_at
        A function that says whether it ends exactly at a time (s); None if nothing can say so.
    phase
        What the body does: "flies", "slips" or "rolls"; empty where nobody asks.
    """

    begin: Ball
    end: Ball | None
    at: Callable[[Ball], Any]
    events: tuple[tuple[str, int], ...] = ()
    jumps: bool = False
    ends_at: Callable[[Fraction], bool] | None = None
    phase: str = ""


@dataclass(frozen=True, eq=False)
class Course:
    """A motion that consists of pieces, which are computed as far as they are asked for. It may end with its last piece."""

    ahead: Iterator[Piece]
    known: list[Piece]

    def pieces_until(self, t: Ball) -> list[Piece]:
        """The pieces that begin until a time (s)."""
        while not self.known or (self.known[-1].end is not None and self.known[-1].end <= t):
            if len(self.known) > MOST_PIECES:
                raise NotEnclosed(f"a motion of more than {MOST_PIECES} pieces")
            piece = next(self.ahead, None)
            if piece is None:
                break
            self.known.append(piece)
        return self.known

    def at(self, t: Fraction) -> Any:
        """The states at a time (s)."""
        time = ball(t)
        pieces = self.pieces_until(time)
        near = bisect_right(pieces, float(t), key=lambda piece: float(piece.begin.mid()))
        number = min(near, len(pieces) - 1)  # one more than is needed, because of roundings
        while number and (time <= pieces[number].begin or _ends(pieces[number - 1], t)):
            number -= 1
        piece = pieces[number]
        if piece.end is not None and not (time <= piece.end or _ends(piece, t)):
            raise NotEnclosed("an instant at which a motion may change")
        shown = piece.at(time - piece.begin)
        while number and not time > pieces[number].begin:  # it may be within the piece before
            number -= 1
            if pieces[number].jumps:
                raise NotEnclosed("an instant at which there may be an impact")
            shown = union(shown, pieces[number].at(time - pieces[number].begin))
        return shown

    def changes(self, t: Fraction) -> list[Change]:
        """The events until a time (s)."""
        time = ball(t)
        ended = (piece for piece in self.pieces_until(time) if piece.end is not None and not piece.end > time)
        return [Change(kind, body, piece.end) for piece in ended for kind, body in piece.events]


def _ends(piece: Piece, t: Fraction) -> bool:
    """Return whether a piece is known to end exactly at a time."""
    return piece.ends_at is not None and piece.ends_at(t)


def course(pieces: Iterator[Piece]) -> Course:
    """Return the motion of some pieces, one after another."""
    return Course(pieces, [])


def union(one: Any, other: Any) -> Any:
    """Return balls that contain those of two nested tuples of the same shape."""
    if isinstance(one, arb):
        return one.union(other)
    return tuple(union(a, b) for a, b in zip(one, other, strict=True))
