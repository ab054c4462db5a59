"""Identify the textbook scheme that produces an engine's trajectory, and the number of digits to which it agrees.

The reference integrates the exact equations of motion by every scheme that it knows (`reference.schemes.one_step`), with the
engine's time step. Two programs of the same scheme differ only by rounding, and that difference has a bound.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.contract import Strides
from bodycheck.casefile.case import Case
from bodycheck.judging.discrepancy import compare
from bodycheck.reference.kinematics import conjugate, geodesic_angle, multiply, normalise
from bodycheck.reference.scene import Scene, State
from bodycheck.reference.schemes.formulations import FORMULATIONS, Formulation, world_velocity
from bodycheck.reference.schemes.one_step import SCHEMES, Scheme, step_through
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth, distance
from bodycheck.running.outcome import Completed, Run

#: Time from the start in which rounding errors have hardly grown, so that schemes are distinguished best.
EARLY_S = 2.0

#: Attitude difference up to which two trajectories count as equal in that time.
SAME_RAD = 1e-11

#: Largest allowed ratio of a scheme's difference to that of every other scheme, for the scheme to be named.
MAX_UNEXPLAINED_FRACTION = 0.01

#: Difference of two programs per step by rounding: in rad for the attitude, relative for the body rates and their changes.
#:
#: Each component of a product of unit quaternions has an error of at most 4 units of roundoff, all four of 8, the angle of 16.
#: It is practically impossible that two programs have their largest errors in opposite directions in every step.
STEP_ROUNDING = 16 * 2.0**-53

#: Number of segments of a run; the rounding of each is assigned to its start.
SEGMENTS = 200

#: Relative change of the body rates in finite differences; a bound needs only half of the digits.
RELATIVE_RATE_CHANGE = 1e-7


@dataclass(frozen=True)
class Candidate:
    """A scheme that was compared with a run.

    Parameters
    ----------
    scheme
        The name of the scheme.
    early, residual
        The largest attitude difference (rad) in the first 2 s and in the whole run; infinite if the scheme fails.
    fits
        Whether rounding can explain the difference at every instant.
    """

    scheme: str
    early: float
    residual: float
    fits: bool


@dataclass(frozen=True)
class Identification:
    """The scheme that a run agrees with, and the differences from the closest scheme.

    Parameters
    ----------
    scheme
        The name of the scheme; empty if none is named. The name is followed by "on the body twist" if only that formulation has
        the position of the run, and by "in rotation" if no formulation has it.
    early, residual
        The largest attitude difference (rad) from the closest scheme in the first 2 s and in the whole run.
    allowed
        The largest attitude difference (rad) that rounding can cause by the end of the run.
    position_residual
        The largest distance (m) from the closest scheme, in the closer formulation.
    candidates
        All schemes, the closest first. If several fit, it is the one with the smallest position_residual.
    """

    scheme: str
    early: float
    residual: float
    allowed: float
    position_residual: float
    candidates: tuple[Candidate, ...]

    @property
    def cannot_tell(self) -> bool:
        """Whether the scene cannot distinguish schemes: some fit, but none is named."""
        return not self.scheme and any(candidate.fits for candidate in self.candidates)


def identify(case: Case, run: Run, truth: Truth) -> Identification | None:
    """Identify the scheme of a completed run; return None for a case with a plane, where no scheme is compared.

    A scheme is named if its rotation fits, in the first 2 s to within `SAME_RAD`, and if the rotation or the position
    distinguishes it from every other scheme and from the truth (see `tells`). In a spin about a fixed axis the rotations of
    all schemes fit, and with very small time steps that of the truth fits too.

    Parameters
    ----------
    case
        The case.
    run
        A run of the case.
    truth
        The truth of the case.

    Raises
    ------
    ValueError
        If the run has no trajectory.
    """
    if not isinstance(run.outcome, Completed):
        raise ValueError(f"the run has no trajectory to identify, its status is {run.outcome.status}: {run.outcome.reason}")
    scene, timestep, trajectory = case.scene, run.method.timestep, run.outcome.trajectory
    if scene.plane is not None:
        return None
    truth = truth.at(trajectory.t)
    error = compare(truth, run).series
    early = trajectory.t <= EARLY_S

    turned = {name: differences(scheme, world_velocity, scene, timestep, trajectory)[0] for name, scheme in SCHEMES.items()}
    order = sorted(turned, key=lambda name: (turned[name][early].max(), turned[name].max()))
    allowed = allowance(SCHEMES[order[0]], scene, timestep, trajectory)
    fitting = [name for name in order if (turned[name] <= allowed).all()]
    moved = {
        (name, formulation): differences(SCHEMES[name], motion, scene, timestep, trajectory)[1]
        for name in fitting or order[:1]
        for formulation, motion in FORMULATIONS.items()
    }
    nearest, formulation = min(moved, key=lambda pair: float(moved[pair].max()))
    order = [nearest, *(name for name in order if name != nearest)]
    turn, way = turned[nearest], moved[nearest, formulation]

    aside = in_position(allowed, trajectory, timestep)
    in_place = bool((way <= aside).all())
    formulations = [moved[nearest, other] for other in FORMULATIONS if other != formulation]
    rotations = [turned[name] for name in order[1:]]
    ways = [other for (name, _), other in moved.items() if name != nearest]
    rotation_tells = tells(turn, [error["attitude_error"] - truth.bounds.error, *rotations], allowed, early)
    position_tells = in_place and tells(way, [error["position_error"] - truth.bounds.position_error, *ways], aside, early)
    named = nearest in fitting and turn[early].max() <= SAME_RAD and (rotation_tells or position_tells)
    told = formulation if tells(way, formulations, aside, early) else ""
    return Identification(
        scheme=nearest + (told if in_place else " in rotation") if named else "",
        early=float(turn[early].max()),
        residual=float(turn.max()),
        allowed=float(allowed[-1]),
        position_residual=float(way.max()),
        candidates=tuple(_candidate(name, turned[name], early, name in fitting) for name in order),
    )


def _candidate(name: str, turned: Array, early: NDArray[np.bool_], fits: bool) -> Candidate:
    return Candidate(name, float(turned[early].max()), float(turned.max()), fits)


def differences(
    scheme: Scheme, formulation: Callable[[Scene], Formulation], scene: Scene, timestep: float, trajectory: Trajectory
) -> tuple[Array, Array]:
    """Return the differences of a scheme from a run at its n instants; they are infinite after the scheme fails.

    Parameters
    ----------
    scheme, formulation
        The scheme, and the velocities that it integrates.
    scene
        The scene of the run.
    timestep
        The time step (s) of the run.
    trajectory
        The trajectory of the run.

    Returns
    -------
    The attitude differences (n,), in rad, and the distances of the centres of mass (n,), in m.
    """
    states = _states(scheme, formulation, scene, timestep, tuple(_steps(trajectory, timestep).tolist()))
    turned = geodesic_angle(normalise(trajectory.quaternion), states[:, 3:7])
    return _or_infinite(turned), _or_infinite(distance(trajectory.position, states[:, :3]))


def tells(own: Array, others: Iterable[Array], limit: Array, early: NDArray[np.bool_]) -> bool:
    """Return whether a scheme's difference from a run distinguishes it from other candidates.

    It does if every other difference exceeds the limit of rounding at some instant, and is a hundred times as large in the
    first 2 s or in the whole run.

    Parameters
    ----------
    own
        The differences (n,) of the scheme.
    others
        The differences (n,) of the other candidates.
    limit
        The largest differences (n,) that rounding can cause.
    early
        Marks (n,) the instants in the first 2 s.
    """
    return all(
        (other > limit).any()
        and (
            own[early].max() < MAX_UNEXPLAINED_FRACTION * other[early].max()
            or own.max() < MAX_UNEXPLAINED_FRACTION * other.max()
        )
        for other in others
    )


def allowance(scheme: Scheme, scene: Scene, timestep: float, trajectory: Trajectory) -> Array:
    """Return a bound (n,) of the attitude difference (rad) that rounding causes between two programs of the same scheme.

    An error of the attitude stays constant, and an error of the body rates grows by the factor J. To first order, the bound at
    each of the run's n instants is the sum over all previous steps of

        ROUNDINGS (1 + |J| (|Omega| + h (I Omega^2 + m v^2) / i)),

    and it never decreases. I is the largest moment, i the smallest, and J is computed from the scheme for every segment of the
    run. The last terms come from the torque about the centre of mass. In spatial algebra the torque contains v x m v, which
    is zero except for rounding: an engine that combines linear and angular velocity rounds the spin by the speed.

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
    """
    samples = _steps(trajectory, timestep)
    ends = np.unique(np.linspace(0, samples[-1], SEGMENTS + 1).astype(np.int64))
    strides = np.diff(ends)
    states = _states(scheme, world_velocity, scene, timestep, tuple(ends.tolist()))
    spin = np.linalg.norm(states[:, 10:], axis=1)
    speed = np.interp(ends * timestep, trajectory.t, np.linalg.norm(trajectory.velocity, axis=1))
    moments = scene.body.moments
    torque = (max(moments) * spin**2 + scene.body.mass * speed**2) / min(moments)
    rounded = spin + timestep * torque

    bound = np.full(len(ends), STEP_ROUNDING)
    turn, rates = np.zeros((len(ends), 3, 3)), np.tile(np.eye(3), (len(ends), 1, 1))
    with np.errstate(all="ignore"):  # a scheme that fails has no bound
        for k, (turned, changed) in enumerate(_linearised(scheme, scene, timestep, tuple(ends.tolist()))):
            turn[: k + 1] += turned @ rates[: k + 1]
            rates[: k + 1] = changed @ rates[: k + 1]
            grown = 1 + np.linalg.norm(turn[: k + 1], axis=(1, 2)) * rounded[: k + 1]
            bound[k + 1] += STEP_ROUNDING * (grown @ strides[: k + 1])
    bound = np.minimum(_or_infinite(bound), np.pi)  # no angle is larger
    return np.asarray(np.maximum.accumulate(bound)[np.searchsorted(ends, samples)])


def in_position(allowed: Array, trajectory: Trajectory, timestep: float) -> Array:
    """Return the distances (n,), in m, that rounding can cause if it can cause the attitude differences `allowed` (n,), in rad.

    A velocity whose direction is off by an angle leads aside by this angle times the distance travelled. In addition, the
    position is rounded in every step.
    """
    far, speed = (np.linalg.norm(part, axis=1) for part in (trajectory.position, trajectory.velocity))
    way = np.maximum.accumulate(speed) * trajectory.t
    return np.asarray(allowed * way + STEP_ROUNDING * (1 + _steps(trajectory, timestep)) * np.maximum.accumulate(far))


# The methods of all engines are compared with the same schemes at the same time steps and instants: one scene at a time.
@lru_cache(maxsize=2 * len(SCHEMES) * len(FORMULATIONS))
def _states(
    scheme: Scheme, formulation: Callable[[Scene], Formulation], scene: Scene, timestep: float, ends: tuple[int, ...]
) -> Array:
    """Return the states (n, 13) of a scheme after the numbers of steps `ends` (n,)."""
    states = step_through(scheme, formulation, scene, timestep, np.diff(ends, prepend=0))
    states.setflags(write=False)
    return states


@lru_cache(maxsize=len(SCHEMES))
def _linearised(scheme: Scheme, scene: Scene, timestep: float, ends: tuple[int, ...]) -> tuple[tuple[Array, Array], ...]:
    """Return the derivatives of every segment of a scheme's run, as `_derivatives` does; segments end at the steps `ends`."""
    states = _states(scheme, world_velocity, scene, timestep, ends)
    return tuple(
        _derivatives(scheme, scene, timestep, states[k], states[k + 1], ends[k + 1] - ends[k]) for k in range(len(ends) - 1)
    )


