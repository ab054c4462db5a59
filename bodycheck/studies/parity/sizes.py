"""The differences of terms, relative to sizes of the terms. Differences by rounding are then 1e-12 or less.

Lengths are relative to the reach of the robot. The mass matrix is relative to the roots D_i of its diagonal,
|dM_ij| / (D_i D_j). Forces are divided by D_i, which makes them comparable between joints of all kinds, and are relative to the
largest force of their kind at any state and joint. A difference of accelerations is compared as the force that it requires,
because a nearly singular mass matrix turns rounding errors into large accelerations.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.quantities import FORCES, Quantity
from bodycheck.studies.parity.rotations import gaps
from bodycheck.studies.parity.stacks import Label, Stack, times

#: The size of forces of a kind is at least this part of the largest force that this kind could have, and of the largest force
#: of any kind.
LEAST_FORCE = 1e-3


@dataclass(frozen=True, eq=False)
class Sizes:
    """The sizes of terms at s states with n velocities.

    Attributes
    ----------
    labels
        The velocities.
    length
        The reach of the robot (m).
    roots
        The roots (s, n) of the diagonal of the mass matrix.
    forces
        The size of each force, divided by the roots.
    columns
        The sizes (2, n) of the linear and angular parts of the columns of Jacobians.
    """

    labels: tuple[Label, ...]
    length: float
    roots: Array
    forces: Mapping[Quantity, float]
    columns: Array

    def at(self, states: Sequence[int]) -> "Sizes":
        """Return the sizes at some of the states, by their indices. Sizes for all states together stay unchanged."""
        return replace(self, roots=self.roots[list(states)])


@dataclass(frozen=True)
class Apart:
    """The largest difference of a term: relative to the term's size, absolute, with the numbers of both sides and the state."""

    relative: float
    difference: float
    engine: str
    truth: str
    state: int


def sizes(truth: Stack, labels: tuple[Label, ...], velocities: Array, total_mass: float, gravity: float) -> Sizes:
    """Return the sizes of the terms of a truth.

    velocities: the velocities (s, n) at the states. total_mass: the mass of all bodies (kg). gravity: its magnitude (m/s^2).
    """
    places = [np.max(np.linalg.norm(term[:, :3], axis=1), initial=0.0) for term in truth.poses.values()]
    length = float(max(places, default=0.0)) or 1.0
    n = len(labels)
    jacobians = np.concatenate([np.zeros((1, 6, n)), *truth.jacobians.values()])
    columns = np.stack(
        [np.max(np.linalg.norm(part, axis=1), axis=0, initial=0.0) for part in (jacobians[:, :3], jacobians[:, 3:])]
    )
    columns = np.maximum(columns, [length * columns[1], columns[0] / length])
    roots = _roots(truth.mass_matrix, velocities.shape)
    if not n:
        return Sizes(labels, length, roots, dict.fromkeys(FORCES, 1.0), columns)
    could = {
        "gravity_force": gravity * np.sqrt(total_mass) if total_mass > 0 else 0.0,
        "coriolis_force": float(np.max(roots * velocities**2, initial=0.0)),
    }
    forces: dict[Quantity, float] = {}
    for name in FORCES:
        term = getattr(truth, name)
        largest = 0.0 if term is None else float(np.nanmax(np.abs(term) / roots, initial=0.0))
        forces[name] = max(largest, LEAST_FORCE * could.get(name, 0.0))
    # Accelerations and efforts follow from sums of the other forces, with rounding errors of the size of the largest force. An
    # engine may compute the other forces as differences of such sums.
    whole = max((value for value in forces.values() if np.isfinite(value)), default=0.0)
    forces |= {name: max(forces[name], LEAST_FORCE * whole) for name in FORCES}
    forces["inverse_dynamics"] = max(forces["inverse_dynamics"], forces["gravity_force"], forces["coriolis_force"])
    forces["forward_dynamics"] = whole
    return Sizes(labels, length, roots, forces, np.where(columns > 0, columns, 1.0))


def _roots(mass: Array | None, shape: tuple[int, ...]) -> Array:
    if mass is None:
        return np.ones(shape)
    diagonal = np.abs(np.diagonal(mass, axis1=1, axis2=2))
    least = 1e-12 * np.nanmax(diagonal, initial=0.0)
    return np.sqrt(np.where(diagonal > least, diagonal, least or 1.0))


