"""The study of releases: what it calls a change, what it says of releases that fail, and that it says what was measured."""

import csv
import json
import os
import shutil
import subprocess
import sys
from dataclasses import fields, replace
from datetime import UTC, datetime
from pathlib import Path
from subprocess import DEVNULL, PIPE

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import bodycheck
from bodycheck import load
from bodycheck.environments import environments, user_cache
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.errors import BadInput
from bodycheck.studies.releases import questions
from bodycheck.studies.releases import rows as release_rows
from bodycheck.studies.releases import study as releases
from bodycheck.studies.releases.page import present
from bodycheck.studies.releases.questions import Answer
from bodycheck.studies.releases.rows import UNOBTAINABLE, Change, Found
from tests.support import MINIATURES, ROOT, wheels
from tests.support.commands import call
from tests.support.release_rows import HEADER, change, failed, row

FLIP = load("intermediate-axis-flip")

SPIN = """\
format = 1
name = "spin"
title = "A sphere that spins"
[body]
shape = "sphere"
radius = 0.1
mass = 1.0
[initial]
angular_velocity = [0.0, 0.0, 5.0]
[run]
duration = 0.5
samples = 26
"""


figure = st.floats(1e-12, 10.0)


@given(figure, figure, figure, figure)
def test_a_change_is_one_beyond_both_allowances(before: float, after: float, own: float, other: float) -> None:
    found = list(releases.changes([row("1.0", before, own), row("2.0", after, other)]))
    assert bool(found) == (abs(after - before) > own + other)
    for one in found:
        assert (one.quantity, one.before, one.after, one.allowance) == ("attitude_error", before, after, own + other)
        assert (one.from_version, one.to_version, one.timestep) == ("1.0", "2.0", 0.001)
        assert one.factor == max(before, after) / min(before, after)


def test_releases_are_held_against_the_next_that_was_measured() -> None:
    missing = failed("2.0", UNOBTAINABLE, "no wheel")
    (found,) = releases.changes([row("1.0", 0.1), missing, row("3.0", 0.2)])
    assert (found.from_version, found.to_version) == ("1.0", "3.0")
    assert not list(releases.changes([row("1.0", 0.1), missing, row("3.0", 0.1)]))


def test_a_change_is_of_one_method_on_one_case() -> None:
    rows = [row("1.0", 0.1), row("1.0", 0.2, timestep=0.002), row("1.0", 0.3, integrator="Euler"), row("1.0", 0.4, case="top")]
    assert not list(releases.changes(rows))


def test_a_status_that_changes_is_a_change() -> None:
    rows = [failed("1.0", "unsupported"), row("2.0"), failed("3.0", "diverged")]
    found = [(one.quantity, one.before, one.after, one.factor) for one in releases.changes(rows)]
    assert found == [("status", "unsupported", "ok", None), ("status", "ok", "diverged", None)]


def test_a_release_that_fails_in_whatever_way_is_rows_that_say_so() -> None:
    obtained = {
        "1.0": Unobtainable("mujoco 1.0: no wheel"),
        "2.0": Environment("mujoco", "2.0", Path("python")),
        "3.0": Environment("mujoco", "3.0", Path("python")),
        "4.0": Environment("mujoco", "4.0", Path("python")),
    }
    answers = {
        ("2.0", "spin"): Answer(status="crashed", failure="its process died of signal SIGSEGV"),
        ("3.0", "spin"): Answer(("RK4",), rows=(row("of itself"),)),
        ("4.0", "spin"): Answer(("Euler", "RK4"), rows=(row("4.0", integrator="Euler"), row("4.0"))),
    }
    rows = list(releases.rows_of("mujoco", replace(FLIP, name="spin"), obtained, answers))
    assert [(one["integrator"], one["version"], one["status"]) for one in rows] == [
        ("Euler", "1.0", UNOBTAINABLE),
        ("Euler", "2.0", "crashed"),
        ("Euler", "3.0", "unsupported"),
        ("Euler", "4.0", "ok"),
        ("RK4", "1.0", UNOBTAINABLE),
        ("RK4", "2.0", "crashed"),
        ("RK4", "3.0", "ok"),
        ("RK4", "4.0", "ok"),
    ]
    assert [one["reason"] for one in rows[:3]] == [
        "mujoco 1.0: no wheel",
        "its process died of signal SIGSEGV",
        "mujoco@3.0 has no integrator 'Euler' for this scene",
    ]


