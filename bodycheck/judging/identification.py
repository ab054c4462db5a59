"""Identify the textbook scheme that produces an engine's trajectory, and the number of digits to which it agrees.

The reference integrates the exact equations of motion by every scheme that it knows (`reference.schemes.one_step`), with the
engine's time step (`scheme_runs`). Two programs of the same scheme differ only by rounding, and that difference has a bound
(`scheme_rounding`).
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile.case import Case
from bodycheck.judging.discrepancy import compare
from bodycheck.judging.scheme_rounding import allowance, in_position
from bodycheck.judging.scheme_runs import differences
from bodycheck.reference.schemes.formulations import FORMULATIONS, world_velocity
from bodycheck.reference.schemes.one_step import SCHEMES
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import Truth
from bodycheck.running.outcome import Completed, Run

#: Time from the start in which rounding errors have hardly grown, so that schemes are distinguished best.
EARLY_S = 2.0

#: Attitude difference, in units of roundoff, up to which two trajectories count as equal in that time.
#: In double precision it is 1e-11 rad.
SAME_ROUNDINGS = 1e-11 * 2.0**53

#: Largest allowed ratio of a scheme's difference to that of every other scheme, for the scheme to be named.
MAX_UNEXPLAINED_FRACTION = 0.01


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


def identify(case: Case, run: Run, truth: Truth, roundoff: float) -> Identification | None:
    """Identify the scheme of a completed run; return None for a case with a plane, where no scheme is compared.

    A scheme is named if its rotation fits, in the first 2 s to within `SAME_ROUNDINGS`, and if the rotation or the position
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
    roundoff
        The unit roundoff of the engine's arithmetic, one of `scheme_rounding.ROUNDOFF`.

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
    allowed = allowance(SCHEMES[order[0]], scene, timestep, trajectory, roundoff)
    fitting = [name for name in order if (turned[name] <= allowed).all()]
    moved = {
        (name, formulation): differences(SCHEMES[name], motion, scene, timestep, trajectory)[1]
        for name in fitting or order[:1]
        for formulation, motion in FORMULATIONS.items()
    }
    nearest, formulation = min(moved, key=lambda pair: float(moved[pair].max()))
    order = [nearest, *(name for name in order if name != nearest)]
    turn, way = turned[nearest], moved[nearest, formulation]

    aside = in_position(allowed, trajectory, timestep, roundoff)
    in_place = bool((way <= aside).all())
    formulations = [moved[nearest, other] for other in FORMULATIONS if other != formulation]
    rotations = [turned[name] for name in order[1:]]
    ways = [other for (name, _), other in moved.items() if name != nearest]
    rotation_tells = tells(turn, [error["attitude_error"] - truth.bounds.error, *rotations], allowed, early)
    position_tells = in_place and tells(way, [error["position_error"] - truth.bounds.position_error, *ways], aside, early)
    named = nearest in fitting and turn[early].max() <= SAME_ROUNDINGS * roundoff and (rotation_tells or position_tells)
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
