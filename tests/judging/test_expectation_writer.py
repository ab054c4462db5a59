"""Expectations are set from what was measured, and all else in a case file stays as it was."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bodycheck import Case, load, simulate, truth
from bodycheck.adapters import registry
from bodycheck.casefile.case import parse
from bodycheck.errors import BadInput
from bodycheck.judging import judgement
from bodycheck.judging.expectation_writer import Measurement, floors, measure, rewrite
from bodycheck.reference.truths import NoTruth
from tests.support.commands import bodycheck, call
from tests.support.truths import truth_for_runs
from tests.support.tumbling import TUMBLING


def measured(case: Case, engine: str = "mujoco", integrator: str = "Euler", timestep: float = 0.01) -> Measurement:
    reference = truth_for_runs(case, timestep)
    return measure(judgement.verdict(case, reference, simulate(case, engine, integrator, timestep)), reference)


def limits(case: Case) -> dict[str, float | None]:
    return {limit.name: limit.at_most for limit in case.expectations[0].limits}


def test_numbers_are_renewed_and_all_else_stays() -> None:
    """Comments, order, spaces, ranges and orders of a table that is there; only the numbers and our own comments change."""
    case = parse(TUMBLING, "f")
    measurement = measured(case)
    text, (change,) = rewrite(case, [measurement], 3.0)
    assert (change.text, change.done) == ("renewed", True)
    before, after = TUMBLING.split("\n"), text.split("\n")
    after.remove(f'version = "{measurement.verdict.run.version}"')
    changed = {old: new for old, new in zip(before, after, strict=True) if old != new}
    figures = measurement.figures
    names = [re.split("[ =]", line)[0] for line in changed]
    assert names == ["attitude_error", "velocity_error", "angular_velocity_error"]
    assert all("# set by hand" in new for old, new in changed.items() if "# set by hand" in old)
    found = limits(parse(text, "f"))
    for name in ("attitude_error", "angular_velocity_error"):
        assert figures[name] > measurement.floors[name]
        # Rounded down to two digits.
        assert 3 * figures[name] / 1.1 <= (found[name] or 0) <= 3 * figures[name]
    assert found["energy_drift"] == 9.0
    line, version = after[before.index("angular_velocity_error=9.0")], measurement.verdict.run.version
    assert line.endswith(f"# 3 x {figures['angular_velocity_error']:.3g} measured with mujoco {version}")
    # The column of the comment that was there.
    (velocity,) = (line for line in after if line.startswith("velocity_error   =   "))
    assert velocity.index("#") == 32
    assert "measured with mujoco 1.0.0" not in text
    again, _ = rewrite(parse(text, "f"), [measurement], 3.0)
    assert again == text


def test_a_new_table_stands_at_the_end_and_limits_all_figures() -> None:
    case = parse(TUMBLING, "f")
    measurement = measured(case, "pinocchio", "rk4", 0.01)
    text, (change,) = rewrite(case, [measurement], 2.0)
    assert change.text == "written"
    assert text.startswith(TUMBLING + "\n\n[[expect]]\n")
    added = parse(text, "f").expectations[1]
    assert (added.engine, added.method.name, added.method.timestep) == ("pinocchio", "rk4", 0.01)
    assert {limit.name for limit in added.limits} == set(measurement.figures)
    for limit in added.limits:
        taken = max(measurement.figures[limit.name], measurement.floors[limit.name])
        assert 2 * taken / 1.1 <= (limit.at_most or 0) <= 2 * taken
    assert judgement.verdict(parse(text, "f"), truth_for_runs(case, 0.01), measurement.verdict.run).passed is True


def test_the_version_of_a_measurement_is_written_with_its_numbers() -> None:
    """It is renewed where all numbers are; after some of them it would be wrong of the others."""
    case = parse(TUMBLING.replace("order = 1", 'version = "1.0.0"  # ours\norder = 1'), "f")
    measurement = measured(case)
    version = measurement.verdict.run.version
    text, _ = rewrite(case, [measurement], 3.0)
    assert re.findall("version.*", text) == [f'version = "{version}"  # ours']
    assert parse(text, "f").expectations[0].version == version
    some = replace(measurement, figures={"attitude_error": measurement.figures["attitude_error"]})
    text, _ = rewrite(case, [some], 3.0)
    assert re.findall("version.*", text) == ['version = "1.0.0"  # ours']
    assert text.count(f"measured with mujoco {version}") == 0, "the one limit has a comment of the user"
    assert limits(parse(text, "f")) == limits(case) | {
        "attitude_error": pytest.approx(3 * some.figures["attitude_error"], rel=0.1)
    }
    added, _ = rewrite(case, [measured(case, "pinocchio", "rk4")], 3.0)
    written = parse(added, "f").expectations[1]
    assert (written.version, written.method.timestep) == (registry.load("pinocchio").engine.version, 0.01)


def test_a_limit_that_cannot_fail_is_not_written() -> None:
    """Three times an error of 1.5 rad is more than the angle between any two attitudes."""
    case = parse(TUMBLING, "f")
    measurement = measured(case)
    lost = replace(measurement, figures=measurement.figures | {"attitude_error": 1.5})
    beyond = "3 x 1.5 is not below 3.142 rad, the most possible"
    idle = f"no limit of attitude_error, about which the method says nothing here: {beyond}"
    text, (change,) = rewrite(case, [lost], 3.0)
    assert (change.text, change.done) == (f"renewed; {idle}", False)
    assert limits(parse(text, "f"))["attitude_error"] == 3.0, "what was there stays"
    bare = parse(TUMBLING.split("[[expect]]")[0] + "[body]" + TUMBLING.split("[body]")[1], "f")
    text, (change,) = rewrite(bare, [lost], 3.0)
    assert (change.text, change.done) == (f"written; {idle}", True)
    assert limits(parse(text, "f")).keys() == lost.figures.keys() - {"attitude_error"}
    text, (change,) = rewrite(bare, [replace(lost, figures={"attitude_error": 1.5})], 3.0)
    assert (text, change.text, change.done) == (bare.text, f"nothing is written: {idle}", False)
    half = replace(lost, figures={"attitude_error": 1.57})
    text, _ = rewrite(bare, [half], 2.0)
    assert limits(parse(text, "f")) == {"attitude_error": 3.1}


def test_tables_between_expectations_stay_where_they_are() -> None:
    """As in a file to which expectations were added: its numbers are renewed, and nothing is moved."""
    case = parse(TUMBLING, "f")
    measurements = [measured(case), measured(case, "pinocchio", "rk4", 0.01)]
    text, _ = rewrite(case, measurements, 3.0)
    assert text.index("[[expect]]") < text.index("[body]") < text.rindex("[[expect]]")
    again, changes = rewrite(parse(text, "f"), measurements, 3.0)
    assert [change.text for change in changes] == ["renewed", "renewed"]
    assert again == text
    spread = re.sub(r"(?<=\n)\[body\]", "[ body ]  # stays", text)
    assert rewrite(parse(spread, "f"), measurements, 3.0)[0] == spread


def test_windows_line_ends_stay() -> None:
    case = parse(TUMBLING.replace("\n", "\r\n"), "f")
    text, _ = rewrite(case, [measured(case), measured(case, "pinocchio", "rk4")], 3.0)
    assert text.count("\n") == text.count("\r\n") > 30
    plain = parse(TUMBLING, "f")
    assert text.replace("\r\n", "\n") == rewrite(plain, [measured(plain), measured(plain, "pinocchio", "rk4")], 3.0)[0]


def test_what_is_known_to_fail_and_statuses_are_left() -> None:
    known = TUMBLING.replace("order = 1 ", 'known = "https://example.org/7"\nuntil = "2030-01-01"\n')
    case = parse(known, "f")
    text, (change,) = rewrite(case, [measured(case)], 3.0)
    assert (text, change.done) == (known, True)
    assert "known to fail (https://example.org/7)" in change.text
    diverged = TUMBLING.split("order")[0] + 'status = "diverged"\n[body]' + TUMBLING.split("[body]")[1]
    case = parse(diverged, "f")
    text, (change,) = rewrite(case, [measured(case)], 3.0)
    assert (text, change.done) == (diverged, False)
    assert change.text == "left as it is: diverged is expected, found is ok"


def test_a_run_that_is_not_ok_is_expected_to_end_like_that() -> None:
    text = (
        TUMBLING.split("[[expect]]")[0] + "[scene]\ndrag = {quadratic = 0.1}\nplane = {}\n[body]" + TUMBLING.split("[body]")[1]
    )
    case = parse(text, "f")
    reference = NoTruth("no model")
    measurement = measure(judgement.verdict(case, reference, simulate(case, "mujoco", "Euler", 0.01)), reference)
    written, (change,) = rewrite(case, [measurement], 3.0)
    (expectation,) = parse(written, "f").expectations
    assert (expectation.status, expectation.limits, change.done) == ("unsupported", (), True)


def test_floors_are_what_rounding_comes_to() -> None:
    """A thrown body that does not turn: all errors of a Runge-Kutta method are rounding, and are limited above it."""
    case = load("projectile")
    measurement = measured(case, "mujoco", "RK4", 0.002)
    assert set(measurement.floors) == set(measurement.figures)
    # 1e-12 of 20 m, the farthest that it comes, and of 14.1 m/s, its speed at the beginning and about that at the end.
    assert 2e-11 < measurement.floors["position_error"] < 2.3e-11
    assert 1.4e-11 < measurement.floors["velocity_error"] < 1.6e-11
    assert all(value < measurement.floors[name] for name, value in measurement.figures.items())
    text, _ = rewrite(parse(case.text.split("[[expect]]")[0], "f"), [measurement], 3.0)
    for limit in parse(text, "f").expectations[0].limits:
        assert limit.at_most == pytest.approx(3 * measurement.floors[limit.name], rel=0.1)  # two digits
    assert text.count("is rounding") == len(measurement.figures)


def test_no_floor_vanishes() -> None:
    """Of what is zero in a scene, rounding is that of what it is made of: a limit of nothing would break anywhere else."""
    case = load("resting-brick")
    reference = truth(case)
    names = ("position_error", "velocity_error", "angular_velocity_error", "attitude_error", "creep", "angular_momentum_error")
    found = floors(reference, names)
    assert np.all([value >= 1e-14 for value in found.values()])


def test_expect_measures_and_writes(calls_here: None, tmp_path: Path) -> None:
    path = tmp_path / "tumbling.case.toml"
    path.write_bytes(TUMBLING.replace("\n", "\r\n").encode())
    options = ("--integrator", "Euler", "--integrator", "rk4", "--margin", "2.5", "--jobs", "2")
    done = bodycheck("expect", path.name, *options, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert re.findall(r"(\w+) +(\S+) +([\d.]+) +(\w+) *$", done.stdout, re.M) == [
        ("mujoco", "Euler", "0.002", "written"),
        ("mujoco", "Euler", "0.01", "renewed"),
        ("pinocchio", "rk4", "0.002", "written"),
    ]
    content = path.read_bytes()
    assert content.count(b"\n") == content.count(b"\r\n")
    assert content.count(b"# 2.5 x ") > 10
    case = load(path)
    steps = [expectation.method.timestep for expectation in case.expectations]
    assert steps == [0.01, 0.002, 0.002], "none for the finer steps that an order needs"
    done = bodycheck("run", path.name, "--integrator", "Euler", "--integrator", "rk4", folder=tmp_path)
    assert done.returncode == 0, done.stdout
    assert "3 passed, 0 failed" in done.stdout


def test_expect_writes_the_figures_that_are_named(calls_here: None, tmp_path: Path) -> None:
    path = tmp_path / "free.case.toml"
    path.write_text(TUMBLING)
    options = ("--figure", "velocity_error", "--figure", "tilt", "--jobs", "1")
    assert call("expect", str(path), "--integrator", "Euler", "--integrator", "RK4", *options) == 0
    renewed, first, second = load(path).expectations
    assert {limit.name: limit.at_most for limit in renewed.limits if limit.at_most == 9.0} == {
        "energy_drift": 9.0,
        "angular_velocity_error": 9.0,
    }
    for added in (first, second):
        assert [limit.name for limit in added.limits] == ["velocity_error"], "a body in flight has no tilt"
    assert call("expect", str(path), "--integrator", "rk4", "--figure", "tilt", "--jobs", "1") == 1
    assert len(load(path).expectations) == 3


def test_a_case_for_which_there_is_no_such_method_is_left(calls_here: None, tmp_path: Path) -> None:
    free, lying = tmp_path / "free.case.toml", tmp_path / "lying.case.toml"
    free.write_text(TUMBLING)
    lying.write_text(load("resting-brick").text.split("[extremes]")[0])
    assert call("expect", str(free), str(lying), "--integrator", "law-force", "--jobs", "1") == 0
    assert free.read_text() == TUMBLING
    assert [e.method.name for e in load(lying).expectations] == ["law-force"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "give at least one case file"),
        (("free-brick",), "free-brick: the name of a shipped case; give the path of a file"),
        (("absent.case.toml",), "there is no such file"),
        (("inline.case.toml",), "inline.case.toml: expect: an array; write its elements as [[expect]] tables"),
        (("good.case.toml", "--margin", "1"), "--margin 1: must be at least 1.1"),
        (("good.case.toml", "--margin", "nan"), "--margin nan"),
        (("good.case.toml", "--integrator", "RK44"), "did you mean"),
        (("good.case.toml", "--figure", "atitude_error"), "--figure atitude_error: allowed: position_error, "),
        (("good.case.toml", "--figure", "order"), "--figure order: allowed: position_error, "),
    ],
)
def test_expect_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str) -> None:
    inline = 'expect = [{engine = "mujoco", integrator = "Euler", timestep = 0.01, status = "ok"}]\n'
    bare = TUMBLING.split("[[expect]]")[0] + "[body]" + TUMBLING.split("[body]")[1]
    texts = {"good.case.toml": TUMBLING, "inline.case.toml": inline + bare}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match=re.escape(words)):
        call("expect", *arguments)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == texts