def test_where_no_release_can_tell_its_methods_there_is_a_row_a_release() -> None:
    obtained = {"1.0": Unobtainable("no wheel"), "2.0": Environment("mujoco", "2.0", Path("python"))}
    answers = {("2.0", FLIP.name): Answer(status="crashed", failure="it died")}
    rows = list(releases.rows_of("mujoco", FLIP, obtained, answers))
    assert [(one["version"], one["status"], one["timestep"]) for one in rows] == [
        ("1.0", UNOBTAINABLE, None),
        ("2.0", "crashed", None),
    ]
    assert not list(releases.changes(rows))
    report = present({"": Found(HEADER, tuple(rows), ())})
    assert report.headline == "No release could be measured"
    assert not report.findings


def test_what_is_written_is_read_again_and_its_columns_are_those_of_results(tmp_path: Path) -> None:
    found = Found(HEADER, (row("1.0"), failed("2.0", "crashed", 'it said "no",\nand died')), (change(),))
    release_rows.write(found, tmp_path / "new")
    read = release_rows.read(tmp_path / "new")
    assert (read.rows, read.changes, read.header["versions"]) == (found.rows, found.changes, HEADER["versions"])
    with (tmp_path / "new" / "changes.csv").open(newline="") as stream:
        head, *lines = csv.reader(stream)
    named = "engine, case, integrator, quantity, from_version, to_version, before, after, factor, order_before, order_after, "
    assert head == [*(named + "scheme_before, scheme_after").split(", "), "timestep", "allowance"]
    assert head == [field.name for field in fields(Change)]
    assert len(lines) == 1
    with (tmp_path / "new" / "releases.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert list(rows[0])[:8] == ["case", "engine", "version", "integrator", "timestep", "status", "passed", "reason"]
    assert list(rows[0])[-1] == "attitude_error_allowance"
    assert (rows[1]["reason"], rows[1]["attitude_error"]) == ('it said "no",\nand died', "")


def test_what_an_entry_holds_that_is_no_answer_counts_as_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path))
    answer = Answer(("RK4",), rows=(row("1.0"),))
    user_cache.keep("measurements/a.json", questions.text_of(answer))
    kept = questions.kept("measurements/a.json")
    assert kept is not None
    assert kept[0] == answer
    for text in ("", "null", "[]", '{"rows": 1}', "[" * 100_000, questions.text_of(answer)[:-10]):
        user_cache.keep("measurements/a.json", text)
        assert questions.kept("measurements/a.json") is None


def test_versions_are_ordered_as_versions_and_named_once() -> None:
    assert releases.chosen("mujoco", ("3.10.0", "3.9", "3.9", "4"), None) == (("3.9", "3.10.0", "4"), ())
    for versions, last in ((("new",), None), ((), None), ((), 0), (("3.1",), -1)):
        with pytest.raises(BadInput, match=r"is not a version|give versions|must be at least 1"):
            releases.chosen("mujoco", versions, last)


def test_without_an_index_the_newest_are_those_that_are_there(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("UV_NO_INDEX", "1")
    with pytest.raises(BadInput, match="cannot be listed"):
        releases.chosen("mujoco", (), 2)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("releases", "mujocco", "3.2.0"), "there is no engine 'mujocco'"),
        (("releases", "mujoco"), "give versions, or the number of newest"),
        (("releases", "mujoco", "newest"), "'newest' is not a version"),
        (("releases", "mujoco", "--remove", "--last", "2"), "--remove cannot be combined with --last"),
        (("releases", "mujoco", "3.2.0", "--case", "nowhere"), "nowhere"),
        (("releases", "mujoco", "3.2.0", "--case", "projectile", "--timestep", "-1"), "time step -1 s: must be positive"),
        (("releases", "mujoco", "3.2.0", "--out", __file__), "the folder cannot be made"),
        (("bisect", "mujoco", "4", "4.0.0", "--case", "projectile", "--quantity", "tilt", "--limit", "1"), "cannot be both"),
    ],
)
def test_what_cannot_be_asked_is_refused_before_anything_is_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str
) -> None:
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    with pytest.raises(BadInput, match=words):
        call(*arguments)
    assert not (tmp_path / "cache" / "environments").exists()


