"""A bound of the difference that rounding causes between two programs of the same scheme."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from bodycheck.judging.scheme_runs import or_infinite, sampled, steps
from bodycheck.reference.kinematics import conjugate, multiply
from bodycheck.reference.scene import Scene, State
from bodycheck.reference.schemes.formulations import Equations, world_velocity
from bodycheck.reference.schemes.one_step import Scheme, step_through
from bodycheck.reference.trajectory import Array, Trajectory

#: Unit roundoff of double and single precision, by the name of the precision.
ROUNDOFF = {"float64": 2.0**-53, "float32": 2.0**-24}

#: Difference of two programs per step, in units of roundoff: in rad for the attitude, relative for the body rates and their
#: changes.
#:
#: Each component of a product of unit quaternions has an error of at most 4 units of roundoff, all four of 8, the angle of 16.
#: It is practically impossible that two programs have their largest errors in opposite directions in every step.
STEP_ROUNDINGS = 16

#: Number of segments of a run; the rounding of each is assigned to its start.
SEGMENTS = 200

#: Relative change of the body rates in finite differences; a bound needs only half of the digits.
RELATIVE_RATE_CHANGE = 1e-7


def allowance(
    scheme: Scheme,
    scene: Scene,
    timestep: float,
    trajectory: Trajectory,
    roundoff: float,
    formulation: Equations = world_velocity,
) -> Array:
    """Return a bound (n,) of the attitude difference (rad) that rounding causes between two programs of the same scheme.

    An error of the attitude stays constant, and an error of the body rates grows by the factor J. To first order, the bound at
    each of the run's n instants is the sum over all previous steps of

        16 u (1 + |J| (|Omega| + h (I Omega^2 + m v^2) / i)),

    and it never decreases. u is the unit roundoff, I the largest moment, i the smallest, and J is computed from the scheme for
    every segment of the run. The last terms come from the torque about the centre of mass. In spatial algebra the torque
    contains v x m v, which is zero except for rounding: an engine that combines linear and angular velocity rounds the spin by
    the speed.

    Parameters
    ----------
    scheme
        The scheme of both programs.
    scene
        The scene of the run.
    timestep
        The time step (s).
    trajectory
        The trajectory of the run, with its instants.
    roundoff
        The unit roundoff of the less precise program, one of `ROUNDOFF`.
    formulation
        The equations of motion that the scheme integrates.
    """
    samples = steps(trajectory, timestep)
    ends = np.unique(np.linspace(0, samples[-1], SEGMENTS + 1).astype(np.int64))
    strides = np.diff(ends)
    states = sampled(scheme, formulation, scene, timestep, tuple(ends.tolist()))
    spin = np.linalg.norm(states[:, 10:], axis=1)
    speed = np.interp(ends * timestep, trajectory.t, np.linalg.norm(trajectory.velocity, axis=1))
    moments = scene.body.moments
    torque = (max(moments) * spin**2 + scene.body.mass * speed**2) / min(moments)
    rounded = spin + timestep * torque

    each = STEP_ROUNDINGS * roundoff
    bound = np.full(len(ends), each)
    turn, rates = np.zeros((len(ends), 3, 3)), np.tile(np.eye(3), (len(ends), 1, 1))
    with np.errstate(all="ignore"):  # a scheme that fails has no bound
        for k, (turned, changed) in enumerate(_linearised(scheme, formulation, scene, timestep, tuple(ends.tolist()))):
            turn[: k + 1] += turned @ rates[: k + 1]
            rates[: k + 1] = changed @ rates[: k + 1]
            grown = 1 + np.linalg.norm(turn[: k + 1], axis=(1, 2)) * rounded[: k + 1]
            bound[k + 1] += each * (grown @ strides[: k + 1])
    bound = np.minimum(or_infinite(bound), np.pi)  # no angle is larger
    return np.asarray(np.maximum.accumulate(bound)[np.searchsorted(ends, samples)])


def in_position(allowed: Array, trajectory: Trajectory, timestep: float, roundoff: float) -> Array:
    """Return the distances (n,), in m, that rounding can cause if it can cause the attitude differences `allowed` (n,), in rad.

    A velocity whose direction is off by an angle leads aside by this angle times the distance travelled. In addition, the
    position is rounded in every step.
    """
    far, speed = (np.linalg.norm(part, axis=1) for part in (trajectory.position, trajectory.velocity))
    way = np.maximum.accumulate(speed) * trajectory.t
    each = STEP_ROUNDINGS * roundoff
    return np.asarray(allowed * way + each * (1 + steps(trajectory, timestep)) * np.maximum.accumulate(far))


@lru_cache(maxsize=16)
def _linearised(
    scheme: Scheme, formulation: Equations, scene: Scene, timestep: float, ends: tuple[int, ...]
) -> tuple[tuple[Array, Array], ...]:
    """Return the derivatives of every segment of a scheme's run, as `_derivatives` does; segments end at the steps `ends`."""
    states = sampled(scheme, formulation, scene, timestep, ends)
    return tuple(
        _derivatives(scheme, formulation, scene, timestep, states[k], ends[k + 1] - ends[k]) for k in range(len(ends) - 1)
    )


def _derivatives(
    scheme: Scheme, formulation: Equations, scene: Scene, timestep: float, start: Array, stride: int
) -> tuple[Array, Array]:
    """Return the derivatives (3, 3) of the rotation in the world (s), and of the body rates, by the body rates before a stride.

    `start` is the state (13,) before the stride, and `stride` its number of steps.
    """
    w, x, y, z = start[3:7].tolist()
    nudge = RELATIVE_RATE_CHANGE * float(np.linalg.norm(start[10:]) or 1.0)
    ends = []
    for axis in (np.zeros(3), *np.eye(3)):
        p, q, r = (start[10:] + nudge * axis).tolist()
        nudged = replace(scene, initial=State(quaternion=(w, x, y, z), angular_velocity=(p, q, r)))
        ends.append(step_through(scheme, formulation, nudged, timestep, np.array([stride]))[0])
    end, there = ends[0], np.array(ends[1:])
    turned = 2 * multiply(there[:, 3:7], conjugate(end[3:7]))
    return (turned[:, 1:] * np.sign(turned[:, :1])).T / nudge, (there[:, 10:] - end[10:]).T / nudge
