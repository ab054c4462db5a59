"""Estimate errors of MuJoCo on shipped cases without their truths, and compare the intervals with the true errors.

For cases with smooth motion the true error of a run is its distance from the truth. For cases with dry friction or contact, of
which the engine has a limit of its own, it is the distance from a run of the same method with a time step at least 64 times
smaller, and the distance of the engine's limit from rigid mechanics is printed apart. For chaotic cases, the instant from which
on the verdict says "chaotic" is compared with the one at which one rounding, times the growth of an error along the truth,
exceeds the allowed error. The methods are those without options.

The exit status is 1 if an interval does not contain its error, no method has an estimate with the present time step, or an
instant is off by more than 30 % and by more than two Lyapunov times.

Run: python benchmarks/hidden_truth.py [CASE]...
"""

import argparse
import math
import sys
from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

import bodycheck
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.offers import offered
from bodycheck.casefile.content import Case
from bodycheck.figures.columns import FIGURES
from bodycheck.reference.truth import truth
from bodycheck.reports.quantities import number
from bodycheck.running.refining import Motion, RunCase, run_case
from bodycheck.studies.estimate import wording
from bodycheck.studies.estimate.distances import differences
from bodycheck.studies.estimate.levels import Steps, instants_of, own_steps
from bodycheck.studies.estimate.quantities import AT_END
from bodycheck.studies.estimate.rows import CHAOTIC, DIVERGED, ESTIMATE, RESET, EstimateRow

ENGINE = "mujoco"

#: The cases whose intervals must contain the distance from the truth, and those for the distance from the engine's own limit.
WITH_TRUTH = ("intermediate-axis-flip", "chain-5", "cart-pole", "chain-in-space")
WITH_LIMIT = ("sliding-brick", "hinge-friction", "rolling-ball")

#: The chaotic cases with the durations (s) of their runs.
CHAOS = {"double-pendulum": 30.0, "chain-in-space": 15.0}

#: The ratio of the time step of a run to that of the run that stands for the limit, and the smallest part of the present time
#: step whose errors are compared with it, since a run with a step 64 times smaller would take too long for others.
FINER_BY, SMALLEST = 64, 1 / 16

#: One rounding, the allowed error (rad), and the deviation of an instant that is allowed: a part of it, or Lyapunov times.
ROUNDING, ERROR, PART, LYAPUNOV_TIMES = 1.1e-16, 1e-3, 0.3, 2.0

HEAD = "| case | method | intervals | contain the error | largest error in terms of its estimate | runs without an estimate |"
HEAD_OF_CHAOS = "| case | duration, s | method | verdict | by the truth, s | Lyapunov time, s |"


@dataclass(frozen=True)
class Known:
    """The true error of a run and its bound."""

    error: float
    bound: float


def by_truth(case: Case, rows: list[EstimateRow]) -> dict[EstimateRow, Known]:
    """Return the distances of runs from the truth, with the bounds of the truth."""
    instants = {row.timestep: instants_of(own_steps(case.instants, row.timestep), row.timestep) for row in rows}
    exact = truth(case.scene, np.unique(np.concatenate(list(instants.values()))), vouched=False)
    known = {}
    for method, timestep in dict.fromkeys((row.integrator, row.timestep) for row in rows):
        run = bodycheck.simulate(case, engine=ENGINE, integrator=method, timestep=timestep)
        series = bodycheck.compare(exact.at(instants[timestep]), run).series
        for row in (row for row in rows if (row.integrator, row.timestep) == (method, timestep)):
            name = row.quantity.removesuffix(AT_END)
            bound = series.get(FIGURES[name].bounded_by, np.zeros(1))
            error = series[name][-1] if row.quantity.endswith(AT_END) else np.nanmax(series[name])
            known[row] = Known(float(error), float(np.nanmax(bound)))
    return known


def by_limit(case: Case, rows: list[EstimateRow], present: float) -> dict[EstimateRow, Known]:
    """Return the distances of runs from those with a time step 64 times smaller, with the errors of these at first order.

    present: the present time step (s). The finer runs have a step that is at least 64 times smaller than this one too.
    """
    known = {}
    for method, timestep in dict.fromkeys((row.integrator, row.timestep) for row in rows):
        steps = own_steps(case.instants, timestep)
        coarse = _motion(case, method, timestep, steps)
        ratio = FINER_BY * 2 ** max(0, math.ceil(math.log2(timestep / present) - 1e-9))
        fine = _motion(case, method, timestep / ratio, steps * ratio)
        assert fine.trajectory is not None
        series = differences(case.scene, coarse, replace(fine, t=coarse.t, trajectory=replace(fine.trajectory, t=coarse.t)))
        for row in (row for row in rows if (row.integrator, row.timestep) == (method, timestep)):
            values = series[row.quantity.removesuffix(AT_END)]
            largest = float(np.nanmax(values))
            known[row] = Known(float(values[-1]) if row.quantity.endswith(AT_END) else largest, largest / (FINER_BY - 1))
    return known


