"""Identify the textbook scheme that produces an engine's trajectory, and the number of digits to which it agrees.

The reference integrates the exact equations of motion by every scheme that it knows (`reference.schemes.catalogue`), with the
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
from bodycheck.judging.scheme_runs import differences, steps
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import Scene
from bodycheck.reference.schemes.catalogue import CATALOGUE
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth
from bodycheck.running.outcome import Completed, Run

#: Number of steps from the start over which all schemes are compared with a run, and the factor by which it grows for those
#: that remain.
FIRST_STEPS, LONGER = 50, 4

#: Time from the start in which rounding errors have hardly grown, so that schemes are distinguished best.
EARLY_S = 2.0

#: Attitude difference, in units of roundoff, up to which two trajectories count as equal in that time.
#: In double precision it is 1e-11 rad.
SAME_ROUNDINGS = 1e-11 * 2.0**53

#: Difference of two programs at the start, in units of roundoff. A turn by an angle that is found from its cosine has an error
#: of one unit divided by the angle: the first turns of an attitude that is kept as a rotation vector are some milliradians.
START_ROUNDINGS = 1000

#: Largest allowed ratio of a scheme's difference to that of every other scheme, for the scheme to be named, and to the error of
#: the run, for the scheme to be near.
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
    nearest
        The name, or else the closest scheme if it leaves at most a hundredth of the run's error, and of what other schemes
        leave that rounding could explain as well; empty if none is that close.
    early, residual
        The largest attitude difference (rad) from the closest scheme in the first 2 s and in the whole run.
    allowed
        The largest attitude difference (rad) that rounding can cause by the end of the run.
    position_residual
        The largest distance (m) from the closest scheme, in the closer formulation.
    candidates
        All schemes, the closest first. If several fit, and none is closer than all others by a factor of a hundred, it is the
        one with the smallest position_residual. The differences of schemes that are far off at first are those until then.
    """

    scheme: str
    nearest: str
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
    if isinstance(case.scene, Mechanism) or case.scene.plane is not None:
        return None
    scene, timestep, trajectory = case.scene, run.method.timestep, run.outcome.trajectory
    truth = truth.at(trajectory.t)
    error = compare(truth, run).series
    early = trajectory.t <= EARLY_S
    turned, allowed = _turned(scene, timestep, trajectory, roundoff, error["attitude_error"])
    sizes = {name: _sizes(own, early) for name, own in turned.items()}
    order = sorted(turned, key=lambda name: (len(turned[name]) < len(early), *sizes[name]))
    fitting = [name for name in order if len(turned[name]) == len(early) and (turned[name] <= allowed).all()]
    stands_out = all(_is_fraction(sizes[order[0]], sizes[name]) for name in order[1:])
    closest = order[:1] if stands_out or not fitting else fitting
    moved = _moved(fitting or order[:1], scene, timestep, trajectory)
    nearest, words = min((pair for pair in moved if pair[0] in closest), key=lambda pair: float(moved[pair].max()))
    order = [nearest, *(name for name in order if name != nearest)]
    turn, way = turned[nearest], moved[nearest, words]
    aside = in_position(allowed, trajectory, timestep, roundoff)
    in_place = bool((way <= aside).all())
    rotations = [error["attitude_error"] - truth.bounds.error, *(turned[name] for name in order[1:])]
    others = [other for (name, _), other in moved.items() if name != nearest]
    ways = [error["position_error"] - truth.bounds.position_error, *others]
    is_told = tells(turn, rotations, allowed, early) or (in_place and tells(way, ways, aside, early))
    named = nearest in fitting and sizes[nearest][0] <= SAME_ROUNDINGS * roundoff and is_told
    formulations = [other for (name, own), other in moved.items() if name == nearest and own != words]
    told = words if tells(way, formulations, aside, early) else ""
    scheme = nearest + (told if in_place else " in rotation") if named else ""
    is_near = (stands_out or not fitting) and _is_fraction(sizes[nearest], _sizes(error["attitude_error"], early))
    return Identification(
        scheme,
        scheme or (nearest if is_near else ""),
        *sizes[nearest],
        allowed=float(allowed[-1]),
        position_residual=float(way.max()),
        candidates=tuple(Candidate(name, *sizes[name], name in fitting) for name in order),
    )