def _derivatives(scheme: Scheme, scene: Scene, timestep: float, start: Array, end: Array, stride: int) -> tuple[Array, Array]:
    """Return the derivatives (3, 3) of the rotation in the world (s), and of the body rates, by the body rates before a stride.

    `start` and `end` are the states (13,) before and after the stride, and `stride` is its number of steps.
    """
    w, x, y, z = start[3:7].tolist()
    nudge = RELATIVE_RATE_CHANGE * float(np.linalg.norm(start[10:]) or 1.0)
    ends = []
    for axis in np.eye(3):
        p, q, r = (start[10:] + nudge * axis).tolist()
        nudged = replace(scene, initial=State(quaternion=(w, x, y, z), angular_velocity=(p, q, r)))
        ends.append(step_through(scheme, world_velocity, nudged, timestep, np.array([stride]))[0])
    there = np.array(ends)
    turned = 2 * multiply(there[:, 3:7], conjugate(end[3:7]))
    return (turned[:, 1:] * np.sign(turned[:, :1])).T / nudge, (there[:, 10:] - end[10:]).T / nudge


def _steps(trajectory: Trajectory, timestep: float) -> Strides:
    """Return the numbers of steps (n,) from the start of a run to its samples."""
    return np.rint(trajectory.t / timestep).astype(np.int64)


def _or_infinite(values: Array) -> Array:
    """Return the values with NaN replaced by infinity."""
    return np.where(np.isnan(values), np.inf, values)
