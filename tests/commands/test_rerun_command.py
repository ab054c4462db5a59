"""Results are made again, and their numbers are compared beyond rounding."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support import journals
from tests.support.cases import a_case
from tests.support.commands import bodycheck

#: A brick that tumbles for half a second.
TUMBLING = a_case(
    "tumbling",
    title="A brick that tumbles",
    body={"shape": "brick", "semi_axes": [0.1, 0.2, 0.3], "mass": 1.0},
    initial={"angular_velocity": [1.0, 2.0, 3.0]},
    run={"duration": 0.5, "samples": 11},
)


@pytest.fixture
def folder(tmp_path: Path, calls_here: None) -> Path:
    """The results of two methods on a case whose file is gone."""
    case, out = tmp_path / "tumbling.case.toml", tmp_path / "out"
    case.write_text(TUMBLING, "utf-8")
    methods = ("--engine", "mujoco", "--integrator", "Euler", "--integrator", "RK4", "--timestep", 0.01)
    assert bodycheck("run", case, *methods, "--out", out, "--quiet").returncode == 0
    case.unlink()
    return out


def changed(folder: Path, change: Callable[[dict[str, object]], object]) -> None:
    """Change the row of Euler's method in results.json."""
    document = json.loads((folder / "results.json").read_text("utf-8"))
    change(document["runs"][0])
    (folder / "results.json").write_text(json.dumps(document), "utf-8")


def test_the_same_runs_have_the_same_results(folder: Path, tmp_path: Path) -> None:
    done = bodycheck("rerun", folder / "results.json", "--out", tmp_path / "again")
    assert (done.returncode, done.stdout) == (0, "no change in 2 runs beyond rounding and the truth's own error\n")
    first, second = (json.loads((out / "results.json").read_text("utf-8"))["runs"] for out in (folder, tmp_path / "again"))
    timed = dict.fromkeys(("wall_time", "time_per_step", "realtime_factor"))
    assert [{**row, **timed} for row in first] == [{**row, **timed} for row in second]
    assert bodycheck("rerun", folder, "--quiet").stdout == ""


def test_a_number_that_differs_beyond_rounding_is_told(folder: Path) -> None:
    # A step of Euler's method has an error of some 1e-3 rad; rounding has some 1e-14 rad.
    changed(folder, lambda row: row.update(attitude_error=row["attitude_error"] * (1 + 1e-6)))  # type: ignore[operator]
    done = bodycheck("rerun", folder, "--json")
    assert done.returncode == 1
    (change,) = json.loads(done.stdout)["changes"]
    assert (change["what"], change["integrator"]) == ("attitude_error", "Euler")
    assert "attitude_error" in bodycheck("rerun", folder).stdout


def test_rounding_is_no_difference(folder: Path) -> None:
    changed(folder, lambda row: row.update(attitude_error=row["attitude_error"] * (1 + 1e-15)))  # type: ignore[operator]
    done = bodycheck("rerun", folder)
    assert (done.returncode, done.stdout) == (0, "no change in 2 runs beyond rounding and the truth's own error\n")


def test_a_status_that_differs_is_told(folder: Path) -> None:
    changed(folder, lambda row: row.update(status="diverged", attitude_error=None))
    done = bodycheck("rerun", folder)
    assert done.returncode == 1
    assert "status diverged → ok" in done.stdout


def test_what_bodycheck_did_not_write_is_refused(folder: Path, tmp_path: Path) -> None:
    path = folder / "results.json"
    text = path.read_text("utf-8")

    def refused(content: str) -> str:
        path.write_text(content, "utf-8")
        done = bodycheck("rerun", path)
        assert (done.returncode, done.stdout) == (2, "")
        return done.stderr

    assert "damaged" in refused(text[:-20])
    assert "damaged" in refused("[]")
    assert "damaged" in refused(text.replace('"attitude_error": ', '"attitude_error": "x", "y": ', 1))
    assert "does not list the same runs" in refused(re.sub(r'"timestep": 0.01\b', '"timestep": 0.02', text))
    assert "read 2 as the format; allowed: 1" in refused(text.replace('"format": 1', '"format": 2'))
    assert "allowed: the results of one command that came to its end" in refused(text.replace("true", "false"))
    path.unlink()
    assert bodycheck("rerun", folder).returncode == 2
    assert "there is no such folder" in bodycheck("rerun", tmp_path / "nowhere" / "results.json").stderr
    assert "allowed: a results.json" in bodycheck("rerun", folder / "results.csv").stderr
    assert "is the folder of the results" in bodycheck("rerun", folder, "--out", folder).stderr


def test_an_engine_of_another_version_is_refused(folder: Path) -> None:
    version = json.loads((folder / "results.json").read_text("utf-8"))["runs"][0]["version"]
    journals.spoil(folder / "run.jsonl", lambda text: text.replace(f'"mujoco": "{version}"', '"mujoco": "0.1"'))
    done = bodycheck("rerun", folder)
    assert done.returncode == 2
    assert done.stderr == f"{folder}: was made with mujoco 0.1, and mujoco {version} is installed; allowed: the same version\n"


def test_a_study_is_refused(tmp_path: Path, calls_here: None) -> None:
    case, out = tmp_path / "tumbling.case.toml", tmp_path / "out"
    case.write_text(TUMBLING, "utf-8")
    options = ("--engine", "mujoco", "--integrator", "RK4", "--error", 1e-3, "--out", out, "--quiet")
    assert bodycheck("recommend", case, *options).returncode == 0
    done = bodycheck("rerun", out)
    assert (done.returncode, done.stderr) == (
        2,
        f"{out}: contains a study, which has no results.json; run the command of the study again\n",
    )
