"""Fly members of an ensemble in parts, and join what became of them."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Strides
from bodycheck.adapters.method import Method
from bodycheck.casefile.case import Case
from bodycheck.reference.scenes import Scenes
from bodycheck.running import members
from bodycheck.running.crews import Role
from bodycheck.running.members import Flown
from bodycheck.running.outcome import Crashed, Outcome, TimedOut


@dataclass(frozen=True, eq=False)
class Flight:
    """What a worker process of an engine is asked to fly.

    Attributes
    ----------
    engine, version, method
        The name and the version of the engine, and the method.
    members
        The m members: scenes in free flight, or cases.
    steps
        The numbers of steps (n,) from the start to each state of a scene.
    names
        The m names of the cases.
    """

    engine: str
    version: str
    method: Method
    members: Scenes | tuple[Case, ...]
    steps: Strides
    names: tuple[str, ...]

    def part(self, first: int, last: int) -> "Flight":
        """Return the flight of some of the members, from one place up to another one, without it."""
        own = slice(first, last)
        return replace(
            self,
            members=self.members.part(own) if isinstance(self.members, Scenes) else self.members[own],
            names=self.names[own],
        )


def prepare(engine: str) -> None:
    """Import an engine. If that raises an exception, each call raises it again."""
    with contextlib.suppress(registry.EngineMissing):
        registry.load(engine)


def fly(flight: Flight) -> Flown:
    """Fly members in this process. Raises `EngineMissing`."""
    return members.fly(flight.engine, flight.method, flight.members, flight.steps, flight.names)


def joined(flight: Flight, parts: Sequence[tuple[range, Flown | Crashed | TimedOut]]) -> Flown:
    """Return what became of all members of a flight, from what became of its parts, in their order.

    A part that failed as a whole has one member.
    """
    if len(parts) == 1 and isinstance(parts[0][1], Flown):
        return parts[0][1]
    samples = len(flight.steps) if isinstance(flight.members, Scenes) else 0
    states = np.full((len(flight.names), samples, 13), np.nan)
    norm_error, ended, wall_time = np.zeros(len(flight.names)), dict[int, Outcome](), 0.0
    for places, found in parts:
        if not isinstance(found, Flown):
            ended |= dict.fromkeys(places, found)
            continue
        own = slice(places.start, places.stop)
        states[own], norm_error[own] = found.states, found.norm_error
        ended |= {places[place]: outcome for place, outcome in found.ended.items()}
        wall_time += found.wall_time
    return Flown(
        engine=flight.engine,
        version=flight.version,
        names=flight.names,
        method=flight.method,
        steps=flight.steps if samples else np.empty(0, dtype=np.int64),
        states=states,
        norm_error=norm_error,
        wall_time=wall_time,
        ended=ended,
    )


#: What worker processes of engines do.
FLYING = Role(fly, prepare)
