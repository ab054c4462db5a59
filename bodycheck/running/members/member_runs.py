"""Run members of an ensemble in parts, and join the outcomes."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bodycheck.adapters import registry
from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array
from bodycheck.results.outcome import Outcome
from bodycheck.running.members import blocks
from bodycheck.running.members.blocks import Flown
from bodycheck.running.members.chunk_workers import Role


@dataclass(frozen=True, eq=False)
class Flight:
    """The runs that a worker process of an engine makes in one call.

    Attributes
    ----------
    engine, version, method
        The name and the version of the engine, and the method.
    members
        The m members: scenes in free flight, or cases.
    times
        The times (n,), in s, at which a run of a scene is sampled.
    names
        The m names of the cases.
    file
        The file for the states; None to return the states.
    """

    engine: str
    version: str
    method: Method
    members: Scenes | tuple[Case, ...]
    times: Array
    names: tuple[str, ...]
    file: Path | None = None

    def part(self, first: int, last: int) -> "Flight":
        """Return the flight of some of the members: from the index `first` up to `last`, which is excluded."""
        members = slice(first, last)
        return replace(
            self,
            members=self.members.part(members) if isinstance(self.members, Scenes) else self.members[members],
            names=self.names[members],
            file=None,
        )


@dataclass(frozen=True, eq=False)
class Stored:
    """The outcomes of members whose states are in a file, which is much faster than sending them between processes.

    Attributes
    ----------
    flown
        The outcomes of the members, without their states.
    file
        The file of the states.
    """

    flown: Flown
    file: Path

    @property
    def wall_time(self) -> float:
        """The wall time (s) of stepping, of all members together."""
        return self.flown.wall_time

    def read(self) -> Flown:
        """Return the outcomes with the states. Raises `OSError` and `ValueError` if the file cannot be read."""
        return replace(self.flown, states=np.load(self.file, allow_pickle=False))


def prepare(engine: str) -> None:
    """Import an engine. If that raises an exception, each call raises it again."""
    with contextlib.suppress(registry.EngineMissing):
        registry.load(engine)


def fly(flight: Flight) -> Flown | Stored:
    """Run members in this process. States that cannot be written into the file are returned. Raises `EngineMissing`."""
    flown = blocks.fly(flight.engine, flight.method, flight.members, flight.times, flight.names)
    if flight.file is None or not flown.states.size:
        return flown
    try:
        np.save(flight.file, flown.states)
    except OSError:  # for example, the disk is full
        return flown
    return Stored(replace(flown, states=np.empty((0, 0, 13))), flight.file)


def joined(flight: Flight, parts: Sequence[tuple[range, Flown | Stored | Crashed | TimedOut]]) -> Flown | Stored:
    """Return the outcomes of all members of a flight, joined from the outcomes of its parts in their order.

    A part that failed completely has one member.
    """
    if len(parts) == 1 and isinstance(parts[0][1], Flown | Stored):
        return parts[0][1]
    samples = len(flight.times) if isinstance(flight.members, Scenes) else 0
    states = np.full((len(flight.names), samples, 13), np.nan)
    norm_error, ended, wall_time = np.zeros(len(flight.names)), dict[int, Outcome](), 0.0
    steps = np.zeros(len(flight.names), dtype=np.int64)
    for places, result in parts:
        if isinstance(result, Crashed | TimedOut):
            ended |= dict.fromkeys(places, result)
            continue
        assert isinstance(result, Flown)  # the result of a part is never in a file
        rows = slice(places.start, places.stop)
        states[rows], norm_error[rows], steps[rows] = result.states, result.norm_error, result.steps
        ended |= {places[index]: outcome for index, outcome in result.ended.items()}
        wall_time += result.wall_time
    return Flown(
        engine=flight.engine,
        version=flight.version,
        names=flight.names,
        method=flight.method,
        times=flight.times if samples else np.empty(0),
        steps=steps,
        states=states,
        norm_error=norm_error,
        wall_time=wall_time,
        ended=ended,
    )


#: The role of worker processes of engines.
FLYING = Role(fly, prepare)
