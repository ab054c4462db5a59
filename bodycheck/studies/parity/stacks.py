"""Terms at several states as arrays with a leading axis, in double precision."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from bodycheck.reference.robots.state import RobotState, Values
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.trajectory import Array

#: A velocity: the name of its joint, and the index of the velocity among the components of the joint.
Label = tuple[str, int]


@dataclass(frozen=True, eq=False)
class Stack:
    """Terms at s states with n velocities; unknown terms are None or missing. See `Terms`.

    poses are (s, 7), jacobians (s, 6, n), the mass matrix (s, n, n) and the others (s, n).
    """

    poses: Mapping[str, Array] = field(default_factory=dict)
    jacobians: Mapping[str, Array] = field(default_factory=dict)
    mass_matrix: Array | None = None
    gravity_force: Array | None = None
    coriolis_force: Array | None = None
    passive_force: Array | None = None
    forward_dynamics: Array | None = None
    inverse_dynamics: Array | None = None

    def at(self, states: Sequence[int]) -> "Stack":
        """Return the terms at some of the states, by their indices."""
        indices = list(states)
        poses, jacobians = ({name: array[indices] for name, array in part.items()} for part in (self.poses, self.jacobians))
        return Stack(poses, jacobians, *(_at(getattr(self, one.name), indices) for one in fields(self)[2:]))


def stacked(terms: Sequence[Terms]) -> Stack:
    """Return terms at states as one stack. Missing terms are NaN; terms missing at all states are None."""
    if not terms:
        return Stack()
    vectors = {one.name: _vectors([getattr(state_terms, one.name) for state_terms in terms]) for one in fields(Stack)[2:]}
    return Stack(
        {
            name: np.array([state_terms.poses[name] for state_terms in terms], np.float64)
            for name in _common(state_terms.poses for state_terms in terms)
        },
        {
            name: np.array([state_terms.jacobians[name] for state_terms in terms], np.float64)
            for name in _common(state_terms.jacobians for state_terms in terms)
        },
        **vectors,
    )


def values(states: Sequence[RobotState], labels: Sequence[Label], part: Callable[[RobotState], Values]) -> Array:
    """Return a part of states, such as the velocities, as numbers (s, n) in the order of labels; 0 where a state has none."""
    rows = [[_value(part(state), label) for label in labels] for state in states]
    return np.array(rows, np.float64).reshape(len(states), len(labels))


def times(matrices: Array, vectors: Array) -> Array:
    """Return the products (s, k) of matrices (s, k, n) and vectors (s, n)."""
    return np.asarray((matrices @ vectors[..., None])[..., 0])


def transposed(matrices: Array) -> Array:
    """Return the transposes (..., n, k) of matrices (..., k, n)."""
    return np.swapaxes(matrices, -1, -2)


def _value(known: Values, label: Label) -> float:
    name, component = label
    return known[name][component] if name in known else 0.0


def _at(array: Array | None, states: list[int]) -> Array | None:
    return None if array is None else array[states]


def _common(mappings: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return the names that all mappings have, in the order of the first."""
    first, *others = mappings
    return [name for name in first if all(name in other for other in others)]


def _vectors(parts: Sequence[Any]) -> Array | None:
    shape = next((np.shape(part) for part in parts if part is not None), None)
    if shape is None:
        return None
    missing = np.full(shape, np.nan)
    return np.array([missing if part is None else np.asarray(part, np.float64) for part in parts])
