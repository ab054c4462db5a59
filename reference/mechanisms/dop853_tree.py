"""The links of a tree by SciPy's DOP853 in double precision, where heyoka is not installed."""

import math

import numpy as np

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration import dop853
from bodycheck.reference.mechanisms.link_states import Course, derivatives, in_doubles, split, start
from bodycheck.reference.mechanisms.rounding import FloatType, WideArray
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.trajectory import Array


def followed(tree: Tree, times: WideArray, kind: FloatType) -> Course:
    """The links of a tree at times (n,) >= 0, s, in any order, to double precision.

    Raises
    ------
    OutOfReach
        If the integration fails or takes too many steps, or a joint has dry friction.
    """
    if any(link.friction for link in tree.links):
        raise OutOfReach("joints with dry friction are followed by heyoka, which is not installed")
    doubles = in_doubles(tree)

    def rates(_: float, state: Array) -> Array:
        return np.array(derivatives(doubles, state.tolist(), math).state, dtype=float)

    begin = np.array([float(value) for value in start(tree)])
    instants, rows = np.unique(times, return_inverse=True)
    # States in SI units are of the order of one or larger; a smaller scale would make steps needlessly short.
    found = dop853.solve(rates, begin, instants, np.maximum(np.abs(begin), 1.0))
    return Course(split(tree, found[rows].astype(kind.dtype), times, kind), ())
