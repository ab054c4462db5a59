"""The study with the real engines: an engineer's question is answered with a step that a dense scan confirms."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import Case, compare, load, simulate, truth
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import parse
from bodycheck.errors import BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.reports import html, markdown
from bodycheck.results import csv_tables, journal
from bodycheck.results.outcome import Completed
from bodycheck.running import campaign
from bodycheck.running.plan import plan
from bodycheck.studies import cost
from bodycheck.studies.recommend import study, wording
from bodycheck.studies.recommend.measuring import UNSEEN
from bodycheck.studies.recommend.page import present
from bodycheck.studies.recommend.rows import ANSWERS, STEPS, Recommendation
from bodycheck.studies.recommend.search import MOST_NEIGHBOURS, kept, neighbours
from tests.support import campaigns, pages
from tests.support.campaigns import header, records
from tests.support.cases import a_case
from tests.support.commands import bodycheck, call
from tests.support.processes import calls_here
from tests.support.wording import facts

#: A box that tumbles for a minute, about its middle axis, once in some six seconds.
TUMBLING = a_case(
    "tumbling",
    title="A box that tumbles for a minute",
    body={"shape": "brick", "semi_axes": [0.05, 0.2, 0.45], "mass": 10.0},
    initial={"angular_velocity": [0.1, 1.0, 0.1]},
    run={"duration": 60.0, "samples": 601},
)

#: The accuracy that is asked for, in rad.
LIMIT = 1e-4

#: Methods with which it can be had at a cost that a test can afford: one of each engine.
METHODS = [("mujoco", "RK4"), ("pinocchio", "rk4")]


@pytest.fixture(autouse=True)
def _costs_are_measured_roughly(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing that is said here of costs needs their digits."""
    monkeypatch.setattr(cost, "MIN_TIMING_S", cost.MIN_TIMING_S / 20)


def recommended(case: Case, error: float, engines: tuple[str, ...] = ("mujoco", "pinocchio"), **options: Any) -> Recommendation:
    used = records(*engines)
    planned = study.prepare(case, used, options.pop("integrators", ()), options.pop("quantity", "attitude"), error)
    head = campaign.header(["bodycheck", "recommend"], used, {})
    with calls_here(), temporary_folder() as folder, study.results(planned, folder, head, 2, **options) as found:
        return found


@pytest.fixture(scope="module")
def tumbling() -> Case:
    return parse(TUMBLING, "tumbling.case.toml")


@pytest.fixture(scope="module")
def found(tumbling: Case) -> Recommendation:
    return recommended(tumbling, LIMIT, integrators=("RK4", "rk4", "Euler"))


def error_of(case: Case, engine: str, integrator: str, timestep: float) -> float:
    """The attitude error (rad) of one run; infinite if it fails."""
    run = simulate(case, engine, integrator, timestep)
    return compare(truth(case), run).maxima()["attitude_error"] if isinstance(run.outcome, Completed) else math.inf


def scanned(case: Case, engine: str, integrator: str, numbers: set[int]) -> int | None:
    """The fewest of some numbers of steps such that they and all larger numbers keep the limit."""
    return kept({steps: error_of(case, engine, integrator, case.duration / steps) for steps in numbers}, LIMIT)


def around(steps: int, factor: float, count: int) -> set[int]:
    """So many numbers of steps from a number divided by a factor to the number times the factor, with the number itself."""
    return {round(number) for number in steps * np.geomspace(1 / factor, factor, count)} | {steps}


def is_near(steps: int, fewest: int) -> bool:
    """Whether an answer is as near to the fewest steps that keep the limit as the search promises."""
    # The bracket is at most 5 % wide, the neighbourhood is 3 %, and each rounding to an integer adds a step.
    return fewest <= steps <= fewest * 1.05 * 1.03 + 3


