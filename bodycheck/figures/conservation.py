"""Figures of what free flight conserves: total energy, rotational energy and angular momentum.

In a scene that conserves them a figure is a drift, the distance from the run's own initial value. Where friction or drag act it
is an error, the distance from the truth's value at the same instant. Both are relative to a size that is never zero.
"""

from collections.abc import Callable

import numpy as np

from bodycheck.figures.definition import Comparison, Figure
from bodycheck.reference.observables import Observables
from bodycheck.reference.scene import Scene
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import distance


def total_energy(compared: Comparison) -> Array:
    """Return how far (..., n) the total energy is from its initial value or from that of the truth, relative."""
    size = energy_size(compared.expected)
    return _relative(compared, compared.seen.total_energy[..., None], compared.expected.total_energy[..., None], size)


def rotational_energy(compared: Comparison) -> Array:
    """Return how far (..., n) the rotational energy is from its initial value or from that of the truth, relative."""
    seen, expected = compared.seen.rotational_energy[..., None], compared.expected.rotational_energy[..., None]
    return _relative(compared, seen, expected, rotational_energy_size(compared.expected))


def angular_momentum(compared: Comparison) -> Array:
    """Return how far (..., n) the angular momentum (world) is from its initial value or from that of the truth, relative."""
    size = angular_momentum_size(compared.scene, compared.expected)
    return _relative(compared, compared.seen.angular_momentum, compared.expected.angular_momentum, size)


def energy_size(reference: Observables) -> Array:
    """Return the size (J) that a total energy is relative to, from the truth's values: one number, or (m,) of m scenes.

    It is the initial kinetic energy or, where that is zero, the largest kinetic energy. A potential energy would make it depend
    on where the origin is.
    """
    return _first(reference.kinetic_energy[..., 0], lambda: _largest(reference))


def rotational_energy_size(reference: Observables) -> Array:
    """Return the size (J) that a rotational energy is relative to, from the truth's values: one number, or (m,) of m scenes.

    It is the initial rotational energy or, where that is zero, the largest kinetic energy.
    """
    return _first(np.abs(reference.rotational_energy[..., 0]), lambda: _largest(reference))


def angular_momentum_size(scene: Scene | Scenes, reference: Observables) -> Array:
    """Return the size (kg m^2/s) that an angular momentum is relative to, from the truth's values: one number, or (m,).

    It is the initial angular momentum or, where that is zero, the one that the largest kinetic energy would give to the largest
    moment of the body.
    """
    moments = np.array(scene.body.moments) if isinstance(scene, Scene) else scene.moments
    momentum = np.hypot.reduce(reference.angular_momentum[..., 0, :], axis=-1)
    return _first(momentum, lambda: np.sqrt(2 * _largest(reference) * moments.max(axis=-1)))


def _largest(reference: Observables) -> Array:
    """Return the largest kinetic energy of each scene, or 1 J where that is zero."""
    return _first(reference.kinetic_energy.max(axis=-1), lambda: np.array(1.0))


def _first(size: Array, other: Callable[[], Array]) -> Array:
    """Return sizes, and other ones where they are zero."""
    there = size != 0
    return size if there.all() else np.where(there, size, other())


def _relative(compared: Comparison, values: Array, expected: Array, size: Array) -> Array:
    return distance(values, values[..., :1, :] if compared.conserves else expected) / size[..., None]


Compute = Callable[[Comparison], Array | None]


def _where(conserves: bool, compute: Callable[[Comparison], Array]) -> Compute:
    """Return a function that computes a figure in scenes that conserve energy and angular momentum, or in the others."""
    return lambda compared: compute(compared) if compared.conserves == conserves else None


#: What the figures of energy were before they were relative to the initial kinetic energy.
ENERGY_FORMERLY = "relative to the initial energy, with a potential energy that is zero at z = 0"

#: In scenes that conserve energy and angular momentum.
DRIFTS = (
    Figure(
        name="energy_drift",
        title="Energy drift",
        meaning="change of the energy, which should be constant, relative to the initial kinetic energy",
        largest=True,
        remark="without friction and drag",
        compute=_where(True, total_energy),
        scale=lambda scales: scales.energy,
        presence="every table",
        bounded_by="truth_energy_error",
        revision=2,
        formerly=ENERGY_FORMERLY,
        plotted=True,
    ),
    Figure(
        name="rotational_energy_drift",
        title="Rotational energy drift",
        meaning="change of the rotational energy, which should be constant, relative to its size",
        largest=True,
        remark="without friction and drag",
        compute=_where(True, rotational_energy),
        scale=lambda scales: scales.rotational_energy,
        presence="every table",
    ),
    Figure(
        name="angular_momentum_drift",
        title="Angular momentum drift",
        meaning=(
            "change of the angular momentum vector about the centre of mass, which should be constant, relative to its size"
        ),
        largest=True,
        remark="without friction and drag",
        compute=_where(True, angular_momentum),
        scale=lambda scales: scales.angular_momentum,
        presence="every table",
        bounded_by="truth_angular_momentum_error",
        plotted=True,
    ),
)

#: In scenes with friction or drag.
ERRORS = (
    Figure(
        name="energy_error",
        title="Energy error",
        meaning="difference between the energy and the exact energy, relative to the initial kinetic energy",
        largest=True,
        remark="with friction or drag",
        compute=_where(False, total_energy),
        scale=lambda scales: scales.energy,
        bounded_by="truth_energy_error",
        revision=2,
        formerly=ENERGY_FORMERLY,
        plotted=True,
    ),
    Figure(
        name="rotational_energy_error",
        title="Rotational energy error",
        meaning="difference between the rotational energy and the exact one, relative to its size",
        largest=True,
        remark="with friction or drag",
        compute=_where(False, rotational_energy),
        scale=lambda scales: scales.rotational_energy,
    ),
    Figure(
        name="angular_momentum_error",
        title="Angular momentum error",
        meaning="difference between the angular momentum vector and the exact one, relative to its size",
        largest=True,
        remark="with friction or drag",
        compute=_where(False, angular_momentum),
        scale=lambda scales: scales.angular_momentum,
        bounded_by="truth_angular_momentum_error",
        plotted=True,
    ),
)
