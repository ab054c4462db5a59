"""Bounds of the truth's own errors, as columns in the units of the figures whose errors they limit.

These columns describe the truth and not the engine, and appear in no table of a report or baseline. A figure of a run that does
not exceed its bound has no meaning: the run may be as exact as the truth. This also holds for drifts, although a drift is a
distance from the run's own initial value: the bounds of energy and angular momentum include the rounding of states and of the
sums for energy and angular momentum.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from decimal import ROUND_CEILING, Context

import numpy as np

from bodycheck.figures import mechanisms
from bodycheck.figures.conservation import angular_momentum_size, energy_size
from bodycheck.figures.definition import Comparison, Figure, Scales
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.observables import Observables
from bodycheck.reference.trajectory import Array


def within_truth(figure: Figure, values: Mapping[str, float]) -> float | None:
    """Return the bound of the truth's own error in a figure of a run if the figure does not exceed it; otherwise None.

    The result is also None if the figure was not measured, or no bound is known. `values` contains the values of the run by the
    names of columns.
    """
    value, bound = values.get(figure.name), values.get(figure.bounded_by)
    return bound if value is not None and bound and value <= bound else None


def rounded_up(value: float, digits: int) -> float:
    """Return an upper bound rounded up to a number of significant digits; it may be too small by one part in a million."""
    return float(Context(prec=digits, rounding=ROUND_CEILING).create_decimal(f"{value:.7g}"))


def _where_known(compute: Callable[[Comparison], Array]) -> Callable[[Comparison], Array | None]:
    """Return a function that computes a bound, or None if the bound is unknown: earlier versions did not store all bounds.

    If only some of several scenes have a known bound, it is NaN for the others. It is also NaN at instants at which mechanics
    does not determine the motion of bodies in contact.
    """

    def known(compared: Comparison) -> Array | None:
        values = compute(compared)
        return None if np.isnan(values).all() else values

    return known


def _energy(compared: Comparison) -> Array:
    errors = compared.truth.bounds.energy_error
    return errors / energy_size(compared.expected, errors[..., 0])[..., None]


def _angular_momentum(compared: Comparison) -> Array:
    errors = compared.truth.bounds.angular_momentum_error
    if isinstance(compared.scene, Mechanism):
        return np.asarray(errors / mechanisms.angular_momentum_size(compared.scene, compared.truth, compared.expected))
    assert isinstance(compared.expected, Observables)
    return errors / angular_momentum_size(compared.scene, compared.expected, errors[..., 0])[..., None]


#: The bound of the attitude error. It is the oldest bound, so that its column precedes the columns of the cost.
ATTITUDE = Figure(
    name="truth_error",
    title="Truth error",
    meaning="bound of the truth's own attitude error; smaller attitude errors have no meaning",
    unit="rad",
    largest=True,
    compute=_where_known(lambda compared: compared.truth.bounds.error),
    scale=lambda scales: scales.angle,
    limited=False,
    presence="every run",
    of_truth=True,
)


def _bound(state: str, unit: str, compute: Callable[[Comparison], Array], scale: Callable[[Scales], float]) -> Figure:
    """Return the figure for the bound of the truth's own error in a quantity of the state. state: its name in words."""
    return Figure(
        name=f"truth_{state.replace(' ', '_')}_error",
        title=f"Truth {state} error",
        meaning=f"bound of the truth's own {state} error; smaller {state} errors have no meaning",
        unit=unit,
        largest=True,
        compute=_where_known(compute),
        scale=scale,
        limited=False,
        of_truth=True,
    )


def _relative_bound(quantity: str, compute: Callable[[Comparison], Array], scale: Callable[[Scales], float]) -> Figure:
    """Return the figure for the bound of the truth's own error in a conserved quantity, relative to the quantity's size.

    quantity: its name in words.
    """
    extent = f"bound of the truth's own {quantity} error, relative to the size of the {quantity}"
    meaning = f"{extent}; smaller drifts and errors of it have no meaning"
    return replace(_bound(quantity, "", compute, scale), meaning=meaning)


#: The bounds of the other figures, which are the last columns.
OTHERS = (
    _bound("position", "m", lambda compared: compared.truth.bounds.position_error, lambda scales: scales.length),
    _bound("velocity", "m/s", lambda compared: compared.truth.bounds.velocity_error, lambda scales: scales.speed),
    _bound(
        "angular velocity", "rad/s", lambda compared: compared.truth.bounds.angular_velocity_error, lambda scales: scales.rate
    ),
    _relative_bound("energy", _energy, lambda scales: scales.energy),
    _relative_bound("angular momentum", _angular_momentum, lambda scales: scales.angular_momentum),
)
