"""The state of a body."""

from dataclasses import dataclass
from decimal import Decimal

from tests.judge.numerals import Matrix, Vector


@dataclass(frozen=True)
class State:
    """The state of a body: position and velocity of the centre of mass, attitude, angular velocity along its axes."""

    position: Vector
    velocity: Vector
    turn: Matrix
    spin: Vector


@dataclass(frozen=True)
class Motion:
    """The motion of one body: states by the indices of the instants at which it is determined, and events as kind and time."""

    states: dict[int, State]
    events: list[tuple[str, Decimal]]