@pytest.mark.parametrize(("engine", "integrator"), METHODS)
def test_the_step_is_within_a_tenth_of_the_largest(tumbling: Case, found: Recommendation, engine: str, integrator: str) -> None:
    (own,) = [one for one in found.reached if (one.engine, one.integrator) == (engine, integrator)]
    assert own.timestep is not None
    assert own.error == error_of(tumbling, engine, integrator, own.timestep), "the same run, bit by bit"
    steps = found.asked.steps(own.timestep)
    fewest = scanned(tumbling, engine, integrator, around(steps, 2, 30))
    assert fewest is not None
    assert is_near(steps, fewest)
    assert own.steps <= 12 + MOST_NEIGHBOURS


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tumbling", "osrf-boxes-complex", "intermediate-axis-flip"])
@pytest.mark.parametrize(("engine", "integrator"), METHODS)
def test_a_dense_scan_confirms_the_step(tumbling: Case, name: str, engine: str, integrator: str) -> None:
    case = tumbling if name == tumbling.name else replace(load(name), duration=60.0, expectations=())
    found = recommended(case, LIMIT, (engine,), integrators=(integrator,))
    assert found.best is not None
    assert found.best.timestep is not None
    steps = found.asked.steps(found.best.timestep)
    fewest = scanned(case, engine, integrator, around(steps, 10, 400))
    assert fewest is not None
    assert is_near(steps, fewest)


def test_the_order_of_preference_is_cost(found: Recommendation) -> None:
    costs = [own.cost for own in found.reached]
    assert None not in costs
    assert costs == sorted(costs, key=lambda one: one or 0.0)
    for own in found.reached:
        assert own.error is not None
        assert own.error <= LIMIT
        assert own.worst is not None
        assert own.error <= own.worst <= LIMIT
        assert own.margin == LIMIT / own.worst
        assert own.monotone
        smaller = [probe for probe in found.probes if probe.method == own.method and probe.timestep <= (own.timestep or 0.0)]
        assert len(smaller) >= 2
        assert all(probe.error is not None and probe.error <= LIMIT for probe in smaller)


def test_what_never_gets_there_is_said(found: Recommendation) -> None:
    (euler,) = found.unreached
    assert (euler.engine, euler.integrator) == ("mujoco", "Euler")
    assert euler.smallest == pytest.approx(60.0 / study.MOST_STEPS)
    assert euler.margin is not None
    assert euler.margin < 1
    (never,) = wording.never(found)
    assert facts(never, "never", "mujoco Euler")[:3] == ["mujoco Euler", "never", "0.0006"]
    rk4 = replace(euler, integrator="RK4", error=0.5)
    several = replace(found, answers=(*found.answers, rk4))
    (never,) = wording.never(several)
    assert facts(never, "never", "mujoco Euler", "mujoco RK4")[:3] == ["2", "never", "0.0006"]
    assert facts(never, "mujoco Euler", "mujoco RK4")[-3:] == ["mujoco Euler", "0.5", "mujoco RK4"]
    (never,) = wording.never(replace(several, answers=(*found.answers, replace(rk4, error=euler.error))))
    assert facts(never, "never", "mujoco Euler", "mujoco RK4")[:4] == ["mujoco Euler", "mujoco RK4", "never", "0.0006"]


def test_the_answer_comes_first_in_one_sentence(found: Recommendation) -> None:
    best, second = found.reached
    told = wording.headline(found)
    assert best.timestep is not None
    steps = found.asked.steps(best.timestep)
    assert told.startswith(f"{best.engine} {best.integrator} at {best.timestep} s ({steps} steps): ")
    assert " rad over 60 s, " in told
    assert told.endswith(" s of computing per second.")
    assert wording.second(found).startswith(f"The next best is {second.engine} {second.integrator} at {second.timestep} s: ")
    assert wording.margin(found).startswith("The margin is 1.")
    assert wording.jumps(found) == ()


def test_all_runs_end_at_the_same_instant_and_the_printed_step_repeats_them(found: Recommendation, tumbling: Case) -> None:
    for probe in found.probes:
        steps = 60.0 / probe.timestep
        # The quotient of two doubles is rounded twice.
        assert steps == pytest.approx(round(steps), rel=4e-16)
    best = found.best
    assert best is not None
    printed = float(wording.step(best).removesuffix(" s"))
    assert error_of(tumbling, best.engine, best.integrator, printed) == best.error, "the same run, bit by bit"
    run = simulate(tumbling, best.engine, best.integrator, printed)
    assert isinstance(run.outcome, Completed)
    assert run.outcome.trajectory.t[-1] == pytest.approx(60.0, rel=4e-16)


def test_the_margin_is_that_of_the_worst_neighbour(found: Recommendation) -> None:
    for own in found.reached:
        assert own.timestep is not None
        errors = found.asked.errors(found.of(own))
        assert own.worst == max(errors[steps] for steps in neighbours(found.asked.steps(own.timestep)))