def apart(quantity: Quantity, engine: Stack, truth: Stack, scale: Sizes) -> Apart | None:
    """Return the largest difference of an engine's term from the truth at any state; None if either side lacks the term."""
    match quantity:
        case "pose":
            return _poses(engine.poses, truth.poses, scale)
        case "jacobian":
            return _jacobians(engine.jacobians, truth.jacobians, scale)
        case "mass_matrix":
            return _mass(engine.mass_matrix, truth.mass_matrix, scale)
        case "forward_dynamics":
            return _forward(engine, truth, scale)
        case _:
            return _force(quantity, getattr(engine, quantity), getattr(truth, quantity), scale)


def _force(quantity: Quantity, engine: Array | None, truth: Array | None, scale: Sizes) -> Apart | None:
    if engine is None or truth is None or not engine.size:
        return None
    roots, size = scale.roots, scale.forces[quantity]
    if not size:  # the truth is zero: relative to the engine's largest force
        size = float(np.nanmax(np.abs(engine) / roots, initial=0.0)) or 1.0
    error = _finite((engine - truth) / roots / size)
    state, column = np.unravel_index(np.argmax(error), error.shape)
    return _told(error, engine, truth, (state, column), scale.labels[column][0])


def _forward(engine: Stack, truth: Stack, scale: Sizes) -> Apart | None:
    computed, expected, mass = engine.forward_dynamics, truth.forward_dynamics, truth.mass_matrix
    if computed is None or expected is None or mass is None or not computed.size:
        return None
    known = np.all(np.isfinite(expected), axis=1)
    if not known.any():
        return None
    computed, expected, mass, roots = computed[known], expected[known], mass[known], scale.roots[known]
    error = _finite(times(mass, computed - expected) / roots / (scale.forces["forward_dynamics"] or 1.0))
    state, column = np.unravel_index(np.argmax(error), error.shape)
    gap = _told(error, computed, expected, (state, column), scale.labels[column][0])
    return replace(gap, state=int(np.flatnonzero(known)[state]))


def _mass(engine: Array | None, truth: Array | None, scale: Sizes) -> Apart | None:
    if engine is None or truth is None or not engine.size:
        return None
    roots = scale.roots
    error = _finite((engine - truth) / roots[:, :, None] / roots[:, None, :])
    state, row, column = np.unravel_index(np.argmax(error), error.shape)
    joints = dict.fromkeys((scale.labels[row][0], scale.labels[column][0]))
    return _told(error, engine, truth, (state, row, column), " ".join(joints))


def _jacobians(engine: Mapping[str, Array], truth: Mapping[str, Array], scale: Sizes) -> Apart | None:
    worst: Apart | None = None
    for name in engine:
        if name in truth and engine[name].size:
            size = np.concatenate([np.tile(scale.columns[0], (3, 1)), np.tile(scale.columns[1], (3, 1))])
            error = _finite((engine[name] - truth[name]) / size)
            at = np.unravel_index(np.argmax(error), error.shape)
            if worst is None or error[at] > worst.relative:
                worst = _told(error, engine[name], truth[name], at, f"{name}, {scale.labels[at[2]][0]}")
    return worst


def _poses(engine: Mapping[str, Array], truth: Mapping[str, Array], scale: Sizes) -> Apart | None:
    worst: Apart | None = None
    for name in engine:
        if name not in truth:
            continue
        shift, turn = gaps(truth[name], engine[name])
        error = _finite(np.maximum(shift / scale.length, turn))
        state = int(np.argmax(error))
        if worst is None or error[state] > worst.relative:
            numbers = [" ".join(f"{number:.9g}" for number in side[name][state]) for side in (engine, truth)]
            largest = float(max(shift[state], turn[state]))
            worst = Apart(float(error[state]), largest, f"{numbers[0]} ({name})", f"{numbers[1]} ({name})", state)
    return worst


def _told(error: Array, engine: Array, truth: Array, at: tuple[Any, ...], where: str) -> Apart:
    one, other = float(engine[at]), float(truth[at])
    return Apart(float(error[at]), abs(one - other), f"{one!r} ({where})", f"{other!r} ({where})", int(at[0]))


def _finite(error: Array) -> Array:
    """Return absolute differences; infinite where they are NaN."""
    return np.where(np.isnan(error), np.inf, np.abs(error))
