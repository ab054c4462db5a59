"""The choice of a method: the cheapest that is accurate enough in the same cases, and how far defaults are from it."""

from collections.abc import Sequence
from dataclasses import replace

import vl_convert

from bodycheck import load
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.lines import assign
from bodycheck.reports.runs.charts.choice_charts import error_over_cost
from bodycheck.reports.runs.choices import Choice, attention, choices, defaults, tried
from bodycheck.reports.runs.comparison import Shown
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Diverged
from tests.support.measured_runs import FLIGHT, FLIP, SLIDE, ended, ran
from tests.support.wording import facts

OTHER = "free-brick"


def timed(verdict: Verdict, cost: float, role: str = "") -> Verdict:
    """A run of two seconds of motion whose computation takes `cost` seconds for each of them."""
    outcome = replace(verdict.outcome, wall_time=2 * cost)  # type: ignore[call-arg]
    return replace(verdict, run=replace(verdict.run, outcome=outcome, role=role), outcome=outcome, duration=2.0)


def shown(verdicts: Sequence[Verdict]) -> list[Shown]:
    names = dict.fromkeys(verdict.run.case for verdict in verdicts)
    return [
        Shown(name, name, load(name), (), tuple(verdict for verdict in verdicts if verdict.run.case == name)) for name in names
    ]


def chosen(*verdicts: Verdict, demonstrations: Sequence[RunKey] = ()) -> tuple[Choice, ...]:
    lines = assign(verdict.key.over_cases for verdict in verdicts)
    return choices(tried(shown(verdicts), lines, demonstrations))


def test_the_cheapest_that_is_accurate_enough_in_every_case_is_chosen() -> None:
    runs = [
        timed(ran(name, integrator=way, attitude_error=error if name == FLIP else error / 10), cost)
        for name in (FLIP, OTHER)
        for way, error, cost in (("a", 2.0, 0.1), ("b", 9e-4, 0.5), ("c", 1e-9, 2.0))
    ]
    (choice,) = chosen(*runs)
    assert (choice.chosen.line.integrator, choice.chosen.worst.case, choice.chosen.cost) == ("b", FLIP, 0.5)
    assert choice.enough
    text = choice.finding.text
    names = ("Of 3 methods", "mujoco b at 2 ms", "cheapest", "all 2 cases", FLIP)
    assert [word for word in names if word in text] == list(names)
    assert {"0.0009 rad", "0.5 s"} <= {word for word in ("0.0009 rad", "0.5 s") if word in text}


def test_of_equal_costs_the_smaller_error_decides() -> None:
    runs = [
        timed(ran(FLIP, integrator=way, attitude_error=error), cost) for way, error, cost in (("a", 1e-4, 1), ("b", 1e-6, 1.1))
    ]
    (choice,) = chosen(*runs)
    assert choice.chosen.line.integrator == "b"


def test_of_one_method_the_largest_accurate_step_is_chosen() -> None:
    """Each cost is measured once, and a busy machine may take longer for fewer steps."""
    steps = ((0.02, 0.5, 0.9), (0.01, 1e-4, 1.5), (0.005, 1e-6, 1.0))
    (choice,) = chosen(*(timed(ran(FLIP, timestep=step, attitude_error=error), cost) for step, error, cost in steps))
    assert choice.chosen.line.timestep == 0.01


def test_costs_are_compared_only_where_efforts_are_computed_alike() -> None:
    """A law that is computed at the stages of a scheme costs more calls than one that is computed between steps."""

    def driven(verdict: Verdict, efforts: str) -> Verdict:
        outcome = replace(verdict.outcome, efforts=efforts)  # type: ignore[call-arg]
        return replace(verdict, run=replace(verdict.run, outcome=outcome), outcome=outcome)

    ways = (("a", 1e-4, 1.0, "at stages"), ("b", 1e-6, 9.0, "between steps"))
    runs = [driven(timed(ran(FLIP, integrator=way, attitude_error=error), cost), efforts) for way, error, cost, efforts in ways]
    (choice,) = chosen(*runs)
    assert (choice.chosen.line.integrator, choice.chosen.cost) == ("b", None)
    assert "mujoco b at 2 ms is the most accurate, and stays within 0.001 rad" in choice.finding.text
    free = [timed(ran(OTHER, integrator=way, attitude_error=1e-9), 1.0) for way, *_ in ways]
    (choice,) = chosen(*runs, *free)
    assert {option.cost for option in choice.options} == {1.0}


