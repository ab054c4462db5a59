"""The largest stable step of a method, in the dimensionless product of spin and step: the angle turned in a step.

A method is called stable at a step if after a hundred turns it still runs and its energy of rotation has never been twice the
initial one. Losing energy is wrong, but bounded. The search goes down from a whole turn in a step by halves until several in
turn are stable, for a stable step may lie among unstable ones, and then narrows the ratio.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.casefile.axes import spin
from bodycheck.casefile.case import Case
from bodycheck.reference.scene import Scene
from bodycheck.running.outcome import Completed, Outcome
from bodycheck.studies.extremes.symptoms import energy_change

TURNS = 100
SAMPLES = 201

#: rad in a step: from a whole turn to 1.5e-3. Where none is stable, the method is called unstable.
PRODUCTS = tuple(2 * math.pi / 2**halvings for halvings in range(13))

#: Halvings that must all be stable before a smaller step is no longer doubted.
IN_TURN = 3

#: Halvings that are tried together.
AT_ONCE = 8

#: Equal ratios into which a bracket is divided at a time.
SECTIONS = 8

#: Ratio of the smallest unstable to the largest stable step at which the search ends.
FINE = 1.02

#: Relative change of an energy.
DOUBLED = 1.0


@dataclass(frozen=True)
class Bracket:
    """What is known of a limit, in rad a step, and which products are to be tried next; none when the search is over.

    stable: the largest, None where none is. unstable: the smallest, None where all are stable.
    """

    stable: float | None = None
    unstable: float | None = None
    following: tuple[float, ...] = ()


def bracket(probes: Mapping[float, bool]) -> Bracket:
    """What probes say so far: products of spin and step (rad), and whether a run was stable."""
    for first in range(len(PRODUCTS) - IN_TURN + 1):
        settled = PRODUCTS[first : first + IN_TURN]
        if not all(product in probes for product in settled):
            begun = next(place for place, product in enumerate(PRODUCTS) if product not in probes) // AT_ONCE * AT_ONCE
            return Bracket(following=_untried(probes, PRODUCTS[begun : begun + AT_ONCE]))
        if all(probes[product] for product in settled):
            return _narrowed(probes, PRODUCTS[first], PRODUCTS[first - 1]) if first else Bracket(stable=PRODUCTS[0])
    return Bracket(unstable=PRODUCTS[-1])


def turning(case: Case, rate: float) -> Case:
    """A case at some spin (rad/s), looked at for a hundred turns."""
    return replace(spin(case, rate), duration=TURNS * 2 * math.pi / rate, samples=SAMPLES)


def stable(scene: Scene, outcome: Outcome) -> bool:
    """Whether a run goes on to its end and has never had twice its energy."""
    with np.errstate(over="ignore"):
        return isinstance(outcome, Completed) and bool((energy_change(scene, outcome.trajectory) < DOUBLED).all())


def _narrowed(probes: Mapping[float, bool], low: float, high: float) -> Bracket:
    """The bracket that probes between a stable and an unstable product leave: below its upper end all are stable."""
    while high > FINE * low:
        ratio = (high / low) ** (1 / SECTIONS)
        ends = [low * ratio**section for section in range(SECTIONS)] + [high]
        if untried := _untried(probes, ends[1:-1]):
            return Bracket(low, high, untried)
        first = next(place for place, product in enumerate(ends) if product == high or (place and not probes[product]))
        low, high = ends[first - 1], ends[first]
    return Bracket(low, high)


def _untried(probes: Mapping[float, bool], products: Sequence[float]) -> tuple[float, ...]:
    return tuple(product for product in products if product not in probes)