@pytest.fixture
def index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of wheels that is all there is to install from: a miniature engine that is exact, then drifts."""
    wheels.plugin(tmp_path / "plugin")
    wheels.wheel(tmp_path / "wheels", "1.0")
    wheels.wheel(tmp_path / "wheels", "2.0", 'KIND = "drifting"')
    for folder in (MINIATURES, tmp_path / "plugin"):
        monkeypatch.syspath_prepend(folder)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join((str(MINIATURES), str(tmp_path / "plugin"))))  # for processes of their own
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path / "wheels"))
    monkeypatch.setenv("UV_CACHE_DIR", str(tmp_path / "uv"))
    return tmp_path / "wheels"


@pytest.fixture
def spin(tmp_path: Path) -> Path:
    path = tmp_path / "spin.case.toml"
    path.write_text(SPIN)
    return path


METHOD = ("--integrator", "closed-form", "--timestep", "0.002")


@pytest.mark.slow
def test_a_miniature_engine_through_its_releases(
    index: Path, spin: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limit = ("--case", spin, *METHOD, "--quantity", "angular_velocity_error", "--limit", "1e-6", "--jobs", "1", "--json")
    assert call("bisect", "toy", "1.0", "2.0", *limit) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["last_good"], found["first_bad"], found["made"]) == ("1.0", "2.0", 2)
    # One per mille of 5 rad/s a second, after half a second.
    assert [look["figure"] for look in found["looks"]] == [pytest.approx(0, abs=1e-12), pytest.approx(2.5e-3, rel=1e-9)]

    shutil.rmtree(index)  # from here on there is nothing to install from
    with pytest.raises(BadInput, match="exchange the two"):
        call("bisect", "toy", "2.0", "1.0", *limit)
    assert call("bisect", "toy", "1.0", "2.0", *limit) == 1  # between them there may be others
    said = capsys.readouterr()
    assert json.loads(said.out) == found | {"made": 0}
    assert "cannot be listed" in said.err

    asked = ("releases", "toy", "1.0", "3.0", "--case", spin, *METHOD, "--jobs", "1", "--out", tmp_path / "out", "--json")
    assert call(*asked) == 1  # 3.0 cannot be had
    told = json.loads(capsys.readouterr().out)
    today = f"{datetime.now(UTC):%Y-%m-%d}"
    assert told["took"] == {"made": 0, "measured": 0, "known": 1, "since": today}
    assert [(one["version"], one["status"]) for one in told["rows"]] == [("1.0", "ok"), ("3.0", UNOBTAINABLE)]
    assert not told["changes"]
    names = {"releases.csv", "changes.csv", "releases.jsonl", "report.html", "report.md"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == names | {
        "releases.csv-metadata.json",
        "changes.csv-metadata.json",
    }
    assert "3.0 was not measured" in (tmp_path / "out" / "report.md").read_text()

    results = bodycheck.releases("toy", ["1.0", "2.0"], case=spin, integrator="closed-form", timestep=0.002, jobs=1)
    assert repr(results) == f"<ReleasesResults: {results.headline}>"
    assert (results.versions, list(results.tables)) == (("1.0", "2.0"), ["releases", "changes"])
    assert list(results.to_frame()["version"]) == ["1.0", "2.0"]
    assert {change.to_version for change in results.changes} == {"2.0"}

    assert call("releases", "toy", "--remove") == 0
    assert "removed 1.0, 2.0" in capsys.readouterr().out


#: The body of an engine whose process dies where a file exists.
MORTAL = """KIND = "exact"
import os
if os.path.exists({file!r}):
    os.kill(os.getpid(), 9)
