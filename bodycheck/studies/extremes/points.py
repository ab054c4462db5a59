"""The points at which a case is tried: its axes, each with its values."""

from collections.abc import Iterator
from dataclasses import dataclass

from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.axes import AXES
from bodycheck.casefile.content import Case


@dataclass(frozen=True)
class Point:
    """A case with one of its axes at a value, and the time step (s) with which it is run."""

    case: Case
    axis: str
    value: float
    timestep: float


def points(case: Case) -> Iterator[Point]:
    """Every value of every axis of a case, one axis at a time from the case as it stands.

    Spins and time steps, where a case has both, are taken together: every spin with every step.
    """
    values = dict(case.extremes)
    timesteps = values.pop("timestep", ())
    for name, tried in values.items():
        for value in tried:
            for timestep in (name == "spin" and timesteps) or (DEFAULT_TIMESTEP,):
                yield Point(AXES[name].varied(case, value), name, value, timestep)
    if "spin" not in values:
        yield from (Point(case, "timestep", timestep, timestep) for timestep in timesteps)