def _turned(
    scene: Scene, timestep: float, trajectory: Trajectory, roundoff: float, error: Array
) -> tuple[dict[str, Array], Array]:
    """Return the attitude differences (rad) of all schemes from a run, and those (n,) that rounding can cause.

    All schemes are compared with the first steps of the run, and longer and longer those that rounding can explain until then
    or that are not a hundred times as far as the closest one: in the end with all n instants. If even the closest one explains
    nothing of the error (n,) of the run, it goes on alone.
    """
    n, taken = len(trajectory.t), steps(trajectory, timestep)
    first = max(2, int(np.searchsorted(taken, FIRST_STEPS, side="right")))
    turned = _compared(CATALOGUE, scene, timestep, trajectory.part(slice(0, first)))
    closest = min(turned, key=lambda name: float(turned[name].max()))
    allowed = _allowed(closest, scene, timestep, trajectory, roundoff)
    kept, count, explains = list(turned), first, True
    while count < n:
        least = turned[closest].max()
        explains = bool((turned[closest] <= allowed[:count]).all()) or least <= MAX_UNEXPLAINED_FRACTION * error[:count].max()
        limit = least / MAX_UNEXPLAINED_FRACTION if explains else least
        kept = [name for name in kept if turned[name].max() <= limit or (turned[name] <= allowed[:count]).all()]
        count = min(n, max(count + 1, int(np.searchsorted(taken, LONGER * taken[count - 1], side="right"))))
        turned |= _compared(kept, scene, timestep, trajectory.part(slice(0, count)))
        closest = min(kept, key=lambda name: float(turned[name][trajectory.t[:count] <= EARLY_S].max()))
    least = _sizes(turned[closest], trajectory.t <= EARLY_S)[0]
    unclear = [
        name for name, own in turned.items() if len(own) < n and explains and own.max() * MAX_UNEXPLAINED_FRACTION <= least
    ]
    turned |= _compared(unclear, scene, timestep, trajectory)
    return turned, _allowed(closest, scene, timestep, trajectory, roundoff)


def _allowed(name: str, scene: Scene, timestep: float, trajectory: Trajectory, roundoff: float) -> Array:
    """Return the attitude differences (n,), in rad, that rounding can cause between a scheme and a run of it."""
    grown = allowance(CATALOGUE[name].scheme, scene, timestep, trajectory, roundoff, CATALOGUE[name].rotation)
    return np.minimum(START_ROUNDINGS * roundoff + grown, np.pi)


def _moved(names: Iterable[str], scene: Scene, timestep: float, trajectory: Trajectory) -> dict[tuple[str, str], Array]:
    """Return the distances (n,), in m, of schemes from a run in all their formulations."""
    return {
        (name, words): differences(CATALOGUE[name].scheme, motion, scene, timestep, trajectory)[1]
        for name in names
        for words, motion in CATALOGUE[name].formulations.items()
    }


def _compared(names: Iterable[str], scene: Scene, timestep: float, trajectory: Trajectory) -> dict[str, Array]:
    """Return the attitude differences (n,), in rad, of schemes from a run."""
    entries = {name: CATALOGUE[name] for name in names}
    return {name: differences(own.scheme, own.rotation, scene, timestep, trajectory)[0] for name, own in entries.items()}


def _sizes(turned: Array, early: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the largest of some differences (k,) at the first k instants, in the first 2 s and over all."""
    return float(turned[early[: len(turned)]].max()), float(turned.max())


def _is_fraction(own: tuple[float, float], other: tuple[float, float]) -> bool:
    """Return whether differences in the first 2 s or over all are at most a hundredth of others."""
    return any(part < MAX_UNEXPLAINED_FRACTION * whole for part, whole in zip(own, other, strict=True))


def tells(own: Array, others: Iterable[Array], limit: Array, early: NDArray[np.bool_]) -> bool:
    """Return whether a scheme's difference from a run distinguishes it from other candidates.

    It does if every other difference exceeds the limit of rounding at some instant, and is a hundred times as large in the
    first 2 s or in the whole run.

    Parameters
    ----------
    own
        The differences (n,) of the scheme.
    others
        The differences of the other candidates, each at the first of the n instants or at all.
    limit
        The largest differences (n,) that rounding can cause.
    early
        Marks (n,) the instants in the first 2 s.
    """
    return all(
        (other > limit[: len(other)]).any()
        and (
            own[early].max() < MAX_UNEXPLAINED_FRACTION * other[early[: len(other)]].max()
            or own.max() < MAX_UNEXPLAINED_FRACTION * other.max()
        )
        for other in others
    )