"""


def test_what_died_is_not_kept_and_again_replaces_what_is(
    index: Path, spin: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    deadly = tmp_path / "deadly"
    wheels.wheel(index, "4.0", MORTAL.format(file=str(deadly)))
    command = ("releases", "toy", "4.0", "--case", spin, *METHOD, "--jobs", "1", "--json")

    def took(*options: str) -> tuple[int, list[str], dict[str, object]]:
        code = call(*command, *options)
        document = json.loads(capsys.readouterr().out)
        return code, [one["status"] for one in document["rows"]], document["took"]

    environments.obtain("toy", "4.0")
    deadly.touch()
    assert took() == (1, ["crashed"], {"made": 0, "measured": 1, "known": 0, "since": ""})
    deadly.unlink()
    assert not user_cache.times("measurements")
    assert took() == (0, ["ok"], {"made": 0, "measured": 1, "known": 0, "since": ""})
    (entry,) = (tmp_path / "cache" / "measurements").iterdir()
    deadly.touch()
    assert took("--again")[1] == ["crashed"]
    assert not entry.exists()


@pytest.mark.slow
def test_a_study_that_is_killed_goes_on_and_finds_what_changed(index: Path, spin: Path, tmp_path: Path) -> None:
    wheels.wheel(index, "1.5")
    command = [sys.executable, "-m", "bodycheck", "releases", "toy", "--last", "3", "--case", spin, "--json"]
    took: list[dict[str, int]] = []
    for patience in (2.0, 5.0, 9.0, 14.0, None):
        with subprocess.Popen(list(map(str, command)), stdout=PIPE, stderr=DEVNULL, text=True) as study:
            try:
                text, _ = study.communicate(timeout=patience)
            except subprocess.TimeoutExpired:
                study.kill()
                continue
        found = json.loads(text)
        took.append(found["took"])
    assert [one["version"] for one in found["rows"]] == ["1.0", "1.5", "2.0"]
    assert {(one["from_version"], one["to_version"]) for one in found["changes"]} == {("1.5", "2.0")}
    assert "angular_velocity_error" in {one["quantity"] for one in found["changes"]}
    answers = 3 + 2  # the figures of three releases, the orders of two
    assert took[-1]["measured"] + took[-1]["known"] == answers
    again = subprocess.run(list(map(str, command)), stdout=PIPE, stderr=DEVNULL, text=True, check=True)
    again_took = json.loads(again.stdout)["took"]
    assert again_took == {"made": 0, "measured": 0, "known": answers, "since": again_took["since"]}
    assert json.loads(again.stdout)["changes"] == found["changes"]


@pytest.mark.slow
def test_what_mujoco_4_changed_of_a_tumbling_box(tmp_path: Path) -> None:
    """Its Runge-Kutta scheme, and of its implicit ones the fast one; see docs/howto/compare-releases.md."""
    try:
        environments.releases("mujoco")
    except Unobtainable as error:
        pytest.skip(str(error))
    case = ("--case", "osrf-boxes-complex", "--timestep", "0.001", "--out", tmp_path)
    assert call("releases", "mujoco", "3.16.0", "3.17.0", "4.0.0", *case) == 0
    found = release_rows.read(tmp_path)
    assert {(one.from_version, one.to_version) for one in found.changes} == {("3.17.0", "4.0.0")}
    (rk4,) = [one for one in found.changes if one.integrator == "RK4" and one.quantity == "attitude_error"]
    assert (round(rk4.order_before or 0), round(rk4.order_after or 0)) == (2, 4)
    assert (rk4.scheme_before, rk4.scheme_after) == ("averaged Runge-Kutta 4", "Runge-Kutta-Munthe-Kaas 4")


def test_the_workflow_is_one() -> None:
    workflow = yaml.safe_load((ROOT / "docs/ci/bodycheck-releases.yml").read_text())
    (job,) = workflow["jobs"].values()
    assert workflow[True]["schedule"]  # YAML 1.1 takes the key `on` for a truth value
    assert workflow["permissions"] == {"contents": "read", "issues": "write"}
    assert {entry["engine"] for entry in job["strategy"]["matrix"]["include"]} == {"mujoco", "pinocchio"}
    scripts = [step["run"] for step in job["steps"] if "run" in step]
    for script in scripts:
        subprocess.run(["bash", "-n"], input=script, text=True, check=True)
    assert any("bodycheck releases" in script for script in scripts)
    assert all("uses" in step or "run" in step for step in job["steps"])
