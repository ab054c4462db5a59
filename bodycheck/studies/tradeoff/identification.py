"""Which textbook scheme an engine's trajectory is, and to how many digits.

The reference steps the exact equations of motion by every scheme that it knows (`reference.schemes.one_step`), with the
engine's own time step. Two programs of one scheme differ by rounding alone, and how far that may carry them apart has a bound.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

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

#: Seconds from the start in which rounding has hardly grown, so that schemes are told apart best.
EARLY = 2.0

#: Attitude difference (rad) up to which two trajectories are one in that time.
SAME = 1e-11

#: The part of another's difference that an explanation may leave over.
LEFT_OVER = 0.01

#: How far a step of two programs is apart by rounding: rad of attitude, and parts of the rates and of what changes them.
#:
#: The components of a product of unit quaternions are off by 4 units of roundoff each at worst, all four by 8, the angle by 16.
#: That two programs are at their worst in opposite senses, and are so step after step, is out of the question.
ROUNDINGS = 16 * 2.0**-53

#: Parts of a run; the rounding of each is thought to happen at its start.
STRETCHES = 200

#: Relative change of the body rates by which derivatives are taken: half of the digits is all that a bound needs.
NUDGE = 1e-7


@dataclass(frozen=True)
class Candidate:
    """A scheme that was tried: its largest attitude difference (rad) from a run, early and in all, infinite where it fails.

    fits: the difference is at no instant more than rounding allows.
    """

    scheme: str
    early: float
    residual: float
    fits: bool


@dataclass(frozen=True)
class Identification:
    """The scheme whose trajectory a run is, and how near the nearest comes.

    scheme: empty where none is named. Behind its name stands "on the body twist" where the position is that of this formulation
    and not of the other, and "in rotation" where it is that of neither. candidates: the nearest first, which is the one with
    the least position_residual where several fit. Of the nearest: early, residual: the largest attitude difference (rad) in the
    first 2 s and in the whole run. allowed: what rounding may have made of it by the end (rad). position_residual: the largest
    distance (m), with the nearer formulation.
    """

    scheme: str
    early: float
    residual: float
    allowed: float
    position_residual: float
    candidates: tuple[Candidate, ...]

    @property
    def cannot_tell(self) -> bool:
        """Whether the scene does not tell: no scheme is named although some fit."""
        return not self.scheme and any(candidate.fits for candidate in self.candidates)


def identify(case: Case, run: Run, truth: Truth) -> Identification | None:
    """The scheme of a completed run of a case; None on a plane, where no scheme is tried.

    A scheme is named where its rotation fits, early to within `SAME`, and where the rotation, or else the position, tells it
    from every other scheme and from the truth (see `tells`). In a spin about a fixed axis the rotations of all schemes fit,
    and with the smallest of steps that of the truth does.

    Raises `ValueError` for a run that has no trajectory.
    """
    if not isinstance(run.outcome, Completed):
        raise ValueError(f"the run has no trajectory to identify, its status is {run.outcome.status}: {run.outcome.reason}")
    scene, timestep, trajectory = case.scene, run.method.timestep, run.outcome.trajectory
    if scene.plane is not None:
        return None
    truth = truth.at(trajectory.t)
    error = compare(truth, run).series
    early = trajectory.t <= EARLY

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
    rotation_tells = tells(turn, [error["attitude_error"] - truth.error, *rotations], allowed, early)
    position_tells = in_place and tells(way, [error["position_error"] - truth.position_error, *ways], aside, early)
    named = nearest in fitting and turn[early].max() <= SAME and (rotation_tells or position_tells)
    if not in_place:
        formulation = " in rotation"
    elif not tells(way, formulations, aside, early):
        formulation = ""
    return Identification(
        scheme=nearest + formulation if named else "",
        early=float(turn[early].max()),
        residual=float(turn.max()),
        allowed=float(allowed[-1]),
        position_residual=float(way.max()),
        candidates=tuple(
            Candidate(name, float(turned[name][early].max()), float(turned[name].max()), name in fitting) for name in order
        ),
    )


def differences(
    scheme: Scheme, formulation: Callable[[Scene], Formulation], scene: Scene, timestep: float, trajectory: Trajectory
) -> tuple[Array, Array]:
    """How far a scheme is from a run at its instants: attitude (n,), rad, and position (n,), m; infinite where it fails."""
    states = step_through(scheme, formulation, scene, timestep, np.diff(_steps(trajectory, timestep), prepend=0))
    turned = geodesic_angle(normalise(trajectory.quaternion), states[:, 3:7])
    return _or_infinite(turned), _or_infinite(distance(trajectory.position, states[:, :3]))


def tells(own: Array, others: Iterable[Array], limit: Array, early: NDArray[np.bool_]) -> bool:
    """Whether a difference (n,) tells its candidate from others, by theirs (n,).

    Each of them is at some instant beyond the limit (n,) of rounding, and either early or in all a hundred times as large.
    """
    return all(
        (other > limit).any() and (own[early].max() < LEFT_OVER * other[early].max() or own.max() < LEFT_OVER * other.max())
        for other in others
    )


def allowance(scheme: Scheme, scene: Scene, timestep: float, trajectory: Trajectory) -> Array:
    """Bound (n,) of the attitude difference (rad) that rounding makes between two programs of a scheme, at a run's instants.

    An error made in the attitude stays as it is, one made in the body rates becomes J times as large. The bound is to first
    order the sum over all steps so far of

        ROUNDINGS (1 + |J| (|Omega| + h (I Omega^2 + m v^2) / i)),

    never less than it was before, with the largest moment I, the least i, and J from the scheme itself, stretch by stretch.
    The last terms are of the torque about the centre. In spatial algebra v x m v is among them, which vanishes but for its
    rounding: an engine that does not know a body's speed from its spin rounds the spin by the speed.
    """
    samples = _steps(trajectory, timestep)
    ends = np.unique(np.linspace(0, samples[-1], STRETCHES + 1).astype(np.int64))
    strides = np.diff(ends)
    states = step_through(scheme, world_velocity, scene, timestep, np.diff(ends, prepend=0))
    spin = np.linalg.norm(states[:, 10:], axis=1)
    speed = np.interp(ends * timestep, trajectory.t, np.linalg.norm(trajectory.velocity, axis=1))
    moments = scene.body.moments
    torque = (max(moments) * spin**2 + scene.body.mass * speed**2) / min(moments)
    rounded = spin + timestep * torque

    bound = np.full(len(ends), ROUNDINGS)
    turn, rates = np.zeros((len(ends), 3, 3)), np.tile(np.eye(3), (len(ends), 1, 1))
    with np.errstate(all="ignore"):  # a scheme that fails has no bound
        for k, stride in enumerate(strides):
            turned, changed = _derivatives(scheme, scene, timestep, states[k], states[k + 1], int(stride))
            turn[: k + 1] += turned @ rates[: k + 1]
            rates[: k + 1] = changed @ rates[: k + 1]
            grown = 1 + np.linalg.norm(turn[: k + 1], axis=(1, 2)) * rounded[: k + 1]
            bound[k + 1] += ROUNDINGS * (grown @ strides[: k + 1])
    bound = np.minimum(_or_infinite(bound), np.pi)  # no angle is larger
    return np.asarray(np.maximum.accumulate(bound)[np.searchsorted(ends, samples)])


def in_position(allowed: Array, trajectory: Trajectory, timestep: float) -> Array:
    """The distance (n,), m, that rounding makes where it makes the attitude differ by as much as allowed (n,), rad.

    A velocity that points elsewhere by an angle leads aside by as much of the way, and the position is rounded in each step.
    """
    far, speed = (np.linalg.norm(part, axis=1) for part in (trajectory.position, trajectory.velocity))
    way = np.maximum.accumulate(speed) * trajectory.t
    return np.asarray(allowed * way + ROUNDINGS * (1 + _steps(trajectory, timestep)) * np.maximum.accumulate(far))


def _derivatives(scheme: Scheme, scene: Scene, timestep: float, start: Array, end: Array, stride: int) -> tuple[Array, Array]:
    """Derivatives (3, 3) of the turn in the world (s) and of the body rates by the body rates a stride before.

    start, end: the states (13,) before and after the stride.
    """
    w, x, y, z = start[3:7].tolist()
    nudge = NUDGE * float(np.linalg.norm(start[10:]) or 1.0)
    ends = []
    for axis in np.eye(3):
        p, q, r = (start[10:] + nudge * axis).tolist()
        nudged = replace(scene, initial=State(quaternion=(w, x, y, z), angular_velocity=(p, q, r)))
        ends.append(step_through(scheme, world_velocity, nudged, timestep, np.array([stride]))[0])
    there = np.array(ends)
    turned = 2 * multiply(there[:, 3:7], conjugate(end[3:7]))
    return (turned[:, 1:] * np.sign(turned[:, :1])).T / nudge, (there[:, 10:] - end[10:]).T / nudge


def _steps(trajectory: Trajectory, timestep: float) -> Strides:
    """Numbers of steps (n,) from the start of a run to its samples."""
    return np.rint(trajectory.t / timestep).astype(np.int64)


def _or_infinite(values: Array) -> Array:
    """The same with infinity in the place of what is not a number."""
    return np.where(np.isnan(values), np.inf, values)
