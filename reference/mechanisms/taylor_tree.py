"""The links of a tree by Taylor's method in any floating-point type (heyoka; Linux only).

Importing this raises `ImportError` where heyoka is not installed.
"""

import functools

from bodycheck.reference.integration.heyoka_solver import Equations, integrator, solve
from bodycheck.reference.mechanisms import stick_slip
from bodycheck.reference.mechanisms.link_states import Course, split, start
from bodycheck.reference.mechanisms.rounding import FloatType, WideArray
from bodycheck.reference.mechanisms.tree import Tree
from bodycheck.reference.mechanisms.tree_equations import Shape, most_steps, parameters, shape_of, written


def followed(tree: Tree, times: WideArray, kind: FloatType) -> Course:
    """The links of a tree at times (n,) >= 0, s, in any order. Raises `OutOfReach`."""
    if any(link.friction for link in tree.links):
        return stick_slip.followed(tree, times, kind)
    shape = shape_of(tree)
    solver = integrator(_equations(shape), kind.dtype, kind.bits, large=shape.large)
    rows = solve(solver, kind.array(start(tree)), kind.array(parameters(tree)), times, most=most_steps(solver))
    return Course(split(tree, rows, times, kind), ())


@functools.cache
def _equations(shape: Shape) -> functools.partial[Equations]:
    """A function that gives the equations, always the same one, since compiled integrators are known by it."""
    return functools.partial(_system, shape)


def _system(shape: Shape) -> Equations:
    return written(shape).system
