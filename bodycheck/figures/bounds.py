"""Bounds of the truth's own errors, as columns in the units of the figures that they bound.

They are no figures of the engine, and no table of a report or baseline has them. A figure of a run that is no larger than its
bound has no meaning: the run may be as exact as the truth. This holds for drifts too, although these are distances from the
run's own initial value, since the bounds of energy and angular momentum include the rounding of states and of the sums that
energy and angular momentum are computed by.
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
    """Return the truth's own error in a figure of a run that is no larger than it; None for a figure that is larger.

    It is also None where the figure was not measured, and where no bound is known. `values` are those of the run by column.
    """
    value, bound = values.get(figure.name), values.get(figure.bounded_by)
    return bound if value is not None and bound and value <= bound else None


def rounded_up(value: float, digits: int) -> float:
    """Return an upper bound with so many significant digits, which is a bound too (except for one part in a million)."""
    return float(Context(prec=digits, rounding=ROUND_CEILING).create_decimal(f"{value:.7g}"))


def _where_known(compute: Callable[[Comparison], Array]) -> Callable[[Comparison], Array | None]:
    """Return a function that computes a bound, or None where it is not known: earlier versions did not store all of them.

    It is NaN in those of several scenes of which it is not known, and where mechanics gives no motion of bodies that touch.
    """

    def known(compared: Comparison) -> Array | None:
        values = compute(compared)
        return None if np.isnan(values).all() else values

    return known


def _energy(compared: Comparison) -> Array:
    return compared.truth.bounds.energy_error / energy_size(compared.expected)[..., None]


def _angular_momentum(compared: Comparison) -> Array:
    if isinstance(compared.scene, Mechanism):
        size = mechanisms.angular_momentum_size(compared.scene, compared.truth.trajectory, compared.expected)
        return compared.truth.bounds.angular_momentum_error / size
    assert isinstance(compared.expected, Observables)
    return compared.truth.bounds.angular_momentum_error / angular_momentum_size(compared.scene, compared.expected)[..., None]


#: The bound of the attitude error, the first that was known: its column stands before those of the cost.
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
    """Return the bound of the truth's own error in a state, which is named in words."""
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
    """Return the bound of the truth's own error in a conserved quantity, which is named in words, relative to its size."""
    extent = f"bound of the truth's own {quantity} error, relative to the size of the {quantity}"
    meaning = f"{extent}; smaller drifts and errors of it have no meaning"
    return replace(_bound(quantity, "", compute, scale), meaning=meaning)


#: The bounds of the other figures, the last columns.
OTHERS = (
    _bound("position", "m", lambda compared: compared.truth.bounds.position_error, lambda scales: scales.length),
    _bound("velocity", "m/s", lambda compared: compared.truth.bounds.velocity_error, lambda scales: scales.speed),
    _bound(
        "angular velocity", "rad/s", lambda compared: compared.truth.bounds.angular_velocity_error, lambda scales: scales.rate
    ),
    _relative_bound("energy", _energy, lambda scales: scales.energy),
    _relative_bound("angular momentum", _angular_momentum, lambda scales: scales.angular_momentum),
)
