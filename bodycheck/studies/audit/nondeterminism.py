"""The probe of nondeterminism: a flight is repeated immediately, after other flights, and in another process.

The states of all repetitions should be equal to the last bit.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Flight, NotFlown, Pilot, Result
from bodycheck.studies.audit.probe import Finding

#: The name of the probe, and the name of its flight in another process.
NAME, ELSEWHERE = "nondeterminism", "nondeterminism in another process"

#: Numbers of steps from each compared state to the next.
STRIDES = (1, 49, 50, 50, 50)

#: The scene. The body spins about its intermediate axis, so that even the smallest difference grows.
SCENE = Scene(
    Body(1.3, (0.9, 1.7, 1.2)),
    State((0.1, -0.2, 0.3), (1.0, 0.0, 0.0, 0.0), (1.1, -0.7, 2.3), (0.1, 0.2, 7.0)),
    gravity=9.81,
)

#: The scene of the flights in between. It has another body, so that other numbers remain in any state that an engine keeps.
OTHER = replace(SCENE, body=Body(0.4, (0.02, 0.03, 0.04)), initial=State(angular_velocity=(-3.0, 2.0, 5.0)), gravity=1.6)

#: The units of the columns of a state.
UNITS = (*("m",) * 3, *("",) * 4, *("m/s",) * 3, *("rad/s",) * 3)

#: The states (n, 13) of a flight, or the reason why it was not made.
States = list[list[float]] | str


def repeated(pilot: Pilot) -> dict[str, States]:
    """Make the same flight three times, and return the states of each, by words that say when it was made."""
    flight = Flight(SCENE, pilot.timestep, STRIDES)
    first, again = pilot.fly(flight), pilot.fly(flight)
    for other in (Flight(OTHER, pilot.timestep, (70,)), Flight(OTHER, pilot.timestep / 2, (30,))):
        pilot.fly(other)
    return {"first": _states(first), "at once": _states(again), "after other flights": _states(pilot.fly(flight))}


def elsewhere(pilot: Pilot) -> dict[str, States]:
    """Make the same flight once, and return its states as `repeated` does. This function is called in another process."""
    return {"in another process": _states(pilot.fly(Flight(SCENE, pilot.timestep, STRIDES)))}


def judged(flights: Mapping[str, States]) -> Finding:
    """Return the finding of nondeterminism: the largest difference of the repeated flights from the first flight.

    flights: the states of all flights in the form of `repeated`, the first flight first.
    """
    first, *others = flights.items()
    if any(isinstance(states, str) for states in flights.values()):
        words = "; ".join(f"{when}: {states}" for when, states in flights.items() if isinstance(states, str))
        return Finding("nondeterminism", f"{NAME}: a flight was refused {words}", "not-probed")
    differing = {when: _difference(first[1], states) for when, states in others}
    when, (size, unit) = max(differing.items(), key=lambda item: item[1][0])
    if not size:
        return Finding("nondeterminism", NAME, "none", 0.0, "", "0")
    words = f"{NAME}: the same flight, made again {when}"
    return Finding("nondeterminism", words, "found", size if math.isfinite(size) else None, unit, "0")


def _states(result: Result) -> States:
    if isinstance(result, NotFlown):
        return result.reason
    states: list[list[float]] = result.states.tolist()
    return states


def _difference(one: States, other: States) -> tuple[float, str]:
    """Return the largest difference between components of two motions, and its unit.

    The difference is infinite if only one of the two components is not a number.
    """
    first, second = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    same = (first == second) | (np.isnan(first) & np.isnan(second))
    with np.errstate(invalid="ignore"):
        apart: Array = np.where(same, 0.0, np.nan_to_num(np.abs(first - second), nan=np.inf))
    column = int(np.argmax(apart.max(axis=0)))
    return float(apart[:, column].max()), UNITS[column]
