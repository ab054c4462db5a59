"""The links of a tree by SciPy's DOP853 in double precision, where heyoka is not installed."""

from dataclasses import fields
from typing import Any

import numpy as np

from bodycheck.reference.integration import dop853
from bodycheck.reference.mechanisms.articulated import Constants
from bodycheck.reference.mechanisms.link_states import LinkStates, derivatives, form, split, start
from bodycheck.reference.mechanisms.rounding import FloatType, WideArray
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.trajectory import Array


def followed(tree: Tree, times: WideArray, kind: FloatType) -> list[LinkStates]:
    """The states of the links of a tree at times (n,) >= 0, s, in any order, to double precision. Raises `OutOfReach`."""
    doubles = form(tree, [_rounded(link.constants) for link in tree.links], [float(part) for part in tree.gravity])

    def rates(_: float, state: Array) -> Array:
        return np.array(derivatives(doubles, state.tolist(), np), dtype=float)

    begin = np.array([float(value) for value in start(tree)])
    instants, rows = np.unique(times, return_inverse=True)
    # States in SI units are of the order of one or larger; a smaller scale would make steps needlessly short.
    found = dop853.solve(rates, begin, instants, np.maximum(np.abs(begin), 1.0))
    return split(tree, found[rows].astype(kind.dtype), times, kind)


def _rounded(constants: Constants) -> Constants:
    """The numbers of a link in doubles; zeros are integers, by which the recursion knows them."""
    values: dict[str, Any] = {}
    for field in fields(Constants):
        value = getattr(constants, field.name)
        values[field.name] = [_double(each) for each in value] if isinstance(value, tuple) else _double(value)
    return Constants(**values)


def _double(value: Any) -> float | int:
    return float(value) if value else 0
