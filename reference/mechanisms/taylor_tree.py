"""The links of a tree by Taylor's method in any floating-point type (heyoka; Linux only).

Importing this raises `ImportError` where heyoka is not installed.
"""

import functools

from bodycheck.reference.integration.heyoka_solver import Equations, integrator, solve
from bodycheck.reference.mechanisms import stick_slip
from bodycheck.reference.mechanisms.link_states import Course, split, start
from bodycheck.reference.mechanisms.rounding import FloatType, WideArray
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.mechanisms.tree_equations import Shape, parameters, shape_of, written

#: Up to this many links the code is optimised: that of forty in space would take half a minute to compile, that of two hundred
#: several minutes, instead of fifteen seconds.
MOST_OPTIMISED = 24


def followed(tree: Tree, times: WideArray, kind: FloatType) -> Course:
    """The links of a tree at times (n,) >= 0, s, in any order. Raises `OutOfReach`."""
    if any(link.friction for link in tree.links):
        return stick_slip.followed(tree, times, kind)
    large = len(tree.links) > MOST_OPTIMISED
    solver = integrator(_equations(shape_of(tree)), kind.dtype, kind.bits, large=large)
    rows = solve(solver, kind.array(start(tree)), kind.array(parameters(tree)), times)
    return Course(split(tree, rows, times, kind), ())


@functools.cache
def _equations(shape: Shape) -> functools.partial[Equations]:
    """A function that gives the equations, always the same one, since compiled integrators are known by it."""
    return functools.partial(_system, shape)


def _system(shape: Shape) -> Equations:
    return written(shape).system
