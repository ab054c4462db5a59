"""Runs with figures of a test's choosing, and the matrices of them."""

from collections.abc import Collection
from dataclasses import replace
from typing import Any

import numpy as np

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.judging.discrepancy import Discrepancy
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.lines import assign
from bodycheck.reports.runs.kinds import kind_of
from bodycheck.reports.runs.matrix import Matrix, matrices
from bodycheck.reports.same_algorithm import NO_CLASSES, Classes
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Run, Unsupported

FLIP, FLIGHT, DRAG, SLIDE = "intermediate-axis-flip", "projectile", "football-drag", "sliding-brick"
ERRORS = {"attitude_error": 3e-4, "position_error": 2e-2, "truth_error": 1e-14}


def ran(
    case: str, engine: str = "mujoco", integrator: str = "Euler", timestep: float = 0.002, label: str = "", **figures: float
) -> Verdict:
    """A completed run of the set of results with a label, its errors growing to these figures."""
    series = {name: np.array([0.0, value]) for name, value in (ERRORS | figures).items()}
    outcome = Completed(None, 10, 1e-4)  # type: ignore[arg-type]  # nobody asks for the trajectory
    run = Run(case, engine, "1", Method.parse(integrator, timestep), outcome)
    discrepancy = Discrepancy(np.array([0.0, 1.0]), series, {}).summary()
    return Verdict(run, outcome, discrepancy, None, "", label=label, kind=kind_of(load(case).scene).name)


def ended(verdict: Verdict, passed: bool | None, reason: str = "", **values: Any) -> Verdict:
    """A run that was judged."""
    return replace(verdict, passed=passed, reason=reason, **values)


def matrices_of(
    *verdicts: Verdict, demonstrations: Collection[RunKey] = (), classes: Classes = NO_CLASSES
) -> tuple[Matrix, ...]:
    """The matrices of runs of shipped cases."""
    cases = {name: load(name) for name in dict.fromkeys(verdict.run.case for verdict in verdicts)}
    anchors = {verdict.key: f"run-{place}" for place, verdict in enumerate(verdicts)}
    lines = assign(verdict.key.over_cases for verdict in verdicts)
    return matrices(cases, verdicts, lines, anchors, dict.fromkeys(cases, ()), demonstrations, classes)


def refused(case: str, engine: str, reason: str, integrator: str = "Euler") -> Verdict:
    """A run that an engine does not support."""
    made, outcome = ran(case, engine, integrator), Unsupported(reason)
    return replace(made, run=replace(made.run, outcome=outcome), outcome=outcome, discrepancy=None, reason=reason)
