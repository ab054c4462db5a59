"""What CI systems read of a run: JUnit XML, GitHub's annotations, the summary of a step."""

import re
from dataclasses import replace
from datetime import date
from pathlib import Path
from xml.etree import ElementTree

import pytest

from bodycheck import Case, simulate
from bodycheck.casefile.case import parse
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.processes.failures import Crashed
from bodycheck.reports.runs import github, junit
from tests.support.commands import Done, bodycheck
from tests.support.truths import truth_for_runs

SPIN = """\
format = 1
name = "spin"
title = "A spin"
[body]
shape = "sphere"
radius = 0.1
mass = 1.0
[initial]
velocity = [1.0, 0.0, 0.0]
angular_velocity = [0.0, 0.0, 5.0]
[run]
duration = 0.5
samples = 6
"""
METHOD = '[[expect]]\nengine = "mujoco"\nintegrator = "RK4"\ntimestep = 0.01\n'
HELD, BROKEN = METHOD + "position_error = 1.0\n", METHOD + "position_error = 0.0\n"
KNOWN = METHOD + 'attitude_error = {at_least = 1.0}\nknown = "https://example.org/7"\nuntil = "2027-01-01"\n'
HEADER = {"bodycheck": "0.1", "started": "2026-11-01T00:00:00+00:00", "engines": {"mujoco": "4"}}
HOSTILE = "\x00\x1b[2J]]>&<\"'\x85\ud800\ufffe\n::error::x%0A,:\r"


def judged(text: str) -> tuple[Case, Verdict]:
    case = parse(SPIN + text, "spin")
    return case, judgement.verdict(
        case, truth_for_runs(case, 0.01), simulate(case, "mujoco", "RK4", 0.01), today=date(2026, 12, 1)
    )


def crashed(reason: str) -> Verdict:
    """A verdict on a run of which nothing was expected."""
    case, verdict = judged("")
    run = replace(verdict.run, outcome=Crashed(reason))
    return judgement.verdict(case, truth_for_runs(case, 0.01), run)


def read(verdicts: list[Verdict]) -> ElementTree.Element:
    return ElementTree.fromstring(junit.render(verdicts, HEADER))


def test_a_test_for_each_run_of_which_something_was_expected() -> None:
    verdicts = [judged(text)[1] for text in (HELD, BROKEN, KNOWN, "")]
    root = read([*verdicts, crashed("it died")])
    (suite,) = root
    assert suite.attrib | {"time": ""} == {
        "name": "bodycheck",
        "timestamp": HEADER["started"],
        "time": "",
        "tests": "4",
        "failures": "2",
        "errors": "0",
        "skipped": "0",
    }
    held, broken, known, dead = suite.findall("testcase")
    assert {test.get("classname") for test in (held, broken, known, dead)} == {"spin"}
    assert {test.get("name") for test in (held, broken, known, dead)} == {"mujoco RK4 0.01 s"}
    row = verdicts[0].row()
    told = {entry.get("name"): entry.get("value") for entry in held.findall("properties/property")}
    assert told == {name: str(value) for name, value in row.items() if name not in ("case", "passed", "reason")}
    # Written with six decimals.
    assert float(held.get("time") or "nan") == pytest.approx(row["wall_time"], abs=1e-6)
    assert [child.tag for child in held] == ["properties"]
    failure = broken.find("failure")
    assert failure is not None
    assert failure.get("message") == verdicts[1].reason
    reason, *advice = (failure.text or "").splitlines()
    assert reason == verdicts[1].reason
    assert advice[1] == (
        "to accept what is measured now, if it is right: "
        "bodycheck expect spin --engine mujoco --integrator RK4 --timestep 0.01 --figure position_error"
    )
    assert "position_error is " in verdicts[1].reason
    assert [child.tag for child in known] == ["properties", "system-out"]
    assert (known.findtext("system-out") or "").startswith("known until 2027-01-01 (https://example.org/7): attitude_error is")
    assert (dead.find("failure") is not None, dead.findtext("failure")) == (True, "it died")
    versions = {entry.get("name"): entry.get("value") for entry in suite.findall("properties/property")}
    assert versions == {"version of bodycheck": "0.1", "version of mujoco": "4"}


def test_no_string_from_outside_breaks_the_document() -> None:
    verdict = crashed(HOSTILE)
    text = junit.render([replace(verdict, run=replace(verdict.run, engine=HOSTILE, version=HOSTILE))], HEADER)
    assert text.encode("utf-8").decode("utf-8") == text
    assert re.findall("[^\n\r\x20-\x7e\x85]", text) == []
    (failure,) = ElementTree.fromstring(text).iter("failure")
    assert (failure.text or "").startswith("\\x00\\x1b[2J]]>&<\"'")
    assert "\\ud800\\ufffe" in (failure.text or "")


def lines_of(case: Case, verdict: Verdict, **environment: str) -> list[str]:
    return list(github.annotations([verdict], {case.name: case}, {case.name: Path("cases/spin.case.toml")}, environment))


