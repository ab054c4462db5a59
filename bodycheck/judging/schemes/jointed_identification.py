"""Identify the textbook scheme in the coordinates of joints that produces an engine's trajectory of a mechanism.

All schemes of `reference.schemes.jointed` are compared with the first steps of a run, and then the schemes that may be the
scheme of the run with more steps. The recursion of a chain is stepped in Python, so that a long chain is compared over fewer
steps. The difference of two trajectories is the largest number, over all bodies, of the angles between attitudes (rad) and the
distances of the centres of mass (m).
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bodycheck.adapters.contract import Strides
from bodycheck.judging.discrepancy import compare
from bodycheck.judging.schemes.identified import (
    EARLY_S,
    MAX_UNEXPLAINED_FRACTION,
    SAME_ROUNDINGS,
    START_ROUNDINGS,
    Candidate,
    Identification,
    is_fraction,
    tells,
)
from bodycheck.judging.schemes.scheme_rounding import STEP_ROUNDINGS
from bodycheck.judging.schemes.scheme_runs import or_infinite, steps
from bodycheck.reference.kinematics import geodesic_angle, normalise
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.tree import forest
from bodycheck.reference.schemes.jointed import JOINTED, has_schemes, states, trajectory
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run

#: The number of steps times links over which all schemes are compared with a run, and over which the schemes that may be its
#: scheme are compared. The recursion takes some tenths of a millisecond per link, and all schemes together evaluate it some
#: hundred times per step.
FIRST, MOST = 50, 400

#: Relative change of the initial state in finite differences; a bound needs only half of the digits.
NUDGE = 1e-7


def identify_jointed(mechanism: Mechanism, run: Run, truth: Truth, roundoff: float) -> Identification | None:
    """Identify the scheme of a completed run of a mechanism.

    A scheme is named by the same rule as for a free body, with the differences of this module. Returns None if there are no
    schemes for the mechanism (`has_schemes`), or if the first sample is so many steps from the start that a comparison would
    take long.

    Parameters
    ----------
    mechanism
        The mechanism.
    run
        A completed run of it.
    truth
        The truth of the mechanism.
    roundoff
        The unit roundoff of the engine's arithmetic, one of `scheme_rounding.ROUNDOFF`.
    """
    assert isinstance(run.outcome, Completed)
    if not has_schemes(mechanism):
        return None
    seen, timestep = run.outcome.trajectory, run.method.timestep
    links, taken = sum(len(tree.links) for tree in forest(mechanism).trees), steps(seen, timestep)
    first, last = (_samples(taken, limit // links) for limit in (FIRST, MOST))
    if taken[1] * links > MOST:
        return None
    names = _distinct(mechanism, timestep, seen.part(slice(0, first)), roundoff)
    apart = {name: _apart(seen.part(slice(0, first)), name, mechanism, timestep) for name in names}
    least = min(float(differences.max()) for differences in apart.values())
    allowed = _allowed(
        min(apart, key=lambda name: float(apart[name].max())), mechanism, timestep, seen.part(slice(0, last)), roundoff
    )
    kept = [
        name
        for name, differences in apart.items()
        if (differences <= allowed[:first]).all() or differences.max() * MAX_UNEXPLAINED_FRACTION <= least
    ]
    apart |= {name: _apart(seen.part(slice(0, last)), name, mechanism, timestep) for name in kept}
    return _judged(apart, allowed, seen.t[:last], _error(truth, run)[:last], roundoff)


def _judged(apart: dict[str, Array], allowed: Array, t: Array, error: Array, roundoff: float) -> Identification:
    """Return the identification that follows from the differences (k,) of schemes at the first k of n instants.

    allowed: the differences (n,) that rounding can cause. error: the smallest possible error (n,) of the run itself.
    """
    early = t <= EARLY_S
    sizes = {name: _sizes(differences, early) for name, differences in apart.items()}
    order = sorted(apart, key=lambda name: (len(apart[name]) < len(t), *sizes[name]))
    fitting = [name for name in order if len(apart[name]) == len(t) and (apart[name] <= allowed).all()]
    nearest = order[0]
    stands_out = all(is_fraction(sizes[nearest], sizes[name]) for name in order[1:])
    is_told = tells(apart[nearest], [error, *(apart[name] for name in order[1:])], allowed, early)
    named = nearest in fitting and sizes[nearest][0] <= SAME_ROUNDINGS * roundoff and is_told
    is_near = (stands_out or not fitting) and is_fraction(sizes[nearest], _sizes(error, early))
    return Identification(
        nearest if named else "",
        nearest if named or is_near else "",
        *sizes[nearest],
        allowed=float(allowed[-1]),
        position_residual=sizes[nearest][1],
        candidates=tuple(Candidate(name, *sizes[name], name in fitting) for name in order),
    )


def _samples(taken: Strides, limit: int) -> int:
    """Return the number of samples within the first `limit` steps, at least two. taken: the step of each sample."""
    return max(2, int(np.searchsorted(taken, limit, side="right")))


def _distinct(mechanism: Mechanism, timestep: float, seen: Trajectory, roundoff: float) -> list[str]:
    """Return the names of the schemes, without schemes that equal an earlier scheme on this mechanism.

    Semi-implicit schemes are equal if the terms in which they differ, taken at the end of the step, do not act. Schemes that
    average rates equal others on a mechanism without a ball.
    """
    has_ball = any(link.kind == "ball" for tree in forest(mechanism).trees for link in tree.links)
    explicit = [name for name in JOINTED if "implicit" not in name and (has_ball or not name.startswith("averaged"))]
    same = SAME_ROUNDINGS * roundoff
    implicit: list[str] = []
    for name in JOINTED:
        others = (_apart(_run(known, mechanism, timestep, seen), name, mechanism, timestep) for known in implicit)
        if "implicit" in name and all(float(other.max()) > same for other in others):
            implicit.append(name)
    return [*implicit, *explicit]


def _run(name: str, mechanism: Mechanism, timestep: float, seen: Trajectory, nudge: float = 0.0) -> Trajectory:
    """Return the trajectory of a scheme at the instants of another run."""
    return sampled(name, mechanism, timestep, tuple(steps(seen, timestep).tolist()), nudge)


# The methods of all engines are compared with the same schemes at the same time steps and instants.
@lru_cache(maxsize=4 * len(JOINTED))
def sampled(name: str, mechanism: Mechanism, timestep: float, ends: tuple[int, ...], nudge: float = 0.0) -> Trajectory:
    """Return the states of the bodies (b, n, ...) of a scheme after the numbers of steps `ends` (n,)."""
    strides = np.diff(ends, prepend=0)
    rows = [states(JOINTED[name], tree, timestep, strides, nudge) for tree in forest(mechanism).trees]
    return trajectory(mechanism, rows, np.array(ends) * timestep)


def _apart(seen: Trajectory, name: str, mechanism: Mechanism, timestep: float) -> Array:
    """Return the differences (n,) of a scheme from a run."""
    return _between(seen, _run(name, mechanism, timestep, seen))


def _between(one: Trajectory, other: Trajectory) -> Array:
    """Return the differences (n,) of two trajectories."""
    turned = geodesic_angle(normalise(one.quaternion), normalise(other.quaternion))
    moved = np.linalg.norm(one.position - other.position, axis=-1)
    return or_infinite(np.maximum(turned, moved).max(axis=0))


def _allowed(name: str, mechanism: Mechanism, timestep: float, seen: Trajectory, roundoff: float) -> Array:
    """Return the differences (n,) that rounding can cause between two programs of a scheme.

    Each step changes every number of the state by some units of roundoff, relative to one and its own size, as at the start.
    The growth of such a change is measured in a run with a slightly changed initial state.
    """
    grown = _between(_run(name, mechanism, timestep, seen, NUDGE), _run(name, mechanism, timestep, seen)) / NUDGE
    most = np.maximum.accumulate(np.maximum(grown, 1.0))
    return np.asarray((START_ROUNDINGS + STEP_ROUNDINGS * steps(seen, timestep)) * roundoff * most)


def _error(truth: Truth, run: Run) -> Array:
    """Return the smallest possible error (n,) of a run at its instants, as a difference of this module."""
    assert isinstance(run.outcome, Completed)
    there = truth.at(run.outcome.trajectory.t)
    series, bounds = compare(there, run).series, there.bounds
    return np.asarray(np.maximum(series["attitude_error"] - bounds.error, series["position_error"] - bounds.position_error))


def _sizes(apart: Array, early: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the largest of some differences (k,) at the first k instants, in the first 2 s and over all."""
    return float(apart[early[: len(apart)]].max()), float(apart.max())