def test_a_lucky_step_is_told_and_not_recommended(miniatures: Path) -> None:
    """With 14 steps the engine makes no error, with 15 to 17 it breaks the limit, and with 18 and more it keeps it."""
    text = TUMBLING.replace("[0.1, 1.0, 0.1]", "[0.0, 0.0, 14.0]").replace("60.0", "1.0")
    case, limit = parse(text, "tumbling.case.toml"), (1 / 18) ** 2 * (1 + 1e-9)
    found = recommended(case, limit, ("lucky",), quantity="position")
    (own,) = found.answers
    assert found.probes[0].error is not None
    assert {14, 18, 19, 20} <= found.asked.errors(found.probes).keys()
    assert (own.reached, own.monotone) == (True, False)
    assert own.timestep == 1 / 19
    # The position is a sum of some ten terms of size 1.
    assert own.worst == pytest.approx(1 / 18**2, rel=1e-12)
    assert own.margin == pytest.approx(1, rel=1e-8)
    (told,) = wording.jumps(found)
    assert facts(told, "not monotone", "14 steps", "lucky")
    report = present(header("lucky"), found)
    assert [finding.text for finding in report.findings if finding.subject == "Not monotone"] == [told]
    assert "18 to 20 steps" in wording.margin(found)


def test_the_page_has_what_was_measured(found: Recommendation) -> None:
    report = present(header("mujoco", "pinocchio"), found)
    text = html.render_study(report)
    pages.check(text)
    assert report.headline == wording.headline(found)
    (part,) = report.parts
    (answers, steps) = (table for _, table in part.tables)
    assert len(answers.rows) == 3
    assert len(steps.rows) == len(found.probes)
    assert steps.failed.count(True) == sum(probe.error is None or probe.error > LIMIT for probe in found.probes)
    (chart,) = part.charts
    assert sum(bool(point["chosen"]) for point in chart.specification["layer"][1]["data"]["values"]) == 2
    assert report.headline.rstrip(".") in markdown.render_study(report)


def test_what_tradeoff_or_run_measured_is_not_measured_again(tumbling: Case, found: Recommendation, tmp_path: Path) -> None:
    best = found.best
    assert best is not None
    steps = [probe.timestep for probe in found.of(best)]
    made = campaigns.results(plan([tumbling], records("mujoco"), ("RK4",), (*steps, 0.7)), tmp_path)
    prepared = study.prepare(tumbling, records("mujoco"), ("RK4",), "attitude", LIMIT)
    known = study.reused(made, prepared)
    assert sorted(probe.timestep for probe in known) == sorted(steps), "0.7 s does not divide the duration"
    head = header("mujoco")
    with calls_here(), study.results(prepared, tmp_path / "again", head, 1, known=known) as again:
        assert again.best is not None
        assert (again.best.timestep, again.best.error) == (best.timestep, best.error)
    measured = journal.read(tmp_path / "again" / study.RECORDS).records
    assert not measured
    with pytest.raises(BadInput, match="has no runs of the case tumbling as its file is now"):
        study.reused(made, replace(prepared, case=parse(TUMBLING.replace("0.45", "0.46"), "")))


def test_a_search_that_was_interrupted_resumes(tumbling: Case, found: Recommendation, tmp_path: Path) -> None:
    prepared = study.prepare(tumbling, records("mujoco"), ("RK4",), "attitude", LIMIT)

    class Interrupted(Exception):
        pass

    with calls_here(), pytest.raises(Interrupted), study.results(prepared, tmp_path, header("mujoco"), 1):
        raise Interrupted
    before = journal.read(tmp_path / study.RECORDS)
    assert not before.complete
    with calls_here(), study.results(prepared, tmp_path, header("mujoco"), 1) as again:
        assert again.best is not None
        assert again.best.timestep == next(own.timestep for own in found.reached if own.engine == "mujoco")
    after = journal.read(tmp_path / study.RECORDS)
    assert after.complete
    assert after.records == before.records, "nothing was measured again"


def test_a_scene_that_a_method_solves_exactly_gets_the_largest_step() -> None:
    found = recommended(load("projectile"), 1e-6, ("mujoco",), quantity="position", integrators=("RK4",))
    assert found.best is not None
    assert found.best.timestep == 0.2, "a tenth of the duration"
    assert found.best.broken is None
    assert "Larger steps are not tried" in wording.margin(found)


