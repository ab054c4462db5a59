"""How far an error is carried along a motion: the variational equations of a free rigid body, integrated by heyoka."""

from dataclasses import dataclass

import heyoka as hy
import numpy as np

from bodycheck.reference.integration.taylor import Equations, euler_equations, euler_start, integrator, solve, unit_of_rate
from bodycheck.reference.kinematics import conjugate, multiply, normalise
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: Size of the variations at the start. Being linear, they may have any; small ones leave the steps to the motion itself.
VARIATION_SIZE = 2.0**-40

#: Instants, evenly spaced from 0 to the last one asked for, at which an error is thought to be made.
ERROR_INSTANTS = 200


@dataclass(frozen=True, eq=False)
class Growth:
    """Attitude error (rad) at n instants per unit of relative error made earlier: an error eps becomes about eps times this.

    The unit is one rad of attitude and, at the same time, |Omega| rad/s of body rates, in the worst direction.
    of_initial: (n,) of an error in the initial state. of_any: (n,) of an error made at the worst moment until then, as rounding
    errors are. Both are at least 1. A flip undoes much of what it does to an initial error, not of one made in its middle.
    """

    of_initial: Array
    of_any: Array


def variational_equations() -> Equations:
    """`euler_equations` and the derivatives of their 7 variables, in turn, with respect to the 3 initial body rates."""
    return list(hy.var_ode_sys(euler_equations(), hy.make_vars("x", "y", "z")).sys)


def growth(scene: Scene, times: Array) -> Growth:
    """How much of an earlier error is found in the attitude of a free body at times (n,) >= 0 s.

    The state-transition matrix of (turn in the world frame, body rates) from 0 to t is [[1, J(t)], [0, M(t)]]: an initial
    turn turns the whole motion. That from s to t has the corner (J(t) - J(s)) / M(s). `of_initial` is the largest singular
    value of [1, |Omega(0)| J(t)], and `of_any` that of [1, |Omega(s)| (J(t) - J(s)) / M(s)] for the worst s, but with the
    Frobenius norm of the second block, at most sqrt(3) times too large.

    Raises `OutOfReach` where the integration takes too many steps or cannot go on.
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

    # Euler's flow keeps volumes: det M = 1, and the rows of the inverse are cross products of columns.
    inverse = np.swapaxes(np.cross(np.roll(m, -1, axis=2), np.roll(m, -2, axis=2), axis=1), 1, 2)

    n = len(times)
    of_any = np.zeros(n)
    for s, j_s, back in zip(origins, j[n:], speeds[n:, None, None] * inverse[n:], strict=True):
        later = times >= s
        carried = np.linalg.norm((j[:n][later] - j_s) @ back, axis=(1, 2))
        of_any[later] = np.maximum(of_any[later], carried)
    of_initial = speeds[n] * np.linalg.norm(j[:n], ord=2, axis=(1, 2))
    return Growth(np.hypot(1.0, of_initial), np.hypot(1.0, of_any))
