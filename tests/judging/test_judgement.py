"""Judgements: runs held against what their cases expect of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bodycheck import Case, compare, load, simulate, truth
from bodycheck.adapters.method import Method
from bodycheck.casefile.case import parse
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.judging import judgement
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.scene import Plane
from bodycheck.reference.truths import NoTruth
from bodycheck.results import store
from bodycheck.running import campaign
from bodycheck.running.plan import plan
from tests.support import campaigns
from tests.support.campaigns import records
from tests.support.cases import shortened


def expecting(case: Case, **limits: float) -> Case:
    return replace(
        case,
        expectations=(
            Expectation("mujoco", Method.parse("RK4", 0.1), tuple(Limit(name, None, limit) for name, limit in limits.items())),
        ),
    )


def judged(case: Case, integrator: str = "RK4") -> judgement.Verdict:
    return judgement.verdict(case, truth(case, np.arange(11) * 0.1), simulate(case, "mujoco", integrator, 0.1))


def test_expectations_are_judged_by_the_largest_value() -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    measured = compare(truth(case), simulate(case, "mujoco", "RK4", 0.1)).maxima()["attitude_error"]
    assert judged(expecting(case, attitude_error=measured)).passed is True
    failed = judged(expecting(case, attitude_error=measured * 0.999, energy_error=1.0))
    assert failed.passed is False
    assert f"attitude_error is {measured:.4g} rad, expected at most" in failed.reason
    assert "energy_error is unknown, expected at most 1; it is not measured in this scene" in failed.reason
    assert judged(expecting(case, attitude_error=measured), "Euler").passed is None


@pytest.mark.parametrize(("expected", "passed"), [(4, True), (2, False)])
def test_an_order_is_expected_of_a_step_its_half_and_its_quarter(tmp_path: Path, expected: float, passed: bool) -> None:
    expectation = f'[[expect]]\nengine = "mujoco"\nintegrator = "RK4"\ntimestep = 0.02\norder = {expected}\n'
    case = parse(load("osrf-boxes-complex").text.partition("[[expect]]")[0] + expectation, "ordered")
    verdicts = judgement.judge(campaigns.results(plan([case], records("mujoco"), (), ()), tmp_path))
    asked = {verdict.run.method.timestep: verdict for verdict in verdicts if verdict.run.method.name == "RK4"}
    assert asked.keys() == {0.002, 0.02, 0.01, 0.005}
    assert {step: verdict.passed for step, verdict in asked.items()} == {0.002: None, 0.02: passed, 0.01: None, 0.005: None}
    assert passed or "order is 4" in asked[0.02].reason
    alone = judgement.verdict(case, truth(case, asked[0.02].run.outcome.trajectory.t), asked[0.02].run)
    assert (alone.passed, "finer steps are not there" in alone.reason) == (False, True)


def test_an_expectation_of_a_run_that_is_not_ok_fails() -> None:
    case = expecting(shortened(load("free-brick"), 1.0, 11), attitude_error=1.0)
    unmodelled = replace(case, scene=replace(case.scene, plane=Plane(0.5)))
    run = simulate(unmodelled, "mujoco", "RK4", 0.1)
    verdict = judgement.verdict(unmodelled, NoTruth("the reference does not model contact"), run)
    assert (verdict.passed, verdict.outcome.status) == (False, "unsupported")


@pytest.mark.parametrize(
    ("became", "status", "reason"),
    [
        (TimedOut(4.0), "timeout", "the reference: stopped after 4 s"),
        (Crashed("its process died"), "crashed", "the reference: its process died"),
        (NoTruth("out of reach"), "unsupported", "the reference: out of reach"),
    ],
)
def test_a_truth_that_was_stopped_or_failed_is_not_unsupported(
    tmp_path: Path, became: NoTruth | Crashed | TimedOut, status: str, reason: str
) -> None:
    """A busy machine must not turn a red build into one that checks nothing."""
    case = parse(shortened(load("free-brick"), 1.0, 11).text.partition("[[expect]]")[0], "brick")
    head = campaigns.header("mujoco")
    with store.Writer(tmp_path, head, "", (case,)) as writer:
        writer.add_run(simulate(case, "mujoco", "RK4", 0.1), 0)
        writer.add_missing_truth(case, 0.1, campaign.no_truth(became))
    (verdict,) = judgement.judge(store.read(tmp_path))
    failed = None if status == "unsupported" else False
    assert (verdict.outcome.status, verdict.reason, verdict.passed) == (status, reason, failed)


def test_a_run_without_a_truth_is_unsupported() -> None:
    case = shortened(load("free-brick"), 1.0, 11)
    verdict = judgement.verdict(case, NoTruth("out of reach"), simulate(case, "mujoco", "RK4", 0.1))
    assert (verdict.passed, verdict.row()["status"], verdict.reason) == (None, "unsupported", "out of reach")
    assert "attitude_error" not in verdict.row()
