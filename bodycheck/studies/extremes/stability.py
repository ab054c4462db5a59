"""Search for the largest stable time step of a method, as the product of spin and time step: the angle per step.

A method is stable at a time step if it completes a hundred turns and its energy of rotation never reaches twice the initial
value. A loss of energy is an error, but not an instability. The search begins at one full turn per step and halves the step
until several steps in a row are stable, because single stable steps may lie between unstable steps. Then it narrows the bracket
between the largest of these stable steps and the next larger, unstable step.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.casefile.axes import spin
from bodycheck.casefile.content import Case
from bodycheck.reference.scene import Scene
from bodycheck.results.outcome import Completed, Outcome
from bodycheck.studies.extremes.symptoms import energy_change

#: Duration of a run in turns of the body, and its number of samples.
TURNS = 100
SAMPLES = 201

#: Angles per step (rad) that are tried, from a full turn to 1.5e-3. If none is stable, the method is called unstable.
PRODUCTS = tuple(2 * math.pi / 2**halvings for halvings in range(13))

#: Number of successive halvings that must be stable for all smaller steps to count as stable.
STABLE_IN_A_ROW = 3

#: Number of halvings that are tried at the same time.
PRODUCTS_PER_BATCH = 8

#: Number of sections with equal ratios into which a bracket is divided.
SECTIONS = 8

#: Ratio of the smallest unstable step to the largest stable step at which the search ends.
FINAL_RATIO = 1.02

#: Relative change of the energy from which a run is unstable.
ENERGY_GAIN_LIMIT = 1.0


@dataclass(frozen=True)
class Bracket:
    """The current bracket of a stability limit, in rad per step.

    Parameters
    ----------
    stable
        The largest stable product; None if none is stable.
    unstable
        The smallest unstable product above `stable`; None if all products are stable.
    following
        The products to try next; empty when the search has ended.
    """

    stable: float | None = None
    unstable: float | None = None
    following: tuple[float, ...] = ()


def bracket(probes: Mapping[float, bool]) -> Bracket:
    """Return the bracket that follows from probes. probes: whether a run was stable, by product of spin and time step (rad)."""
    for first in range(len(PRODUCTS) - STABLE_IN_A_ROW + 1):
        settled = PRODUCTS[first : first + STABLE_IN_A_ROW]
        if not all(product in probes for product in settled):
            begun = (
                next(index for index, product in enumerate(PRODUCTS) if product not in probes)
                // PRODUCTS_PER_BATCH
                * PRODUCTS_PER_BATCH
            )
            return Bracket(following=_untried(probes, PRODUCTS[begun : begun + PRODUCTS_PER_BATCH]))
        if all(probes[product] for product in settled):
            return _narrowed(probes, PRODUCTS[first], PRODUCTS[first - 1]) if first else Bracket(stable=PRODUCTS[0])
    return Bracket(unstable=PRODUCTS[-1])


def turning(case: Case, rate: float) -> Case:
    """Return the case with the spin `rate` (rad/s) and a duration of a hundred turns."""
    return replace(spin(case, rate), duration=TURNS * 2 * math.pi / rate, samples=SAMPLES)


def stable(scene: Scene, outcome: Outcome) -> bool:
    """Return whether a run completed and its energy never reached twice the initial value."""
    with np.errstate(over="ignore"):
        return isinstance(outcome, Completed) and bool((energy_change(scene, outcome.trajectory) < ENERGY_GAIN_LIMIT).all())


def _narrowed(probes: Mapping[float, bool], low: float, high: float) -> Bracket:
    """Return the bracket, narrowed by the probes, between a stable product (`low`) and an unstable product (`high`)."""
    while high > FINAL_RATIO * low:
        ratio = (high / low) ** (1 / SECTIONS)
        ends = [low * ratio**section for section in range(SECTIONS)] + [high]
        if untried := _untried(probes, ends[1:-1]):
            return Bracket(low, high, untried)
        first = next(index for index, product in enumerate(ends) if product == high or (index and not probes[product]))
        low, high = ends[first - 1], ends[first]
    return Bracket(low, high)


def _untried(probes: Mapping[float, bool], products: Sequence[float]) -> tuple[float, ...]:
    return tuple(product for product in products if product not in probes)
