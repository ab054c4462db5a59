"""Growth of an error along a motion, from the variational equations of a free rigid body, integrated with heyoka."""

from dataclasses import dataclass

import heyoka as hy
import numpy as np

from bodycheck.reference.integration.heyoka_solver import Equations, integrator, solve
from bodycheck.reference.integration.taylor import euler_equations, euler_start, unit_of_rate
from bodycheck.reference.kinematics import conjugate, multiply, normalise
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: Initial size of the variations. They are linear, so that any size is possible; with a small one the motion itself, and not
#: its variations, determines the size of the steps.
VARIATION_SIZE = 2.0**-40

#: Number of instants, evenly spaced from 0 to the last requested time, at which an error is assumed to be made.
ERROR_INSTANTS = 200


@dataclass(frozen=True, eq=False)
class Growth:
    """Attitude error (rad) at n instants per unit of relative error made earlier: an error eps grows to about eps times this.

    One unit is an error of one rad in the attitude together with one of |Omega| rad/s in the angular velocity, in the worst
    direction. Both attributes are at least 1. A flip undoes much of the growth of an initial error, but not the growth of an
    error made in the middle of the flip.

    Attributes
    ----------
    of_initial
        (n,) growth of an error in the initial state.
    of_any
        (n,) growth of an error made at the worst moment until then; rounding errors are made at all moments.
    """

    of_initial: Array
    of_any: Array


def variational_equations() -> Equations:
    """`euler_equations`, and the equations for the derivatives of their 7 variables with respect to the 3 initial body rates.

    The derivatives of one variable are consecutive.
    """
    return list(hy.var_ode_sys(euler_equations(), hy.make_vars("x", "y", "z")).sys)


def growth(scene: Scene, times: Array) -> Growth:
    """The growth of an error in the attitude of a free body until times (n,) >= 0, s, in any order.

    The body frame of the scene must be along the principal axes. The state-transition matrix of (rotation in the world frame,
    angular velocity in the body frame) from 0 to t is [[1, J(t)], [0, M(t)]], because an initial rotation rotates the whole
    motion. The matrix from s to t has the upper right block (J(t) - J(s)) / M(s). `of_initial` is the largest singular value of
    [1, |Omega(0)| J(t)]. `of_any` is the largest singular value of [1, |Omega(s)| (J(t) - J(s)) / M(s)] for the worst s, but
    with the Frobenius norm of the second block, which is at most sqrt(3) times too large.

    Raises `OutOfReach` if the integration fails or takes too many steps.
    """
    start, parameters = euler_start(scene, np.float64)
    variations = np.zeros((7, 3))
    variations[4:] = VARIATION_SIZE * np.eye(3)
    times = np.asarray(times)
    origins = np.linspace(0.0, times.max(initial=0.0), ERROR_INSTANTS)
    solution = solve(
        integrator(variational_equations, np.float64),
        np.concatenate([start, variations.ravel()]),
        parameters,
        np.concatenate([times, origins]) * unit_of_rate(scene),
    )
    attitudes = normalise(solution[:, None, :4])
    derivatives = solution[:, 7:].reshape(-1, 7, 3) / VARIATION_SIZE
    turns = 2 * multiply(np.swapaxes(derivatives[:, :4], 1, 2), conjugate(attitudes))[..., 1:]
    j, m = np.swapaxes(turns, 1, 2), derivatives[:, 4:]
    speeds = np.linalg.norm(solution[:, 4:7], axis=1)

    # Euler's equations conserve volume in the space of rates, so that det M = 1 and the rows of the inverse of M are cross
    # products of its columns.
    inverse = np.swapaxes(np.cross(np.roll(m, -1, axis=2), np.roll(m, -2, axis=2), axis=1), 1, 2)

    n = len(times)
    of_any = np.zeros(n)
    for s, j_s, back in zip(origins, j[n:], speeds[n:, None, None] * inverse[n:], strict=True):
        later = times >= s
        carried = np.linalg.norm((j[:n][later] - j_s) @ back, axis=(1, 2))
        of_any[later] = np.maximum(of_any[later], carried)
    of_initial = speeds[n] * np.linalg.norm(j[:n], ord=2, axis=(1, 2))
    return Growth(np.hypot(1.0, of_initial), np.hypot(1.0, of_any))
