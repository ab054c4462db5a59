"""The few methods that the charts of a case show first."""

from collections.abc import Sequence
from dataclasses import replace

from bodycheck.judging.judgement import Verdict
from bodycheck.reports.lines import assign
from bodycheck.reports.runs.charts.legends import MOST_ENTRIES, first_lines
from tests.support.measured_runs import FLIP, ran


def first(runs: Sequence[Verdict]) -> list[str]:
    lines = assign(verdict.key.over_cases for verdict in runs)
    return [line.label for line in first_lines(runs, lines, "attitude_error")]


def test_few_methods_are_all_shown() -> None:
    assert first([ran(FLIP, integrator=name) for name in "abcdef"]) == [f"mujoco {name}" for name in "abcdef"]


def test_the_default_and_the_best_method_of_each_engine_come_before_all_others() -> None:
    """The default of drake is its second method, and its best one its last."""
    errors = {"a": 1e-2, "b": 1e-1, "c": 1e-3, "d": 2e-3, "e": 1e-5}
    mujoco = [ran(FLIP, "mujoco", name, attitude_error=error) for name, error in errors.items()]
    drake = [ran(FLIP, "drake", name, attitude_error=error) for name, error in errors.items()]
    drake[1] = replace(drake[1], run=replace(drake[1].run, role="default"))
    assert first(mujoco + drake) == ["mujoco a", "mujoco c", "mujoco e", "drake b", "drake c", "drake e"]


def test_of_many_engines_the_worst_and_the_best_are_shown() -> None:
    runs = [ran(FLIP, f"e{place}", "a", attitude_error=10.0**-place) for place in range(10)]
    assert first(runs) == ["e0 a", "e1 a", "e2 a", "e7 a", "e8 a", "e9 a"]


def test_all_sets_of_results_of_a_method_are_shown_together() -> None:
    runs = [
        ran(FLIP, integrator=name, label=label, attitude_error=error)
        for label in ("before", "after")
        for name, error in (("a", 1e-1), ("b", 1e-2), ("c", 1e-3), ("d", 1e-4))
    ]
    assert set(first(runs)) == {f"mujoco {name} ({label})" for name in "acd" for label in ("before", "after")}
    assert len(first(runs)) == MOST_ENTRIES