def test_figures_are_chosen_by_short_names_and_by_their_own() -> None:
    flight, football, slide = load("free-brick"), load("football-drag"), load("sliding-brick")
    assert study.figure_of(flight, "attitude") == "attitude_error"
    assert study.figure_of(flight, "energy") == "energy_drift"
    assert study.figure_of(football, "energy") == study.figure_of(slide, "energy") == "energy_error"
    assert study.figure_of(flight, "velocity_error") == "velocity_error"
    with pytest.raises(BadInput, match="did you mean 'attitude_error'"):
        study.figure_of(flight, "atitude_error")
    with pytest.raises(BadInput, match="allowed: attitude, position"):
        study.figure_of(flight, "order")


def test_a_figure_that_large_steps_do_not_show_is_found_with_smaller_ones() -> None:
    """The search begins with a tenth of the run, with which no bounce of the ball has two samples."""
    found = recommended(load("dropped-ball"), 0.01, ("mujoco",), quantity="bounce_ratio_error", integrators=("Euler",))
    largest, *_, smallest = found.probes
    assert (largest.status, largest.error) == ("ok", None)
    assert smallest.error == pytest.approx(0.8, abs=0.01), "MuJoCo's ball does not bounce"
    (own,) = found.answers
    assert not own.reached
    assert own.reason != UNSEEN


def test_a_figure_that_a_scene_does_not_have_is_said() -> None:
    found = recommended(load("projectile"), 1e-3, ("mujoco",), quantity="stop_time_error", integrators=("RK4",))
    (own,) = found.answers
    assert not own.reached
    assert own.reason == UNSEEN
    assert own.steps == study.MOST_UNSEEN
    pages.check(html.render_study(present(header("mujoco"), found)))


@pytest.mark.parametrize(
    ("error", "message"),
    [(0.0, "must be positive"), (math.nan, "must be positive"), (4.0, "because the attitude error is at most 3.142 rad")],
)
def test_an_error_that_cannot_be_asked_for(error: float, message: str) -> None:
    with pytest.raises(BadInput, match=message):
        recommended(load("free-brick"), error)


def test_no_less_can_be_asked_for_than_the_truth_knows() -> None:
    with pytest.raises(BadInput, match="the truth of free-brick has an error of up to"):
        recommended(load("free-brick"), 1e-17, ("mujoco",), integrators=("RK4",))


def test_the_command(calls_here: None, tumbling: Case, tmp_path: Path) -> None:
    path, out = tmp_path / "tumbling.case.toml", tmp_path / "out"
    path.write_text(TUMBLING.replace("60.0", "6.0").replace("601", "61"))
    command = ("recommend", path, "--engine", "mujoco", "--integrator", "RK4", "--integrator", "Euler", "--error", 1e-4)
    done = bodycheck(*command, "--json", "--out", out)
    assert done.returncode == 0
    first, second = json.loads(done.stdout)
    assert list(first)[:8] == ["engine", "version", "integrator", "timestep", "error", "cost", "margin", "reached"]
    assert (first["integrator"], first["reached"]) == ("RK4", True)
    assert (second["integrator"], second["reached"]) == ("Euler", False)
    answers = csv_tables.read(out, ANSWERS)
    assert answers == [first, second]
    assert len(csv_tables.read(out, STEPS)) == first["steps"] + second["steps"]
    report = (out / "report.html").read_text()
    (out / "report.html").unlink()
    assert call("report", out) == 0
    assert (out / "report.html").read_text() == report
    assert bodycheck(*command[:4], "--integrator", "Euler", "--error", 1e-4).returncode == 1, "no method gets there"
    refused = bodycheck(*command[:-1], -1)
    assert (refused.returncode, refused.stderr) == (2, "--error -1: must be positive and finite\n")


def test_steps_of_a_sampled_case_divide_the_period_of_its_controllers() -> None:
    """The arm is sampled at 100 Hz for a second, so that a run has 100 steps, or a multiple."""
    case = load("driven-arm")
    asked = study.Study(case, "attitude_error", 1e-3, ()).asked
    assert [asked.numbered(Method("RK4", 0.0), number).timestep for number in (1, 2, 5)] == [0.01, 0.005, 0.002]
    assert [asked.number(Method("RK4", step)) for step in (0.01, 0.002, 0.004, 0.003)] == [1, 5, None, None]
    assert neighbours(1) == (1, 2)
    assert study.periods_of(load("driven-hinge-continuous")) == study.periods_of(load("double-pendulum")) == 1