def test_an_annotation_stands_at_the_expectation() -> None:
    case, verdict = judged(HELD + BROKEN + KNOWN)
    broken, known = lines_of(case, verdict)
    places = [SPIN.count("\n") + text.count("\n") + 1 for text in (HELD, HELD + BROKEN)]
    title = "title=mujoco RK4%2C 0.01 s%2C on spin"
    assert broken.startswith(f"::error file=cases/spin.case.toml,line={places[0]},{title}::position_error is ")
    assert "%0Ato accept what is measured now, if it is right: bodycheck expect " in broken, "what to do next"
    assert "%0A" not in known
    assert known.startswith(f"::notice file=cases/spin.case.toml,line={places[1]},{title}::known until 2027-01-01 ")
    assert lines_of(*judged(HELD)) == []
    dead = lines_of(case, crashed("it died"))
    assert dead == [f"::error file=cases/spin.case.toml,{title}::it died"]
    (shipped,) = github.annotations([crashed("it died")], {case.name: case}, {}, {})
    assert shipped == f"::error {title}::it died"


def test_files_are_as_seen_from_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case, verdict = judged(BROKEN)
    inside = tmp_path / "robots"
    inside.mkdir()
    monkeypatch.chdir(inside)
    (line,) = lines_of(case, verdict, GITHUB_WORKSPACE=str(tmp_path))
    assert line.startswith("::error file=robots/cases/spin.case.toml,line=14,")


def test_an_annotation_is_one_command_whatever_it_says() -> None:
    line = github.annotation("error", HOSTILE, HOSTILE, HOSTILE, 3)
    assert not re.search("[\r\n]", line)
    assert line.count("::error") == 2, "the command, and what the text says within it"
    head, _, message = line.removeprefix("::error ").partition("::")
    assert [entry.partition("=")[0] for entry in head.split(",")] == ["file", "line", "title"]
    assert message.endswith("%0A::error::x%250A,:%0D")


def test_a_summary_has_only_whole_lines_that_fit(tmp_path: Path) -> None:
    path = tmp_path / "summary.md"
    environment = {"GITHUB_STEP_SUMMARY": str(path)}
    text = "".join(f"line {number} with an é\n" for number in range(20_000))
    github.add_summary(environment, text)
    assert path.read_text() == text
    for _ in range(3):
        github.add_summary(environment, text)
    content = path.read_bytes()
    assert github.LARGEST_SUMMARY - 100 < len(content) <= github.LARGEST_SUMMARY
    kept, _, rest = content.decode().rpartition("\n*The rest was cut")
    assert (text * 3).startswith(kept + "\n")
    assert rest == " because the summary of a step has a limited size.*\n"
    github.add_summary({}, text)


@pytest.fixture
def workflow(tmp_path: Path) -> dict[str, str]:
    return {"GITHUB_ACTIONS": "true", "GITHUB_WORKSPACE": str(tmp_path), "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}


def run(folder: Path, *arguments: object, **environment: str) -> Done:
    return bodycheck("run", *arguments, "--engine", "mujoco", "--integrator", "RK4", folder=folder, **environment)


def test_a_step_of_a_workflow(calls_here: None, tmp_path: Path, workflow: dict[str, str]) -> None:
    (tmp_path / "spin.case.toml").write_text(SPIN + HELD + BROKEN)
    done = run(tmp_path, "spin.case.toml", "projectile", "--junit", "junit.xml", "--json", **workflow)
    assert done.returncode == 1
    (line,) = [line for line in done.stderr.splitlines() if line.startswith("::")]
    assert line.startswith("::error file=spin.case.toml,line=19,title=mujoco RK4%2C 0.01 s%2C on spin::position_error is ")
    assert "::" not in done.stdout
    summary = (tmp_path / "summary.md").read_text()
    assert summary.startswith("# bodycheck: 1 of ")
    assert "Failed runs" in summary
    assert ElementTree.parse(tmp_path / "junit.xml").getroot().get("failures") == "1"


def test_elsewhere_nothing_is_annotated(calls_here: None, tmp_path: Path, workflow: dict[str, str]) -> None:
    (tmp_path / "spin.case.toml").write_text(SPIN + BROKEN)
    done = run(tmp_path, "spin.case.toml", **workflow | {"GITHUB_ACTIONS": ""})
    assert done.returncode == 1
    assert "::error" not in done.stderr + done.stdout
    assert not (tmp_path / "summary.md").exists()


def test_a_file_that_cannot_be_there_is_told_before_anything_runs(tmp_path: Path) -> None:
    for option in ("--junit", "--save"):
        for path, words in ((tmp_path, "is a folder"), (tmp_path / "nowhere" / "file", "there is no folder")):
            done = run(tmp_path, "projectile", option, path)
            assert done.returncode == 2
            assert f"{option} {path}: {words}" in done.stderr
            assert "projectile ·" not in done.stderr
