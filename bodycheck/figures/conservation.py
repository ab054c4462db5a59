"""Figures of the quantities that free flight conserves: total energy, rotational energy and angular momentum.

For a mechanism, only the total energy is here; its momenta are in `mechanisms`. In a scene that conserves energy and momentum,
a figure is a drift: the distance from the run's own initial value. If friction, damping or drag act, it is an error: the
distance from the truth's value at the same instant. Both are relative to a size that is never zero.
"""

from collections.abc import Callable

import numpy as np

from bodycheck.figures.definition import AnyObservables, Comparison, Figure
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.observables import Observables
from bodycheck.reference.scene import Scene
from bodycheck.reference.scenes import Scenes
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import distance

#: A kinetic energy below this fraction of the largest is due to rounding of velocities that are zero.
REST = 1e-28


def total_energy(compared: Comparison) -> Array:
    """Return the relative distance (..., n) of the total energy from its initial value or from the value of the truth."""
    size = energy_size(compared.expected, compared.truth.bounds.energy_error[..., 0])
    return _relative(compared, compared.seen.total_energy[..., None], compared.expected.total_energy[..., None], size)


def rotational_energy(compared: Comparison) -> Array:
    """Return the relative distance (..., n) of the rotational energy from its initial value or from the value of the truth."""
    seen, expected = _of_one_body(compared)
    size = rotational_energy_size(expected, compared.truth.bounds.angular_momentum_error[..., 0])
    return _relative(compared, seen.rotational_energy[..., None], expected.rotational_energy[..., None], size)


def angular_momentum(compared: Comparison) -> Array:
    """Return the relative distance (..., n) of the angular momentum (world frame) from its initial or from its true value."""
    seen, expected = _of_one_body(compared)
    assert not isinstance(compared.scene, Mechanism)
    size = angular_momentum_size(compared.scene, expected, compared.truth.bounds.angular_momentum_error[..., 0])
    return _relative(compared, seen.angular_momentum, expected.angular_momentum, size)


def energy_size(reference: AnyObservables, error: Array | float) -> Array:
    """Return the energy (J) by which total energies are divided, from the truth: a number, or (m,) for m scenes.

    It is the initial kinetic energy or, if that is zero up to rounding, the largest kinetic energy. Potential energy is left
    out, because it depends on the position of the origin.

    error: the bound of the error of the initial energy (J), up to which the kinetic energy counts as zero.
    """
    initial = reference.kinetic_energy[..., 0]
    moves = initial > REST * np.fmax.reduce(reference.kinetic_energy, axis=-1)
    return _first(np.where(moves, _above(initial, error), 0.0), lambda: _largest(reference))


def rotational_energy_size(reference: Observables, error: Array | float) -> Array:
    """Return the energy (J) by which rotational energies are divided, from the truth: a number, or (m,) for m scenes.

    It is the initial rotational energy or, if the initial angular momentum is zero, the largest kinetic energy.

    error: the bound of the error of the initial angular momentum (kg m^2/s), up to which it counts as zero.
    """
    rotates = _above(_momentum(reference), error) > 0
    return _first(np.where(rotates, reference.rotational_energy[..., 0], 0.0), lambda: _largest(reference))


def angular_momentum_size(scene: Scene | Scenes, reference: Observables, error: Array | float) -> Array:
    """Return the size (kg m^2/s) by which angular momenta are divided, from the truth: a number, or (m,) for m scenes.

    It is the initial angular momentum or, if that is zero, the angular momentum of a rotation with the largest kinetic energy
    about the axis of the largest moment of the body.

    error: the bound of the error of the initial angular momentum (kg m^2/s), up to which it counts as zero.
    """
    moments = np.array(scene.body.moments) if isinstance(scene, Scene) else scene.moments
    return _first(_above(_momentum(reference), error), lambda: np.sqrt(2 * _largest(reference) * moments.max(axis=-1)))


def _momentum(reference: Observables) -> Array:
    """Return the size of the initial angular momentum (kg m^2/s) of each scene."""
    return np.asarray(np.hypot.reduce(reference.angular_momentum[..., 0, :], axis=-1))


def _above(size: Array, error: Array | float) -> Array:
    """Return sizes, and zero for those that do not exceed the bound of their error, if that is known."""
    return np.where(size <= error, 0.0, size)


def _largest(reference: AnyObservables) -> Array:
    """Return the largest kinetic energy (J) of each scene, or 1 J if that is zero."""
    return _first(np.fmax.reduce(reference.kinetic_energy, axis=-1), lambda: np.array(1.0))


def _first(size: Array, other: Callable[[], Array]) -> Array:
    """Return sizes with zeros replaced by other sizes."""
    has_size = size != 0
    return size if has_size.all() else np.where(has_size, size, other())


def _of_one_body(compared: Comparison) -> tuple[Observables, Observables]:
    """Return the observables of the run and of the truth in a scene that is not a mechanism."""
    assert isinstance(compared.seen, Observables)
    assert isinstance(compared.expected, Observables)
    return compared.seen, compared.expected


def _relative(compared: Comparison, values: Array, expected: Array, size: Array) -> Array:
    return distance(values, values[..., :1, :] if compared.conserves else expected) / size[..., None]


Compute = Callable[[Comparison], Array | None]


def _where(conserves: bool, compute: Callable[[Comparison], Array]) -> Compute:
    """Return a function that computes a figure only in scenes that conserve energy and momentum, or only in others."""
    return lambda compared: compute(compared) if compared.conserves == conserves else None


def _alone(conserves: bool, compute: Callable[[Comparison], Array]) -> Compute:
    """Return the function of `_where`, restricted to single bodies."""
    where = _where(conserves, compute)
    return lambda compared: where(compared) if compared.mechanism is None else None


#: The previous definition of the figures of energy, before they became relative to the initial kinetic energy.
ENERGY_FORMERLY = "relative to the initial energy, with a potential energy that is zero at z = 0"

#: In scenes that conserve energy and angular momentum.
DRIFTS = (
    Figure(
        name="energy_drift",
        title="Energy drift",
        meaning="change of the energy, which should be constant, relative to the initial kinetic energy",
        largest=True,
        remark="without friction, damping and drag",
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
        remark="without friction and drag, of a single body",
        compute=_alone(True, rotational_energy),
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
        remark="without friction and drag, of a single body",
        compute=_alone(True, angular_momentum),
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
        remark="with friction, damping or drag",
        compute=_where(False, total_energy),
        jumps=True,
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
        remark="with friction or drag, of a single body",
        compute=_alone(False, rotational_energy),
        jumps=True,
        scale=lambda scales: scales.rotational_energy,
    ),
    Figure(
        name="angular_momentum_error",
        title="Angular momentum error",
        meaning="difference between the angular momentum vector and the exact one, relative to its size",
        largest=True,
        remark="with friction or drag, of a single body",
        compute=_alone(False, angular_momentum),
        jumps=True,
        scale=lambda scales: scales.angular_momentum,
        bounded_by="truth_angular_momentum_error",
        plotted=True,
    ),
)
