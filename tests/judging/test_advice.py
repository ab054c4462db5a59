"""What to do next where an expectation does not hold: commands that bodycheck takes as they stand."""

import shlex
from dataclasses import replace
from datetime import date
from typing import Any

import pytest

from bodycheck import load, simulate
from bodycheck.casefile.case import parse
from bodycheck.commands.command_line import app
from bodycheck.judging import advice, judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.processes.failures import Crashed
from tests.support.cases import a_case, expecting
from tests.support.truths import truth_for_runs

FILE = "my cases/spin.case.toml"
#: A body that tumbles, which Euler's method gets wrong.
TUMBLING: dict[str, Any] = {
    "body": {"shape": "brick", "semi_axes": [0.1, 0.2, 0.3], "mass": 1.0},
    "initial": {"angular_velocity": [1.0, 5.0, 0.1]},
}


def judged(**expected: Any) -> Verdict:
    case = parse(a_case(**TUMBLING, expect=[expecting("mujoco", "Euler", 0.01, **expected)]), FILE)
    return judgement.verdict(case, truth_for_runs(case, 0.01), simulate(case, "mujoco", "Euler", 0.01), today=date(2027, 1, 1))


def commands(verdict: Verdict) -> list[list[str]]:
    return [shlex.split(line.partition(": ")[2]) for line in advice.lines(verdict, FILE) if ": bodycheck " in line]


def test_a_failure_names_both_versions_and_the_commands() -> None:
    verdict = judged(attitude_error=1e-9, version="3.3.0")
    now = verdict.run.version
    assert f"; it was written with mujoco 3.3.0, this is {now}" in verdict.reason
    method = ["--integrator", "Euler", "--timestep", "0.01"]
    bisect, expect = commands(verdict)
    limit = ["--case", FILE, "--quantity", "attitude_error", "--limit", "1e-09"]
    assert bisect == ["bodycheck", "bisect", "mujoco", "3.3.0", now, *limit, *method]
    assert expect == ["bodycheck", "expect", FILE, "--engine", "mujoco", *method, "--figure", "attitude_error"]
    assert advice.lines(verdict, FILE)[-1].startswith(f"to tolerate it until a day, in its [[expect]] in {FILE}: known = ")
    for command in (bisect, expect):
        app.parse_args(command[1:], print_error=False, exit_on_error=False)


def test_of_a_figure_that_is_too_small_now_the_new_release_is_the_good_one() -> None:
    verdict = judged(attitude_error={"at_least": 2.0, "at_most": 3.0}, version="3.3.0")
    (bisect,) = commands(verdict)
    assert bisect[3:5] == [verdict.run.version, "3.3.0"]
    assert bisect[bisect.index("--limit") + 1] == "2.0"


@pytest.mark.parametrize("version", [True, False])
def test_the_engine_is_asked_about_only_if_its_version_may_have_changed(version: bool) -> None:
    now = simulate(load("free-brick"), "mujoco", "Euler", 0.1).version
    verdict = judged(attitude_error=1e-9, **({"version": now} if version else {}))
    assert [command[1] for command in commands(verdict)] == (["expect"] if version else ["bisect", "expect"])
    if not version:
        assert commands(verdict)[0][3:5] == [advice.EARLIER, now]


def test_what_holds_needs_no_advice() -> None:
    assert advice.lines(judged(attitude_error=3.0), FILE) == []


def test_a_figure_that_is_not_measured_is_neither_bisected_nor_accepted() -> None:
    verdict = judged(joint_slide_error=0.0, version="3.3.0")
    assert "joint_slide_error is unknown" in verdict.reason
    assert commands(verdict) == []


def test_a_run_that_fails_is_bisected_by_any_limit_that_it_exceeds_then() -> None:
    verdict = judged(attitude_error=3.0, version="3.3.0")
    case = parse(a_case(**TUMBLING, expect=[expecting("mujoco", "Euler", 0.01, attitude_error=3.0, version="3.3.0")]), FILE)
    crashed = replace(verdict.run, outcome=Crashed("it died"))
    found = judgement.verdict(case, truth_for_runs(case, 0.01), crashed, today=date(2027, 1, 1))
    (bisect,) = commands(found)
    assert bisect[:7] == ["bodycheck", "bisect", "mujoco", "3.3.0", found.run.version, "--case", FILE]
    assert bisect[bisect.index("--quantity") : bisect.index("--integrator")] == [
        "--quantity",
        "attitude_error",
        "--limit",
        "3.0",
    ]


def test_a_release_of_an_environment_is_told_of_and_bisected_by_the_name_of_its_engine() -> None:
    verdict = judged(attitude_error=1e-9, version="3.3.0")
    named = replace(verdict, run=replace(verdict.run, engine="mujoco@3.3.7", version="3.3.7"))
    assert commands(named)[0][2] == "mujoco"
    (broken,) = verdict.judged
    text = judgement.settle(broken.expectation, broken.breaches, date(2027, 1, 1), named.run).text
    assert text.endswith("; it was written with mujoco 3.3.0, this is 3.3.7")


def test_a_shipped_case_is_not_written_to() -> None:
    lines = advice.lines(judged(attitude_error=1e-9, version="3.3.0"), "free-brick")
    assert not any("bodycheck expect" in line for line in lines)


def test_a_discrepancy_that_is_tolerated_no_longer_may_get_another_day() -> None:
    verdict = judged(attitude_error=1e-9)
    (broken,) = verdict.judged
    known = replace(broken.expectation, known="https://example.org/7", until=date(2026, 12, 31))
    *_, last = advice.lines(replace(verdict, judged=(replace(broken, expectation=known),)), FILE)
    assert last == f'to tolerate it longer, in its [[expect]] in {FILE}: until = "YYYY-MM-DD"'
