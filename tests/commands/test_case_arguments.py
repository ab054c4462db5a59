"""Commands take folders and patterns of case files, and never fall back to the shipped cases."""

import io
import json
import os
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from bodycheck.console import output
from tests.support import ROOT
from tests.support.commands import bodycheck

ONE = (ROOT / "cases" / "free-brick.case.toml").read_text("utf-8").partition("[[expect]]")[0]


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository with two case files in a folder."""
    (tmp_path / "physics").mkdir()
    for name in ("first", "second"):
        (tmp_path / "physics" / f"{name}.case.toml").write_text(ONE.replace('"free-brick"', f'"{name}"'))
    return tmp_path


@pytest.mark.parametrize("argument", [".", "physics", "physics/*.case.toml", "**/*.case.toml"])
def test_folders_and_patterns_are_cases(repository: Path, argument: str) -> None:
    done = bodycheck("validate", argument, folder=repository)
    assert (done.returncode, done.stdout.split()) == (0, ["first:", "valid", "second:", "valid"])


@pytest.mark.parametrize("command", ["run", "tradeoff", "extremes", "ablate", "validate", "expect"])
@pytest.mark.parametrize("argument", [".", "*.case.toml"])
def test_where_there_are_no_case_files_nothing_is_run(tmp_path: Path, command: str, argument: str) -> None:
    done = bodycheck(command, argument, folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"{argument}: ")
    assert "no case file" in done.stderr


def test_one_case_is_not_several(repository: Path) -> None:
    done = bodycheck("truth", ".", folder=repository)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        ".: stands for 2 cases, of which one is needed: physics/first.case.toml, physics/second.case.toml, …\n"
    )


def test_failures_in_a_folder_are_annotated_in_its_files(repository: Path, calls_here: None) -> None:
    case = repository / "physics" / "first.case.toml"
    limit = '[[expect]]\nengine = "mujoco"\nintegrator = "Euler"\ntimestep = 0.1\nposition_error = 1e-12\n'
    case.write_text(case.read_text().replace("duration = 10", "duration = 1") + limit)
    done = bodycheck("run", "physics", "--integrator", "Euler", "--timestep", "0.1", folder=repository, GITHUB_ACTIONS="true")
    assert done.returncode == 1
    assert "::error file=physics/first.case.toml,line=" in done.stderr


def test_a_name_without_its_end_means_the_file_in_this_folder(repository: Path) -> None:
    done = bodycheck("run", "first", folder=repository / "physics")
    assert done.returncode == 2
    assert done.stderr == "first: there is no such file, and no shipped case of this name; did you mean 'first.case.toml'?\n"


def test_a_message_about_a_missing_file_does_not_list_all_shipped_cases() -> None:
    done = bodycheck("run", "nobody-called-it-so")
    told = "there is no such file, and no shipped case of this name; `bodycheck cases` lists the shipped cases"
    assert (done.returncode, done.stderr) == (2, f"nobody-called-it-so: {told}\n")


@pytest.mark.parametrize("inside", [False, True])
def test_a_folder_whose_name_is_not_utf_8_takes_results(repository: Path, calls_here: None, inside: bool) -> None:
    folder = repository / os.fsdecode(b"o\xe9")
    folder.mkdir()
    case = (repository / "physics" / "first.case.toml").rename(folder / "first.case.toml")
    case.write_text(case.read_text().replace("duration = 10", "duration = 1"))
    paths = ("first.case.toml", "out") if inside else (case, folder / "out")
    command = ("run", paths[0], "--engine", "mujoco", "--integrator", "RK4", "--out", paths[1])
    assert bodycheck(*command, folder=folder if inside else None).returncode == 0
    assert {"results.json", "results.parquet", "report.html"} <= {path.name for path in (folder / "out").iterdir()}
    if not inside:
        assert json.dumps(r"o\xe9/out")[1:-1] in (folder / "out" / "results.json").read_text("utf-8")


def test_a_line_has_substitutes_for_what_an_encoding_lacks() -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    with redirect_stdout(stream):
        output.say("1e-5 → 0.02 · n×m …é")
    stream.seek(0)
    assert stream.read() == "1e-5 -> 0.02 - nxm ...?\n"
