"""The study of releases: what it calls a change, what it says of releases that fail, and that it says what was measured."""

import csv
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from subprocess import DEVNULL, PIPE
from typing import Any

import pytest
import vl_convert
import yaml
from hypothesis import given
from hypothesis import strategies as st

from bodycheck import load
from bodycheck.commands import command_line
from bodycheck.environments import environments
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.errors import BadInput
from bodycheck.reports import html, markdown
from bodycheck.studies.releases import rows as release_rows
from bodycheck.studies.releases import study as releases
from bodycheck.studies.releases.page import present
from bodycheck.studies.releases.questions import Answer, store, stored
from bodycheck.studies.releases.rows import UNOBTAINABLE, Change, Found
from tests.support import MINIATURES, ROOT, pages, wheels

FLIP = load("intermediate-axis-flip")
HEADER = {
    "bodycheck": "0",
    "started": "2026-01-01T00:00:00+00:00",
    "command": ["bodycheck", "releases", "<b>"],
    "machine": {"processor": "abacus", "system": "wood"},
    "packages": {},
    "engines": {"mujoco": "1.0 to 3.0"},
    "missing": {},
    "versions": ["1.0", "2.0", "3.0"],
    "cases": {"spin": "0"},
    "unmeasured": {},
    "notices": [],
}

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

Row = dict[str, Any]


def row(version: str, error: float = 0.1, allowance: float = 1e-9, **others: Any) -> Row:
    known = {"case": "spin", "engine": "mujoco", "version": version, "integrator": "RK4", "timestep": 0.001, "status": "ok"}
    figures = {"attitude_error": error, "attitude_error_allowance": allowance, "truth_error": 1e-14}
    return {**known, "reason": "", **figures, **others}


def failed(version: str, status: str, reason: str = "why", **others: Any) -> Row:
    return {name: value for name, value in row(version, **others).items() if not name.startswith("attitude")} | {
        "status": status,
        "reason": reason,
    }


def change(**others: Any) -> Change:
    known = Change("mujoco", "spin", "RK4", "attitude_error", "1.0", "2.0", 2e-5, 3e-9, 6667.0, 2.0, 4.0, "", "", 0.001, 1e-10)
    return replace(known, **others)


def told(changes: Sequence[Change], rows: Sequence[Row] = (row("1.0", 2e-5), row("2.0", 3e-9))) -> list[str]:
    return [finding.text for finding in present({"": Found(HEADER, tuple(rows), tuple(changes))}).findings]


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
        "mujoco 3.0 has no integrator 'Euler' for this scene",
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


def test_half_an_answer_is_none(tmp_path: Path) -> None:
    answer = Answer(("RK4",), rows=(row("1.0"),))
    path = tmp_path / "deep" / "answer.json"
    assert stored(path) is None
    store(answer, path)
    assert stored(path) == answer
    assert [file.name for file in path.parent.iterdir()] == ["answer.json"]
    path.write_text(path.read_text()[:-10])
    assert stored(path) is None


def test_an_order_that_changed_is_told_in_words() -> None:
    assert told([change(before=2.1e-5, after=3.3e-9)]) == [
        "Between 1.0 and 2.0, RK4 went from second to fourth order in attitude: "
        "the attitude error changed from 2.1e-5 to 3.3e-9 rad on spin at 1 ms."
    ]
    named = change(integrator="RK4", scheme_before="averaged Runge-Kutta 4", scheme_after="Runge-Kutta-Munthe-Kaas 4")
    assert "in attitude and from averaged Runge-Kutta 4 to Runge-Kutta-Munthe-Kaas 4: " in told([named])[0]


def test_a_change_without_another_order_is_told_by_its_scheme_or_its_figure() -> None:
    same = change(before=0.683, after=0.659, order_before=1.02, order_after=0.98, factor=1.04)
    assert told([same]) == ["Between 1.0 and 2.0, the attitude error of RK4 changed from 0.683 to 0.659 rad on spin at 1 ms."]
    scheme = replace(same, scheme_before="semi-implicit Euler", scheme_after="linearly implicit Euler")
    assert told([scheme]) == [
        "Between 1.0 and 2.0, RK4 went from semi-implicit Euler to linearly implicit Euler: "
        "the attitude error changed from 0.683 to 0.659 rad on spin at 1 ms."
    ]
    close = change(before=0.1234567, after=0.1234568, order_before=None)
    assert "0.1234567 to 0.1234568 rad" in told([close])[0] or "0.123457 to 0.123457" not in told([close])[0]


