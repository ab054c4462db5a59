"""Identify the textbook scheme that produces an engine's trajectory, and the number of digits to which it agrees.

The reference integrates the exact equations of motion by every scheme that it knows (`reference.schemes.catalogue`), with the
engine's time step (`scheme_runs`). Two programs of the same scheme differ only by rounding, which has a bound
(`scheme_rounding`).
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile.content import Case
from bodycheck.judging.discrepancy import compare
from bodycheck.judging.schemes.identified import (
    EARLY_S,
    MAX_UNEXPLAINED_FRACTION,
    START_ROUNDINGS,
    Candidate,
    is_fraction,
    tells,
)
from bodycheck.judging.schemes.identified import SAME_ROUNDINGS as SAME_ROUNDINGS
from bodycheck.judging.schemes.identified import Identification as Identification
from bodycheck.judging.schemes.jointed_identification import identify_jointed
from bodycheck.judging.schemes.scheme_rounding import allowance, in_position
from bodycheck.judging.schemes.scheme_runs import differences, steps
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.scene import Scene
from bodycheck.reference.schemes.catalogue import CATALOGUE
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run

#: The number of steps from the start over which all schemes are compared with a run, and the factor by which it grows for the
#: remaining schemes.
FIRST_STEPS, LONGER = 50, 4


def identify(case: Case, run: Run, truth: Truth, roundoff: float) -> Identification | None:
    """Identify the scheme of a completed run; return None for a case with a plane, for which there are no schemes.

    The scheme of a mechanism is a scheme in the coordinates of its joints; see `jointed_identification`.

    A scheme is named if its rotation fits, in the first 2 s to within `SAME_ROUNDINGS`, and if the rotation or the position
    distinguishes it from every other scheme and from the truth (see `tells`). In a spin about a fixed axis the rotations of all
    schemes fit, and with very small time steps the rotation of the truth fits too.

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
    if touches(case.scene) or run.method.accuracy is not None:  # no schemes with steps of one size
        return None
    if isinstance(case.scene, Mechanism):
        return identify_jointed(case.scene, run, truth, roundoff)
    return None if case.scene.plane is not None else _identify_flight(case.scene, run, run.outcome.trajectory, truth, roundoff)


def _identify_flight(scene: Scene, run: Run, trajectory: Trajectory, truth: Truth, roundoff: float) -> Identification:
    """Identify the scheme of a free body, from the trajectory of a run. For the other parameters see `identify`."""
    timestep, truth = run.method.timestep, truth.at(trajectory.t)
    error = compare(truth, run).series
    early = trajectory.t <= EARLY_S
    turned, allowed = _turned(scene, timestep, trajectory, roundoff, error["attitude_error"])
    sizes = {name: _sizes(formulation, early) for name, formulation in turned.items()}
    order = sorted(turned, key=lambda name: (len(turned[name]) < len(early), *sizes[name]))
    fitting = [name for name in order if len(turned[name]) == len(early) and (turned[name] <= allowed).all()]
    stands_out = all(is_fraction(sizes[order[0]], sizes[name]) for name in order[1:])
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
    formulations = [other for (name, formulation), other in moved.items() if name == nearest and formulation != words]
    suffix = words if tells(way, formulations, aside, early) else ""
    scheme = nearest + (suffix if in_place else " in rotation") if named else ""
    is_near = (stands_out or not fitting) and is_fraction(sizes[nearest], _sizes(error["attitude_error"], early))
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
    """Return the attitude differences (rad) of all schemes from a run, and the differences (n,) that rounding can cause.

    All schemes are compared with the first steps of the run. Then the comparison is extended, up to all n instants, for the
    schemes whose differences rounding can explain so far, or are less than a hundred times as large as the smallest. If even
    the closest scheme explains nothing of the error (n,) of the run, only that scheme is compared further.
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
        name
        for name, differences in turned.items()
        if len(differences) < n and explains and differences.max() * MAX_UNEXPLAINED_FRACTION <= least
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
    return {name: differences(entry.scheme, entry.rotation, scene, timestep, trajectory)[0] for name, entry in entries.items()}


def _sizes(turned: Array, early: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the largest of some differences (k,) at the first k instants, in the first 2 s and over all."""
    return float(turned[early[: len(turned)]].max()), float(turned.max())
