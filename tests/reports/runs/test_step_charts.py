"""The chart of errors over the time step: every error at its step, and none that means nothing."""

import re

import numpy as np
import vl_convert

from bodycheck.adapters.contract import Method
from bodycheck.judging.discrepancy import Discrepancy
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.runs.charts.step_charts import over_steps
from bodycheck.results.outcome import Completed, Diverged, Run
from tests.support.wording import facts

CASE = "intermediate-axis-flip"
OWN = 1e-14


def ran(integrator: str, timestep: float, error: float) -> Verdict:
    series = {name: np.array([0.0, value]) for name, value in (("attitude_error", error), ("truth_error", OWN))}
    outcome = Completed(None, 10, 1e-4)  # type: ignore[arg-type]  # nobody asks for the trajectory
    run = Run(CASE, "mujoco", "1", Method.parse(integrator, timestep), outcome)
    return Verdict(run, outcome, Discrepancy(np.array([0.0, 1.0]), series, {}).summary(), None, "")


def diverged(integrator: str, timestep: float) -> Verdict:
    outcome = Diverged("not a number")
    return Verdict(Run(CASE, "mujoco", "1", Method.parse(integrator, timestep), outcome), outcome, None, None, "not a number")


def test_every_error_with_a_meaning_is_drawn_at_its_step() -> None:
    """Not those of runs that diverged, within the truth's own error or infinite, nor a method with one step alone."""
    euler = {0.004: 4e-2, 0.002: 2e-2, 0.001: 1e-2}
    verdicts = [ran("Euler", step, error) for step, error in euler.items()]
    verdicts += [ran("RK4", 0.004, 1e-9), ran("RK4", 0.002, OWN / 2), ran("RK4", 0.001, OWN / 2)]
    verdicts += [ran("implicit", 0.004, np.inf), ran("implicit", 0.002, 1e-3), diverged("implicit", 0.001)]
    (chart,) = over_steps(verdicts).charts
    assert "for 1 method" in chart.alt
    assert facts(chart.alt, "mujoco Euler")[-3:] == ["mujoco Euler", "0.04", "0.01"]
    (layer,) = chart.specification["layer"]
    drawn = {row["step"] / 1e3: row["error"] for row in layer["data"]["values"] if row["method"] == "mujoco Euler"}
    assert drawn == euler
    assert len(layer["data"]["values"]) == len(euler)
    svg = vl_convert.vegalite_to_svg(chart.specification)
    (line,) = re.findall(r'<g class="mark-line role-mark [^"]*"[^>]*>(.*?)</g>', svg)
    assert line.count("<path") == 1
    assert "NaN" not in svg


def test_one_time_step_has_no_chart() -> None:
    assert over_steps([ran("Euler", 0.002, 2e-2), ran("RK4", 0.002, 1e-6)]).charts == ()
