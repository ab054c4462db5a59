"""Runge-Kutta schemes for one free rigid body, explicit and implicit, from their tableaus.

A stage has an increment of the pose and a velocity. The kind of scheme depends on the formulation: with the exponential map it
is a scheme of Munthe-Kaas (BIT 38, 1998), or a scheme with averaged velocities; with a quaternion or angles as coordinates it
is the usual scheme for vectors. The coefficients are those of Hairer, Norsett and Wanner, Solving Ordinary Differential
Equations I, 1993, chapter II, unless another source is named.
"""

import math
from dataclasses import dataclass
from operator import mul

from bodycheck.reference.schemes.formulations import Formulation
from bodycheck.reference.schemes.increments import Increment, Pair, Pose
from bodycheck.reference.schemes.one_step import SOLVED, Scheme

#: Largest number of iterations for the equations of an implicit scheme; more are needed only where they have no solution.
MOST_ITERATIONS = 200

Row = tuple[float, ...]

#: A slope of a stage in one row: the rates of the increment, linear and angular, and the accelerations.
Slope = tuple[float, ...]


@dataclass(frozen=True)
class Tableau:
    """The coefficients of a Runge-Kutta scheme.

    Attributes
    ----------
    stages
        For each stage the weights of the slopes of other stages: of the stages before it if the scheme is explicit, otherwise
        of all stages.
    weights
        The weights of the slopes in the step.
    order
        The order of the scheme for ordinary differential equations.
    """

    stages: tuple[Row, ...]
    weights: Row
    order: int


HEUN_2 = Tableau(((), (1.0,)), (1 / 2, 1 / 2), 2)
MIDPOINT_2 = Tableau(((), (1 / 2,)), (0.0, 1.0), 2)
KUTTA_3 = Tableau(((), (1 / 2,), (-1.0, 2.0)), (1 / 6, 2 / 3, 1 / 6), 3)
HEUN_3 = Tableau(((), (1 / 3,), (0.0, 2 / 3)), (1 / 4, 0.0, 3 / 4), 3)
#: Bogacki and Shampine, Appl. Math. Lett. 2, 1989.
BOGACKI_SHAMPINE_3 = Tableau(((), (1 / 2,), (0.0, 3 / 4)), (2 / 9, 1 / 3, 4 / 9), 3)
KUTTA_4 = Tableau(((), (1 / 2,), (0.0, 1 / 2), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6), 4)
MERSON_4 = Tableau(
    ((), (1 / 3,), (1 / 6, 1 / 6), (1 / 8, 0.0, 3 / 8), (1 / 2, 0.0, -3 / 2, 2.0)), (1 / 6, 0.0, 0.0, 2 / 3, 1 / 6), 4
)
FEHLBERG_4 = Tableau(
    (
        (),
        (1 / 4,),
        (3 / 32, 9 / 32),
        (1932 / 2197, -7200 / 2197, 7296 / 2197),
        (439 / 216, -8.0, 3680 / 513, -845 / 4104),
    ),
    (25 / 216, 0.0, 1408 / 2565, 2197 / 4104, -1 / 5),
    4,
)
DORMAND_PRINCE_5 = Tableau(
    (
        (),
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    ),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    5,
)

#: Butcher, J. Austral. Math. Soc. 4, 1964: seven stages with the abscissas of Lobatto's quadrature.
_ROOT = math.sqrt(5)
BUTCHER_6 = Tableau(
    (
        (),
        ((5 - _ROOT) / 10,),
        (-_ROOT / 10, (5 + 2 * _ROOT) / 10),
        ((-15 + 7 * _ROOT) / 20, (-1 + _ROOT) / 4, (15 - 7 * _ROOT) / 10),
        ((5 - _ROOT) / 60, 0.0, 1 / 6, (15 + 7 * _ROOT) / 60),
        ((5 + _ROOT) / 60, 0.0, (9 - 5 * _ROOT) / 12, 1 / 6, (-5 + 3 * _ROOT) / 10),
        (1 / 6, 0.0, (-55 + 25 * _ROOT) / 12, (-25 - 7 * _ROOT) / 12, 5 - 2 * _ROOT, (5 + _ROOT) / 2),
    ),
    (1 / 12, 0.0, 0.0, 0.0, 5 / 12, 5 / 12, 1 / 12),
    6,
)

#: Implicit schemes (Hairer and Wanner, Solving Ordinary Differential Equations II, 1996, chapter IV.5).
IMPLICIT_EULER = Tableau(((1.0,),), (1.0,), 1)
TRAPEZOIDAL = Tableau(((0.0, 0.0), (1 / 2, 1 / 2)), (1 / 2, 1 / 2), 2)
RADAU_IIA_3 = Tableau(((5 / 12, -1 / 12), (3 / 4, 1 / 4)), (3 / 4, 1 / 4), 3)


def explicit(tableau: Tableau) -> Scheme:
    """The explicit scheme of a tableau."""

    def step(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
        slopes: list[Slope] = []
        for row in tableau.stages:
            slopes.append(_slope(formulation, pose, *_after(formulation, v, h, row, slopes)))
        u, end = _after(formulation, v, h, tableau.weights, slopes)
        return formulation.displace(pose, u), end

    return step


def implicit(tableau: Tableau) -> Scheme:
    """The implicit scheme of a tableau, solved to rounding by fixed-point iteration.

    The scheme raises `ArithmeticError` if the iteration does not converge, which can happen if the body turns by a radian or
    more in a step.
    """

    def step(formulation: Formulation, pose: Pose, v: Pair, h: float) -> tuple[Pose, Pair]:
        slopes = [_slope(formulation, pose, formulation.zero, v)] * len(tableau.stages)
        least = math.inf
        for _ in range(MOST_ITERATIONS):
            before = slopes
            slopes = [_slope(formulation, pose, *_after(formulation, v, h, row, before)) for row in tableau.stages]
            change = max(abs(a - b) for stage, old in zip(slopes, before, strict=True) for a, b in zip(stage, old, strict=True))
            if not change < least:
                break
            least = change
        size = max(abs(a) for stage in slopes for a in stage)
        if not least <= SOLVED * max(size, 1.0):
            raise ArithmeticError("the fixed-point iteration of an implicit Runge-Kutta scheme does not converge")
        u, end = _after(formulation, v, h, tableau.weights, slopes)
        return formulation.displace(pose, u), end

    return step


def _slope(formulation: Formulation, pose: Pose, u: Increment, v: Pair) -> Slope:
    """The slope of a stage with an increment and a velocity."""
    (a, b, c), angular = formulation.rate(pose, u, v)
    (i, j, k), (p, q, r) = formulation.acceleration(formulation.displace(pose, u), v)
    return (a, b, c, *angular, i, j, k, p, q, r)


def _after(formulation: Formulation, v: Pair, h: float, row: Row, slopes: list[Slope]) -> tuple[Increment, Pair]:
    """The increment and the velocity after a step h along the weighted slopes."""
    if not row:
        return formulation.zero, v
    a, b, c, *angular, i, j, k, p, q, r = [h * sum(map(mul, row, column)) for column in zip(*slopes, strict=True)]
    (x, y, z), (f, g, e) = v
    return ((a, b, c), tuple(angular)), ((x + i, y + j, z + k), (f + p, g + q, e + r))
