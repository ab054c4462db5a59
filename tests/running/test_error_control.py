"""Methods with error control: their instants, truths, costs, largest steps and spellings, with a miniature engine."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import Case, compare, simulate, truth
from bodycheck.adapters import registry
from bodycheck.adapters.contract import EngineDiverged, Method, Work
from bodycheck.adapters.stepping import Controlled
from bodycheck.casefile.case import parse
from bodycheck.casefile.expectation import Expectation, Limit
from bodycheck.errors import BadInput
from bodycheck.judging import judgement
from bodycheck.results.outcome import Completed
from bodycheck.running import plan
from bodycheck.running.instants import default_timestep
from bodycheck.running.roles import method_of
from bodycheck.running.simulation import run
from tests.support import campaigns
from tests.support.cases import a_case

SPELLING = "bs3:accuracy=1e-6"


@pytest.fixture
def case(miniatures: Path) -> Case:
    """A second of a flip, sampled at instants that are no multiples of its largest step."""
    text = a_case(
        "flip",
        body={"shape": "brick", "semi_axes": [0.05, 0.1, 0.2], "mass": 1.0},
        initial={"angular_velocity": [0.1, 20.0, 0.1]},
        run={"duration": 1.0, "samples": 8},
    )
    return parse(text, "flip")


def completed(case: Case, spelling: str, timestep: float | None = None) -> Completed:
    outcome = simulate(case, "adaptive", spelling, timestep).outcome
    assert isinstance(outcome, Completed)
    return outcome


def engine() -> Any:
    return registry.load("adaptive").engine


def test_samples_are_at_the_instants_of_the_case_exactly(case: Case) -> None:
    for timestep in (None, 0.3):
        np.testing.assert_array_equal(completed(case, SPELLING, timestep).trajectory.t, case.instants)


def test_samples_do_not_shorten_the_steps_of_the_engine(case: Case) -> None:
    few, many = (completed(replace(case, samples=samples), SPELLING, 0.5) for samples in (2, 201))
    assert (few.steps, few.rejected, few.evaluations) == (many.steps, many.rejected, many.evaluations)
    # A sample is one step of the engine from the end of its last own step, so that its error is within that of the own steps.
    errors = [
        compare(truth(replace(case, samples=samples)), simulate(replace(case, samples=samples), "adaptive", SPELLING, 0.5))
        for samples in (11, 201)
    ]
    coarse, fine = (one.maxima()["attitude_error"] for one in errors)
    assert coarse <= fine * (1 + 1e-12)
    assert fine < 3 * coarse


def test_a_smaller_accuracy_gives_smaller_errors_and_more_work(case: Case) -> None:
    errors = []
    for spelling in ("bs3:accuracy=1e-4", SPELLING, "bs3:accuracy=1e-8"):
        errors.append(compare(truth(case), simulate(case, "adaptive", spelling)).maxima()["attitude_error"])
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    works = [completed(case, f"bs3:accuracy=1e-{digits}") for digits in (4, 6, 8)]
    assert works[0].steps < works[1].steps < works[2].steps
    for done in works:
        assert done.evaluations == 4 * (done.steps + (done.rejected or 0))


def test_the_default_largest_step_is_the_limit_of_the_engine_or_the_sampling_interval(case: Case) -> None:
    method, record = Method.parse(SPELLING, 0.0), engine()
    assert default_timestep(record, case, method) == case.duration / 7
    assert default_timestep(replace(record, largest_step=0.1), case, method) == 0.1
    assert default_timestep(replace(record, largest_step=5.0), case, method) == case.duration
    assert default_timestep(record, case, Method.parse("bs3", 0.0)) == 0.002
    assert method_of(record, case, SPELLING, 0.25).timestep == 0.25


def test_without_accuracy_steps_are_fixed(case: Case) -> None:
    done = completed(case, "bs3")
    assert (done.steps, done.rejected, done.evaluations) == (500, None, None)


def test_an_integrator_without_error_control_has_no_accuracy(case: Case) -> None:
    with pytest.raises(BadInput, match="adaptive plain has no option 'accuracy'"):
        simulate(case, "adaptive", "plain:accuracy=1e-6")
    for wrong in ("0", "2", "-1e-3", "nan", "small", "any"):
        with pytest.raises(BadInput, match="allowed: a relative tolerance above 0 and at most 1"):
            simulate(case, "adaptive", f"bs3:accuracy={wrong}")


def test_tables_have_the_work_at_their_end(case: Case, tmp_path: Path) -> None:
    planned = plan.plan([case], campaigns.records("adaptive"), [SPELLING, "plain"], [])
    results = campaigns.results(planned, tmp_path)
    rows = {row["integrator"]: row for row in judgement.records(judgement.judge(results))}
    own, plain = rows[SPELLING], rows["plain"]
    assert list(own)[-4:] == ["steps_taken", "steps_rejected", "evaluations", "role"]
    done = completed(case, SPELLING)
    assert [own[name] for name in ("steps", "steps_taken", "steps_rejected", "evaluations")] == [
        *(done.steps, done.steps, done.rejected, done.evaluations)
    ]
    assert [plain[name] for name in ("steps", "steps_taken", "steps_rejected", "evaluations")] == [500, 500, None, None]
    assert own["timestep"] == case.duration / 7
    assert own["status"] == "ok"
    # The simulated time is the duration, and no multiple of the mean step.
    assert own["realtime_factor"] == pytest.approx(case.duration / own["wall_time"], rel=1e-12)


def test_expectations_name_the_accuracy(case: Case) -> None:
    loose, tight = (
        Expectation("adaptive", Method.parse(spelling, 0.1), (Limit("attitude_error", None, 1.0),))
        for spelling in ("bs3:accuracy=1e-4", SPELLING)
    )
    expecting = replace(case, expectations=(loose, tight))
    tasks = plan.plan([expecting], {"adaptive": engine()}, [SPELLING], [])
    assert [str(task.method) for task in tasks] == [f"{SPELLING} {case.duration / 7:g} s", f"{SPELLING} 0.1 s"]
    verdicts = [
        judgement.verdict(expecting, truth(case), run(expecting, "adaptive", Method.parse(spelling, 0.1)))
        for spelling in (SPELLING, "bs3:accuracy=1e-5")
    ]
    assert [verdict.passed for verdict in verdicts] == [True, None]


def test_a_simulation_that_fails_keeps_the_states_before() -> None:
    def at(time: float) -> np.ndarray:
        if time > 0.25:
            raise EngineDiverged("too small a step")
        return np.full(13, time)

    controlled = Controlled(0.1, at, np.asarray, lambda: Work(1, None, None))
    with pytest.raises(EngineDiverged) as failed:
        controlled.reach(np.array([0.0, 0.2, 0.4, 0.6]))
    assert failed.value.states.shape == (1, 3, 1, 13)
    assert failed.value.states[0, 1, 0, 0] == 0.2
    assert math.isnan(failed.value.states[0, 2, 0, 0])


def test_advance_reaches_multiples_of_the_largest_step() -> None:
    controlled = Controlled(0.1, lambda time: np.full(13, time), np.asarray, lambda: Work(1, None, None))
    first, second = (controlled.advance(np.array(strides))[0, :, 0, 0] for strides in ([0, 2], [1, 3]))
    np.testing.assert_array_equal([*first, *second], np.array([0, 2, 3, 6]) * 0.1)