def test_one_sentence_a_method_and_upgrade_with_what_says_most() -> None:
    more = [
        change(quantity="energy_drift", order_before=None, factor=1e9),
        change(),
        change(case="top", factor=2.0),
        change(case="top", factor=2.0, timestep=0.002),
    ]
    (sentence,) = told(more)
    assert sentence.endswith(
        "in attitude: the attitude error changed from 2e-5 to 3e-9 rad on spin at 1 ms. 1 other case changed too."
    )
    later = change(from_version="2.0", to_version="10.0")
    first, second, third = told([later, change(), change(integrator="implicit"), change(integrator="Euler", after=4e-9)])
    assert first.startswith("Between 1.0 and 2.0, RK4 and implicit went from second to fourth order in attitude: ")
    assert "from 2e-5 to 3e-9" in first
    assert second.startswith("Between 1.0 and 2.0, Euler went from second to fourth order in attitude: ")
    assert "from 2e-5 to 4e-9 rad on spin" in second
    assert third.startswith("Between 2.0 and 10.0, RK4 went")


def test_what_came_or_went_is_told_together() -> None:
    gone = change(quantity="status", before="unsupported", after="ok", factor=None, order_before=None, order_after=None)
    assert told([gone, replace(gone, integrator="Euler"), replace(gone, case="top")]) == [
        "Between 1.0 and 2.0, the status of runs with RK4 and Euler changed from unsupported to ok on spin and 1 other case."
    ]


def test_that_nothing_changed_is_told() -> None:
    assert told([]) == ["2 runs of 2 releases agree to within rounding."]
    assert not told([], [row("1.0")])


def test_what_could_not_be_measured_is_said_first() -> None:
    header = HEADER | {"unmeasured": {"2.0": "no wheel"}, "notices": ["no index"]}
    report = present({"": Found(header, (row("1.0"), failed("2.0", UNOBTAINABLE)), ())})
    assert report.notices == ("no index.", "2.0 was not measured: no wheel.")


def found_on(machine: str, error: float = 3e-9) -> Found:
    hostile = failed("3.0", "crashed", pages.HOSTILE)
    header = HEADER | {"machine": HEADER["machine"] | {"processor": machine}}
    return Found(header, (row("1.0", 2e-5), row("2.0", error), hostile), (change(after=error),))


@pytest.mark.parametrize("machines", [("abacus",), ("abacus", "slide rule"), ("abacus", "abacus")])
def test_the_report_of_one_machine_or_two(machines: tuple[str, ...]) -> None:
    found = [found_on(machine) for machine in machines]
    labels = release_rows.labels(found)
    report = present(dict(zip(labels, found, strict=True)))
    expected = {("abacus",): [""], ("abacus", "slide rule"): ["abacus", "slide rule"]}.get(machines, ["machine 1", "machine 2"])
    assert labels == expected
    (part,) = report.parts
    assert [line.results for line in part.lines] == expected
    (finding,) = report.findings  # what is the same on both machines is said once
    assert [f"RK4 ({label})" in finding.text for label in labels] == list(map(bool, labels))
    page, text = html.render_study(report), markdown.render_study(report)
    pages.check(page)
    for label in filter(None, labels):
        assert label in pages.Page(page).text
        assert label in text


def test_studies_of_different_cases_are_not_merged() -> None:
    one = found_on("abacus")
    other = replace(one, header=one.header | {"cases": {"spin": "1"}})
    with pytest.raises(BadInput, match="spin: the case differs"):
        present({"one": one, "other": other})
    with pytest.raises(BadInput, match="different engines"):
        present({"one": one, "other": replace(one, header=one.header | {"engines": {"pinocchio": "1.0"}})})


def test_reports_are_made_again_from_what_is_saved(tmp_path: Path) -> None:
    for machine in ("abacus", "slide rule"):
        release_rows.write(found_on(machine), tmp_path / machine)
    assert bodycheck("report", tmp_path / "abacus", tmp_path / "slide rule", "--out", tmp_path / "both") == 0
    assert "RK4 (abacus) and RK4 (slide rule)" in (tmp_path / "both" / "report.md").read_text()
    assert bodycheck("report", tmp_path / "abacus") == 0
    assert "Between 1.0 and 2.0, RK4 went" in (tmp_path / "abacus" / "report.md").read_text()
    saved = tmp_path / "abacus" / "releases.jsonl"
    saved.write_text("\n".join(saved.read_text().splitlines()[:-1]) + "\n")
    with pytest.raises(BadInput, match="was interrupted"):
        bodycheck("report", tmp_path / "abacus")


