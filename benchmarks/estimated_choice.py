"""Compare the method and the time step that are recommended without the truth of a case with those by its truth.

`bodycheck.recommend` searches them by the truth, and `bodycheck.estimate` with the truth hidden, in MuJoCo, for shipped cases
whose duration is cut to 1 s. Both answer the same question: the cheapest of two methods that keeps an error, and its largest
time step. The table has for each case

- both answers, and the cost of the one by estimate in terms of that by truth, with the cost of a step of each method from the
  estimate for both;
- the ratio of the step by estimate to that by truth, for the method by truth, and the least ratio that is expected:
  0.9 f^(-1/p), where f is the upper end of the interval over the estimate, and p is the order;
- the true error of the answer by estimate in terms of the allowed error.

The exit status is 1 if the methods differ and the cost by more than 20 %, a ratio of steps is above 1.05 or below the least
one, more than one of the true errors exceeds the allowed one, or one does by more than 25 %.

Run: python benchmarks/estimated_choice.py [CASE]...
"""

import argparse
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import bodycheck
from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.files.temporary import temporary_folder
from bodycheck.reports.quantities import milliseconds, number
from bodycheck.studies.estimate.rows import Choice, Estimates, choices

#: The cases, and the figure and the error (rad or m) by which they are judged.
CASES = {
    "free-brick": ("attitude_error", 1e-4),
    "intermediate-axis-flip": ("attitude_error", 1e-5),
    "football-wobble": ("attitude_error", 1e-4),
    "universal-pendulum": ("attitude_error", 1e-4),
    "short-axis-spin": ("attitude_error", 1e-6),
    "mujoco-free-body": ("attitude_error", 1e-6),
    "osrf-boxes-complex": ("attitude_error", 1e-6),
    "heavy-top": ("attitude_error", 1e-4),
    "lagrange-top": ("attitude_error", 1e-3),
    "gyroscope": ("attitude_error", 1e-3),
    "pendulum-large": ("attitude_error", 1e-5),
    "pendulum-small": ("attitude_error", 1e-7),
    "spherical-pendulum": ("attitude_error", 1e-5),
    "double-pendulum": ("attitude_error", 1e-3),
    "chain-3": ("attitude_error", 1e-3),
    "cart-pole": ("attitude_error", 1e-4),
    "hinge-spring": ("attitude_error", 1e-4),
    "oscillator-underdamped": ("position_error", 1e-8),
    "slider-damping": ("position_error", 1e-8),
    "dumbbell": ("attitude_error", 1e-6),
}

ENGINE, METHODS = "mujoco", ("Euler", "RK4")

#: The longest duration (s).
DURATION = 1.0

#: The ratio of costs and the ratio of steps that are allowed, the part of the expected step, and the excess of the true error.
COST, STEP, LEAST, EXCESS = 1.2, 1.05, 0.9, 1.25

HEAD = (
    "| case | allowed | by truth | by estimate | cost | step | least | true error |\n"
    "| --- | ---: | --- | --- | ---: | ---: | ---: | ---: |"
)


@dataclass(frozen=True)
class Compared:
    """Both answers for a case, and their ratios as the table has them."""

    case: str
    allowed: float
    truth: Choice
    estimate: Choice
    cost: float
    step: float
    least: float
    error: float

    @property
    def right(self) -> bool:
        """Whether the answers agree."""
        agree = self.truth.integrator == self.estimate.integrator or self.cost <= COST
        return agree and self.least <= self.step <= STEP and self.error <= EXCESS

    @property
    def line(self) -> str:
        """The line of the table."""
        answers = (f"{one.integrator}, {milliseconds(one.timestep, 4)}" for one in (self.truth, self.estimate))
        ratios = (number(value, 3) for value in (self.cost, self.step, self.least, self.error))
        return f"| {' | '.join((self.case, number(self.allowed), *answers, *ratios))} |"


def compared(name: str, folder: Path) -> Compared:
    """Return both answers for a case. folder: a folder for its file."""
    quantity, allowed = CASES[name]
    case = shortened(name, folder)
    estimates = bodycheck.estimate(
        case, engine=ENGINE, integrator=METHODS, quantity=quantity, error=allowed, blind=True
    ).estimates
    by_estimate = choices(estimates)
    per_step = {one.integrator: one.cost * one.timestep for one in by_estimate}
    by_truth = bodycheck.recommend(case, error=allowed, quantity=quantity, engine=ENGINE, integrator=METHODS).found
    largest: dict[str, float] = {}
    for method in METHODS:
        for probe in sorted((one for one in by_truth.probes if one.integrator == method), key=lambda one: one.timestep):
            if probe.error is None or probe.error > allowed:
                break
            largest[method] = probe.timestep
    errors = {one.integrator: true_error(case, one, quantity) for one in by_estimate}
    for one in by_estimate:  # a step that recommend has not measured, between the last that it has and the first that fails
        if errors[one.integrator] <= allowed:
            largest[one.integrator] = max(one.timestep, largest.get(one.integrator, 0.0))
    truths = [Choice(ENGINE, method, step, 0.0, per_step[method] / step) for method, step in largest.items()]
    truth, best = min(truths, key=lambda one: one.cost), by_estimate[0]
    same = next(one for one in by_estimate if one.integrator == truth.integrator)
    return Compared(
        *(name, allowed, truth, best),
        cost=best.cost / truth.cost,
        step=same.timestep / truth.timestep,
        least=LEAST * expected(estimates, same, quantity),
        error=errors[best.integrator] / allowed,
    )


def shortened(name: str, folder: Path) -> Case:
    """Return a shipped case with a duration of at most 1 s, from a case file in a folder."""
    case = bodycheck.load(name)
    if case.duration <= DURATION:
        return case
    samples = max(2, round((case.samples - 1) * DURATION / case.duration) + 1)
    text = re.sub(r"(?m)^duration = .*$", f"duration = {DURATION}", case.text)
    path = folder / f"{name}.case.toml"
    path.write_text(re.sub(r"(?m)^samples = .*$", f"samples = {samples}", text), "utf-8")
    return bodycheck.load(path)


def true_error(case: Case, choice: Choice, quantity: str) -> float:
    """Return the distance from the truth of the run with the method and the time step of an answer."""
    method = Method.parse(choice.integrator, choice.timestep)
    run = bodycheck.simulate(case, engine=ENGINE, integrator=method.name, timestep=choice.timestep)
    return bodycheck.compare(bodycheck.truth(case), run).maxima()[quantity]


def expected(estimates: Estimates, choice: Choice, quantity: str) -> float:
    """Return f^(-1/p): the part of the largest step by truth that an interval of this width leaves."""
    (row,) = (
        row
        for row in estimates.rows
        if (row.integrator, row.timestep, row.quantity) == (choice.integrator, choice.timestep, quantity)
    )
    assert row.high is not None
    assert row.estimate
    assert row.order
    return (row.high / row.estimate) ** (-1 / row.order)


def main() -> int:
    """Print the table, and return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", choices=[*CASES, []])
    names = parser.parse_args().cases or list(CASES)
    print(HEAD, flush=True)
    done = []
    with temporary_folder() as folder:
        for name in names:
            done.append(compared(name, folder))
            print(done[-1].line, flush=True)
    agreeing = sum(one.truth.integrator == one.estimate.integrator or one.cost <= COST for one in done)
    above = [one for one in done if one.error > 1]
    print(f"\n{agreeing} of {len(done)} agree in method or cost; the true error of {len(above)} exceeds the allowed one.")
    return int(len(above) > 1 or not all(one.right for one in done))


if __name__ == "__main__":
    sys.exit(main())
