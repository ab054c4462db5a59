"""The motion of a coin until it no longer rolls: it slips, leaves the plane, or touches the plane with more than a point."""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bodycheck.reference.contact.coin import angles
from bodycheck.reference.contact.coin.start import Coin
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.integration.collocation import Step, steps
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The number of nodes of a step.
STAGES = 24

#: The largest number of evaluations of the equations, each for all nodes of a step: some ten seconds.
MOST = 40_000

#: The length of the first step, in units of the coin's time.
FIRST = 0.5

#: The number of instants of a step at which the end is searched, and how often the interval around the end is searched again.
_PLACES, _SEARCHES = 33, 13

#: How often the interval around the largest friction is searched again: few are enough, as its derivative is zero there.
_REFINEMENTS = 4

#: The rate at an end is measured over the time since the start of the step divided by the former number, and at least over the
#: latter time.
_EARLIER, _INSTANT = 16, 1e-12

#: A function of states (n, 8) whose values (n,) are positive while the coin rolls.
_Slack = Callable[[WideArray], WideArray]


@dataclass(frozen=True, eq=False)
class End:
    """The end of a coin's rolling.

    Attributes
    ----------
    kind
        "slip" if the coin slips or leaves the plane, "impact" if its face or its side touches the plane.
    time
        The instant, in units of the coin.
    state
        (8,) the state at this instant.
    rate
        The rate at which the slack (see `slacks`) decreases there.
    before, state_before
        An instant a little before, at which other equations are not yet singular, and the state (8,) at that instant.
    """

    kind: Literal["slip", "impact"]
    time: np.longdouble
    state: WideArray
    rate: float
    before: np.longdouble
    state_before: WideArray


@dataclass(frozen=True, eq=False)
class Followed:
    """States (n, 8) of a coin, the end of its rolling if it is within the instants, and the largest friction needed until then.

    After the end, the states are NaN.
    """

    states: WideArray
    end: End | None
    friction: float


def slacks(coin: Coin, friction: float) -> tuple[tuple[Literal["slip", "impact"], _Slack], ...]:
    """Return functions that are positive while a coin rolls, each after the event that happens when it becomes zero."""

    def held(states: WideArray) -> WideArray:
        tangential, normal = angles.forces(coin, states)
        return normal if math.isinf(friction) else Wide(friction) * normal - tangential

    upright = np.arctan2(Wide(1), Wide(0))
    return (
        ("slip", held),
        ("impact", lambda states: np.asarray(states[:, angles.THETA])),
        ("impact", lambda states: np.asarray(upright - states[:, angles.THETA])),
    )


def ratio(coin: Coin, states: WideArray) -> WideArray:
    """The friction (n,) that a coin needs in states (n, 8): tangential over normal force; 0 if the latter is not positive."""
    tangential, normal = angles.forces(coin, states)
    return np.asarray(tangential / np.where(normal > 0, normal, np.inf))


def followed(coin: Coin, friction: float, times: Array) -> Followed:
    """The motion at ascending times (n,) >= 0, in units of the coin. Raises `OutOfReach` if it needs too many steps."""
    start = angles.initial(coin)
    states = np.full((len(times), len(start)), np.nan, dtype=Wide)
    row = int(np.searchsorted(times, 0.0, side="right"))
    states[:row] = start
    needed = float(ratio(coin, start[None])[0])
    if row == len(times):
        return Followed(states, None, needed)
    conditions = slacks(coin, friction)
    last = Wide(times[-1])
    solved = steps(angles.equations(coin), start, stages=STAGES, first=FIRST, most=MOST, memory=1)
    try:
        for step in solved:
            until = min(step.end, last)
            places = np.linspace(step.start, until, _PLACES, dtype=Wide)
            end = _end(step, places, conditions)
            until = until if end is None else end.time
            inside = int(np.searchsorted(times, until, side="right"))
            states[row:inside] = step.at(times[row:inside].astype(Wide))
            row = inside
            needed = max(needed, _largest(coin, step, places[places <= until]))
            if end is not None or step.end >= last:
                return Followed(states, end, needed)
    except OutOfReach as error:
        raise OutOfReach(f"a coin that wobbles so much or comes so close to lying flat: {error}") from error
    raise AssertionError  # unreachable: `steps` is endless


def _end(step: Step, places: WideArray, conditions: tuple[tuple[Literal["slip", "impact"], _Slack], ...]) -> End | None:
    """The first end within a step, or None. places: ascending instants from the first to the last of the step."""
    ends = []
    states = step.at(places)
    for kind, slack in conditions:
        if (bracket := _bracket(step, slack, places, slack(states))) is None:
            continue
        begin, until = bracket
        for _ in range(_SEARCHES):
            grid = np.linspace(begin, until, _PLACES, dtype=Wide)
            below = int(np.argmax(slack(step.at(grid)) <= 0)) or _PLACES - 1
            begin, until = grid[below - 1], grid[below]
        # The instant is rounded to a double, so that both solutions are evaluated at the same instant.
        early = Wide(float(until - (until - step.start) / _EARLIER))
        early_state, state = step.at(np.array([early, until]))
        rate = float((slack(early_state[None]) - slack(state[None]))[0] / max(until - early, Wide(_INSTANT)))
        ends.append(End(kind, until, state, rate, early, early_state))
    return min(ends, key=lambda end: float(end.time), default=None)


def _bracket(step: Step, slack: _Slack, places: WideArray, values: WideArray) -> tuple[np.longdouble, np.longdouble] | None:
    """Two instants between which a slack first falls to zero, or None.

    places: (n,) instants. values: (n,) of the slack there. If all are positive, the minimum between instants is searched too.
    """
    for first in np.flatnonzero(values <= 0)[:1]:
        return (places[max(first - 1, 0)], places[first])
    lowest = int(np.argmin(values))
    if not 0 < lowest < len(places) - 1 or values[lowest] > np.abs(np.diff(values[lowest - 1 : lowest + 2])).max():
        return None
    begin, until = places[lowest - 1], places[lowest + 1]
    for _ in range(_SEARCHES):
        grid = np.linspace(begin, until, _PLACES, dtype=Wide)
        slacks = slack(step.at(grid))
        if (slacks <= 0).any():
            return begin, grid[int(np.argmax(slacks <= 0))]
        lowest = int(np.clip(np.argmin(slacks), 1, _PLACES - 2))
        begin, until = grid[lowest - 1], grid[lowest + 1]
    return None


def _largest(coin: Coin, step: Step, places: WideArray) -> float:
    """The largest friction that the coin needs at instants of a step and between them."""
    ratios = ratio(coin, step.at(places))
    most = float(ratios.max())
    highest = int(np.argmax(ratios))
    for _ in itertools.repeat(None, _REFINEMENTS if 0 < highest < len(places) - 1 else 0):
        places = np.linspace(places[highest - 1], places[highest + 1], _PLACES, dtype=Wide)
        ratios = ratio(coin, step.at(places))
        most, highest = max(most, float(ratios.max())), int(np.clip(np.argmax(ratios), 1, _PLACES - 2))
    return most