def test_the_chart_has_a_line_a_method_and_a_ring_where_it_changed() -> None:
    rows = [row("1.0", 2e-5), row("2.0", 3e-9), failed("10.0", "crashed"), row("11.0", 3e-9)]
    header = HEADER | {"versions": ["1.0", "2.0", "10.0", "11.0"]}
    report = present({"": Found(header, tuple(rows), (change(),))})
    (chart,) = report.parts[0].charts
    (layer,) = chart.specification["layer"]
    values = layer["data"]["values"]
    assert [(one["version"], one["value"], one["changed"]) for one in values] == [
        ("1.0", 2e-5, False),
        ("2.0", 3e-9, True),
        ("10.0", None, False),
        ("11.0", 3e-9, False),
    ]
    assert layer["encoding"]["x"]["sort"] == ["1.0", "2.0", "10.0", "11.0"]
    svg = vl_convert.vegalite_to_svg(json.dumps(chart.specification))
    # The line is broken at the release without a figure, and one symbol is a ring.
    assert svg.count('stroke-width="1.6"') == 1
    assert chart.alt.endswith("mujoco RK4 from 2e-5 to 3e-9 at 2.0.")


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


def bodycheck(*arguments: object) -> int:
    """The exit code of the command, in this process. Raises `BadInput`."""
    code = command_line.app(list(map(str, arguments)), exit_on_error=False, print_error=False, result_action="return_value")
    assert isinstance(code, int)
    return code


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
        bodycheck(*arguments)
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


def test_a_miniature_engine_through_its_releases(
    index: Path, spin: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limit = ("--case", spin, *METHOD, "--quantity", "angular_velocity_error", "--limit", "1e-6", "--json")
    assert bodycheck("bisect", "toy", "1.0", "2.0", *limit) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["last_good"], found["first_bad"], found["made"]) == ("1.0", "2.0", 2)
    # One per mille of 5 rad/s a second, after half a second.
    assert [look["figure"] for look in found["looks"]] == [pytest.approx(0, abs=1e-12), pytest.approx(2.5e-3, rel=1e-9)]

    shutil.rmtree(index)  # from here on there is nothing to install from
    with pytest.raises(BadInput, match="exchange the two"):
        bodycheck("bisect", "toy", "2.0", "1.0", *limit)
    assert bodycheck("bisect", "toy", "1.0", "2.0", *limit) == 1  # between them there may be others
    said = capsys.readouterr()
    assert json.loads(said.out) == found | {"made": 0}
    assert "cannot be listed" in said.err

    asked = ("releases", "toy", "1.0", "3.0", "--case", spin, *METHOD, "--out", tmp_path / "out", "--json")
    assert bodycheck(*asked) == 1  # 3.0 cannot be had
    told = json.loads(capsys.readouterr().out)
    assert told["took"] == {"made": 0, "measured": 0, "known": 1}
    assert [(one["version"], one["status"]) for one in told["rows"]] == [("1.0", "ok"), ("3.0", UNOBTAINABLE)]
    assert not told["changes"]
    names = {"releases.csv", "changes.csv", "releases.jsonl", "report.html", "report.md"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == names
    assert "3.0 was not measured" in (tmp_path / "out" / "report.md").read_text()

    assert bodycheck("releases", "toy", "--remove") == 0
    assert "removed 1.0, 2.0" in capsys.readouterr().out


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
    assert json.loads(again.stdout)["took"] == {"made": 0, "measured": 0, "known": answers}
    assert json.loads(again.stdout)["changes"] == found["changes"]


@pytest.mark.slow
def test_what_mujoco_4_changed_of_a_tumbling_box(tmp_path: Path) -> None:
    """Its Runge-Kutta scheme, and of its implicit ones the fast one; see docs/releases.md."""
    try:
        environments.releases("mujoco")
    except Unobtainable as error:
        pytest.skip(str(error))
    case = ("--case", "osrf-boxes-complex", "--timestep", "0.001", "--out", tmp_path)
    assert bodycheck("releases", "mujoco", "3.16.0", "3.17.0", "4.0.0", *case) == 0
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