def test_without_an_accurate_method_the_closest_is_named() -> None:
    runs = [timed(ran(FLIP, integrator=way, attitude_error=error), 1.0) for way, error in (("a", 0.5), ("b", 0.002))]
    (choice,) = chosen(*runs)
    assert not choice.enough
    assert "No method stays within 0.001 rad" in choice.finding.text
    assert "mujoco b at 2 ms is closest, with at most 0.002 rad" in choice.finding.text


def test_methods_are_compared_in_cases_that_all_of_them_completed() -> None:
    """A method that completed an easy case alone is not chosen for all of them."""
    runs = [timed(ran(name, integrator="a", attitude_error=1e-4), 5.0) for name in (FLIP, OTHER)]
    runs.append(timed(ran(OTHER, integrator="b", attitude_error=1e-12), 0.1))
    (choice,) = chosen(*runs)
    assert [option.line.integrator for option in choice.options] == ["a"]
    assert (choice.compared, choice.cases) == (2, 2)


def test_demonstrations_and_runs_without_an_error_are_left_out() -> None:
    runs = [timed(ran(FLIP, integrator=way, attitude_error=error), 1.0) for way, error in (("a", 1e-9), ("b", 0.5))]
    lost = replace(ran(FLIP, integrator="c"), discrepancy=None)
    infinite = ran(FLIP, integrator="d", attitude_error=float("inf"))
    (choice,) = chosen(*runs, lost, infinite, demonstrations=[runs[0].key.over_cases])
    assert [option.line.integrator for option in choice.options] == ["b"]


def test_kinds_with_an_accurate_method_come_first() -> None:
    runs = [
        *(timed(ran(SLIDE, integrator=way, position_error=1.0), 1.0) for way in ("a", "b")),
        timed(ran(FLIGHT, integrator="a", position_error=1e-6), 1.0),
    ]
    assert [choice.kind.name for choice in chosen(*runs)] == ["translation", "contact"]


def test_the_default_is_compared_with_a_better_method_of_its_engine() -> None:
    runs = [
        timed(ran(FLIP, integrator="a", attitude_error=2.0), 1.0, "default"),
        timed(ran(FLIP, integrator="b", attitude_error=1e-8), 4.0),
        timed(ran(FLIP, "pinocchio", "c", attitude_error=1e-9), 1.0, "default, recommended"),
        timed(ran(SLIDE, integrator="a", position_error=9.0), 1.0, "default"),
    ]
    lines = assign(verdict.key.over_cases for verdict in runs)
    first, second = (default.finding for default in defaults(tried(shown(runs), lines, ())))
    assert facts(first.text, "mujoco", "pinocchio", FLIP, SLIDE)[:3] == ["mujoco", "2", "2"]
    assert "The default of mujoco, a at 2 ms, is off by 2 rad" in first.text
    assert "b at 2 ms is off by 1e-8 rad at 4 times the cost" in first.text
    assert "pinocchio" in second.text
    assert "at most 1e-9 rad" in second.text


def test_runs_that_ended_early_are_named() -> None:
    outcome = Diverged("the energy is too large")
    lost = ended(replace(ran(FLIP), outcome=outcome, discrepancy=None), None, outcome.reason)
    failed = ended(replace(ran(FLIP, integrator="b"), outcome=outcome, discrepancy=None), False, outcome.reason)
    shows = ended(replace(ran(FLIP, integrator="a"), outcome=outcome, discrepancy=None), None, outcome.reason)
    lines = assign(verdict.key.over_cases for verdict in (lost, failed, shows))
    (one,) = attention(shown([lost, failed]), lines, ())
    assert (one.where, "mujoco Euler has the status diverged" in one.text) == (FLIP, True)
    (one,) = attention(shown([shows, lost]), lines, [shows.key.over_cases])
    assert "2 runs have the status diverged. The first is mujoco Euler in" in one.text


def test_the_chart_draws_each_method_and_marks_the_chosen_one() -> None:
    runs = [
        timed(ran(FLIP, integrator=way, attitude_error=error), cost)
        for way, error, cost in (("a", 2.0, 0.1), ("b", 1e-4, 1.0), ("c", 0.0, 3.0))
    ]
    chart = error_over_cost(chosen(*runs)[0])
    assert chart is not None
    svg = vl_convert.vegalite_to_svg(chart.specification)
    assert svg.count("mujoco b at 2 ms") == 1
    assert "mujoco b at 2 ms has 0.0001 rad" in chart.alt
    assert error_over_cost(chosen(runs[0])[0]) is None
