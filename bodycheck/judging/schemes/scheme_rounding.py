"""A bound of the difference that rounding causes between two programs of the same scheme."""

from functools import lru_cache

import numpy as np

from bodycheck.judging.schemes.scheme_runs import or_infinite, sampled, steps
from bodycheck.reference.kinematics import conjugate, multiply
from bodycheck.reference.scene import Scene
from bodycheck.reference.schemes.formulations import Equations, Formulation, world_velocity
from bodycheck.reference.schemes.one_step import Scheme, step_from
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

    and the bound never decreases. Here, u is the unit roundoff, I the largest moment, i the smallest, and J is computed from
    the scheme for every segment of the run. The last terms come from the torque about the centre of mass. In spatial algebra
    the torque contains v x m v, which is zero except for rounding: in an engine that combines linear and angular velocity, the
    rounding of the spin depends on the speed.

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
    with np.errstate(all="ignore"):  # a scheme that fails has an infinite bound
        grown = (1 + _growth(scheme, formulation, scene, timestep, tuple(ends.tolist())) * rounded[:-1]) * strides
        bound[1:] += each * np.where(np.tri(len(strides), dtype=bool), grown, 0.0).sum(axis=1)
    bound = np.minimum(or_infinite(bound), np.pi)  # no angle is larger
    return np.asarray(np.maximum.accumulate(bound)[np.searchsorted(ends, samples)])


def in_position(allowed: Array, trajectory: Trajectory, timestep: float, roundoff: float) -> Array:
    """Return the distances (n,), m, that rounding can cause if it can cause the attitude differences `allowed` (n,), rad.

    An error of the direction of the velocity by an angle causes a distance of this angle times the distance travelled. In
    addition, the position is rounded in every step.
    """
    far, speed = (np.linalg.norm(part, axis=1) for part in (trajectory.position, trajectory.velocity))
    way = np.maximum.accumulate(speed) * trajectory.t
    each = STEP_ROUNDINGS * roundoff
    return np.asarray(allowed * way + each * (1 + steps(trajectory, timestep)) * np.maximum.accumulate(far))


@lru_cache(maxsize=16)
def _growth(scheme: Scheme, formulation: Equations, scene: Scene, timestep: float, ends: tuple[int, ...]) -> Array:
    """Return |J| (k, k), s, at the end of each segment of a scheme's run, for errors at the start of each segment up to it.

    The segments end at the steps `ends` (k + 1,), the first of which is 0. The elements beyond the diagonal are zero.
    """
    states, equations = sampled(scheme, formulation, scene, timestep, ends), formulation(scene)
    segments = len(ends) - 1
    sizes = np.zeros((segments, segments))
    turn, rates = np.zeros((segments, 3, 3)), np.tile(np.eye(3), (segments, 1, 1))
    for k in range(segments):
        turned, changed = _derivatives(scheme, equations, timestep, states[k], ends[k + 1] - ends[k])
        turn[: k + 1] += turned @ rates[: k + 1]
        rates[: k + 1] = changed @ rates[: k + 1]
        sizes[k, : k + 1] = np.linalg.norm(turn[: k + 1], axis=(1, 2))
    return sizes


def _derivatives(scheme: Scheme, equations: Formulation, timestep: float, start: Array, stride: int) -> tuple[Array, Array]:
    """Return the derivatives (3, 3) of world-frame rotation (s) and body rates with respect to the rates before a stride.

    `start` is the state (13,) before the stride, and `stride` its number of steps. The position and the velocity of the body
    have no effect.
    """
    w, x, y, z = start[3:7].tolist()
    nudge = RELATIVE_RATE_CHANGE * float(np.linalg.norm(start[10:]) or 1.0)
    pose, rest, strides = ((0.0, 0.0, 0.0), (w, x, y, z)), (0.0, 0.0, 0.0), np.array([stride])
    ends = []
    for axis in (np.zeros(3), *np.eye(3)):
        p, q, r = (start[10:] + nudge * axis).tolist()
        ends.append(step_from(scheme, equations, (pose, (rest, (p, q, r))), timestep, strides)[0])
    end, there = ends[0], np.array(ends[1:])
    turned = 2 * multiply(there[:, 3:7], conjugate(end[3:7]))
    return (turned[:, 1:] * np.sign(turned[:, :1])).T / nudge, (there[:, 10:] - end[10:]).T / nudge
