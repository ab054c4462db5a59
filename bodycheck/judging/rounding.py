"""What rounding alone may do to the figures of a run: by so much may two machines differ that run the same versions.

Processors and libraries of mathematics round differently. In a run of n steps every number is rounded n times and more, by the
relative size u = 2^-53 (2^-24 in single precision): by chance this adds up to sqrt(n) u, and where all goes one way, to n u.
What the motion makes of it, in ten seconds of a flip thousands of times as much, is measured: the run is made again from
initial states that were nudged by sqrt(n) u, and what this moves a figure by is its spread. That serves contacts and solvers
that iterate as well as free flight.

A figure that is the difference of two numbers of size S is allowed `MARGIN` (spread + n u S), and the truth's own error.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from bodycheck.casefile.case import Case
from bodycheck.figures.columns import FIGURES, truth_bounds
from bodycheck.figures.scales import in_run, largest
from bodycheck.judging.discrepancy import compare
from bodycheck.reference.kinematics import multiply, normalise
from bodycheck.reference.scene import State, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import Truth
from bodycheck.running.outcome import Completed, Run

#: Runs from nudged initial states.
NUDGES = 4

#: A step rounds a number several times, and four nudges are few.
#:
#: With it, what the engines' builds for x86-64 and aarch64 differ by is at most half of what is allowed, over all shipped
#: cases.
MARGIN = 8.0


def nudged(case: Case, run: Run, seed: int) -> Case:
    """The case with its initial state moved in random directions by as much as rounding may come to in a run of it.

    Each part of the state is moved relative to its largest size in the run. On a plane the body stays flat.
    """
    assert isinstance(run.outcome, Completed)
    random = np.random.default_rng(seed)
    trajectory, initial = run.outcome.trajectory, case.scene.initial
    amount = _unit_of_rounding(trajectory) * math.sqrt(run.outcome.steps)
    within, about = (slice(0, 3), slice(0, 3)) if case.scene.plane is None else (slice(0, 2), slice(2, 3))

    def step(part: slice, size: float) -> Array:
        direction = np.zeros(3)
        direction[part] = random.normal(size=part.stop - part.start)
        return amount * size * direction / np.linalg.norm(direction)

    turn = multiply(np.concatenate([[1.0], step(about, 0.5)]), np.array(initial.quaternion))
    w, x, y, z = normalise(turn).tolist()
    state = State(
        _vector(np.array(initial.position) + step(within, largest(trajectory.position))),
        (w, x, y, z),
        _vector(np.array(initial.velocity) + step(within, largest(trajectory.velocity))),
        _vector(np.array(initial.angular_velocity) + step(about, largest(trajectory.angular_velocity))),
    )
    return replace(case, scene=replace(case.scene, initial=state), expectations=())


def allowances(truth: Truth, run: Run, others: Sequence[Run]) -> dict[str, float]:
    """How far each figure of a completed run may be from what other machines give, by its column.

    others: the runs from nudged initial states, of which figures that are not there are infinitely far away.
    """
    moved = [compare(truth, other).maxima() if isinstance(other.outcome, Completed) else {} for other in others]
    figures = compare(truth, run).maxima()
    found = {}
    for name, least in unamplified(truth, run, figures).items():
        spread = max((abs(other.get(name, math.inf) - figures[name]) for other in moved), default=math.inf)
        found[name] = MARGIN * spread + least
    return found


def unamplified(truth: Truth, run: Run, names: Iterable[str]) -> dict[str, float]:
    """The least that is allowed figures of a completed run, by column: what it is where the motion amplifies no rounding."""
    assert isinstance(run.outcome, Completed)
    trajectory = run.outcome.trajectory
    all_one_way = run.outcome.steps * _unit_of_rounding(trajectory)
    bounds, scales = truth_bounds(truth), in_run(truth, trajectory)
    found = {}
    for name in names:
        bound = float(bounds[name].max()) if name in bounds else 0.0
        found[name] = MARGIN * all_one_way * FIGURES[name].scale(scales) + bound
    return found


def _unit_of_rounding(trajectory: Trajectory) -> float:
    """Of the arithmetic in which an engine seems to keep its states."""
    states = np.hstack([trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity])
    with np.errstate(over="ignore"):
        single = np.array_equal(states.astype(np.float32), states)
    return 2.0**-24 if single else 2.0**-53


def _vector(values: Array) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