def _motion(case: Case, method: str, timestep: float, steps: Steps) -> Motion:
    """Return a run that is sampled after numbers of steps (n,) of a size (s)."""
    made = run_case(RunCase(ENGINE, case, Method.parse(method, 0.0).at(timestep), instants_of(steps, timestep), False))
    assert isinstance(made, Motion)
    return made


def covered(name: str) -> tuple[list[str], bool]:
    """Return the lines of the table of intervals, one for each method, and whether all is as it must be."""
    case, limited = bodycheck.load(name), name in WITH_LIMIT
    results = bodycheck.estimate(case, engine=ENGINE, integrator=methods(case), blind=not limited)
    present = results.estimates.present[ENGINE][1]
    rows = [row for row in results.rows if not limited or row.timestep >= SMALLEST * present * (1 - 1e-9)]
    counted = [row for row in rows if row.verdict == ESTIMATE]
    known = by_limit(case, counted, present) if limited else by_truth(case, counted)
    lines, missed, complete = [], 0, False
    for method in dict.fromkeys(row.integrator for row in rows):
        of_method = [row for row in rows if row.integrator == method]
        estimates = [row for row in of_method if row.verdict == ESTIMATE]
        outside = [row for row in estimates if not contains(row, known[row])]
        for row in outside:
            interval = f"{row.low:.4g} to {row.high:.4g}, {row.reason}"
            told = f"{row.quantity} {known[row].error:.4g} ± {known[row].bound:.1g}, and not {interval}"
            print(f"{name}: {method} at {row.timestep:.6g} s has {told}", file=sys.stderr)
        words = Counter(row.verdict for row in of_method if row.verdict != ESTIMATE)
        others = ", ".join(f"{count} {word}" for word, count in words.items())
        ratio = max((known[row].error / row.estimate for row in estimates if row.estimate and row.low), default=None)
        cells = (name, method, str(len(estimates)), str(len(estimates) - len(outside)), number(ratio, 3), others)
        lines.append(f"| {' | '.join(cells)} |")
        missed += len(outside)
        complete |= {row.verdict for row in of_method if row.timestep == present} == {ESTIMATE}
    return [*lines, *wording.apart(results.estimates, ENGINE)], complete and not missed


def methods(case: Case) -> list[str]:
    """Return the methods without options of the engine for a case."""
    return [name for name in offered(registry.load(ENGINE).engine, case.scene) if ":" not in name]


def contains(row: EstimateRow, known: Known) -> bool:
    """Return whether an interval contains an error, within its bound."""
    assert row.low is not None
    assert row.high is not None
    return row.low - known.bound <= known.error <= row.high + known.bound


def chaotic(name: str, duration: float) -> tuple[list[str], bool]:
    """Return the lines of the table of chaotic cases, one for each method, and whether their instants are those of the truth.

    A method whose runs are too far from the truth, and from each other, may have no estimate instead.
    """
    short = bodycheck.load(name)
    case = replace(short, duration=duration, samples=round((short.samples - 1) * duration / short.duration) + 1)
    growth = truth(case.scene, case.instants, vouched=False).growth
    assert growth is not None
    first = int(np.argmax(ROUNDING * growth > ERROR))
    expected = float(case.instants[first])
    lyapunov = expected / float(np.log(growth[first] / growth[0]))
    allowed = max(PART * expected, LYAPUNOV_TIMES * lyapunov)
    results = bodycheck.estimate(
        name, engine=ENGINE, integrator=methods(case), duration=duration, quantity="attitude", blind=True, error=ERROR
    )
    lines, instants, right = [], [], True
    for method in dict.fromkeys(row.integrator for row in results.rows):
        words = {row.verdict for row in results.rows if row.integrator == method and row.verdict not in (DIVERGED, RESET)}
        instants += [float(word.removeprefix(CHAOTIC)) for word in words if word.startswith(CHAOTIC)]
        right &= len(words) == 1 and ESTIMATE not in words
        cells = (name, number(duration), method, ", ".join(sorted(words)), number(expected, 3), number(lyapunov, 2))
        lines.append(f"| {' | '.join(cells)} |")
    return lines, right and bool(instants) and all(abs(one - expected) <= allowed for one in instants)


def main() -> int:
    """Print the tables, and return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", choices=[*WITH_TRUTH, *WITH_LIMIT, *CHAOS, []])
    names = parser.parse_args().cases
    right = True
    print(HEAD, "| --- | --- | ---: | ---: | ---: | --- |", sep="\n", flush=True)
    for name in (name for name in (*WITH_TRUTH, *WITH_LIMIT) if name in (names or (name,))):
        lines, is_right = covered(name)
        right &= is_right
        print(*lines, sep="\n", flush=True)
    print("", HEAD_OF_CHAOS, "| --- | ---: | --- | --- | ---: | ---: |", sep="\n", flush=True)
    for name, duration in CHAOS.items():
        if name in (names or (name,)):
            lines, is_right = chaotic(name, duration)
            right &= is_right
            print(*lines, sep="\n", flush=True)
    return int(not right)


if __name__ == "__main__":
    sys.exit(main())
