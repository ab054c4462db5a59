"""The command `bodycheck ensemble`: from a case to its tables and its report, and what it makes of wrong options."""

import contextlib
import csv
import json
import os
import socket
from pathlib import Path

import pytest

from bodycheck import load
from bodycheck.reports import html
from bodycheck.studies.ensemble.rows import DependenceRow, Row
from tests.support import pages, processes
from tests.support.cases import a_case, expecting
from tests.support.commands import bodycheck, call
from tests.support.wording import facts

BRICK = {"shape": "brick", "semi_axes": [0.1, 0.2, 0.3], "mass": 1.0}
SPIN = {"angular_velocity": [0.1, 5.0, 0.0]}
ENSEMBLE = """
[ensemble]
members = 48
seed = 1
[[ensemble.vary]]
key = "initial.angular_velocity"
distribution = "normal"
mean = [0.0, 0.0, 0.0]
standard_deviation = [3.0, 3.0, 3.0]
[[ensemble.vary]]
key = "body.mass"
distribution = "uniform"
low = 1.0
high = 2.0
"""
METHODS = ("--engine", "mujoco", "--integrator", "Euler", "--integrator", "RK4")

#: How members are carried out in worker processes is what the tests of `execution` are about.
pytestmark = pytest.mark.usefixtures("calls_here")


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("case") / "spin.case.toml"
    path.write_text(a_case(body=BRICK, initial=SPIN) + ENSEMBLE, "utf-8")
    return path


@pytest.fixture(scope="module")
def folder(case: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("ensemble") / "out"
    with processes.calls_here():
        assert call("ensemble", case, *METHODS, "--out", out, "--jobs", 1, "--quiet") == 0
    return out


def test_the_tables_have_a_row_for_each_method_and_figure(folder: Path) -> None:
    rows = list(csv.DictReader((folder / "ensemble.csv").read_text("utf-8").splitlines()))
    assert list(rows[0]) == list(Row.__dataclass_fields__)
    assert {(row["integrator"], row["members"], row["failed"]) for row in rows} == {
        ("Euler", "48", "0.0"),
        ("RK4", "48", "0.0"),
    }
    assert {row["failed_high"] for row in rows} == {str(3 / 48)}
    for row in rows:
        assert float(row["q05"]) <= float(row["q50"]) <= float(row["q95"]) <= float(row["q99"]) <= float(row["max"])
        assert 0 <= int(row["worst_member"]) < 48
    sensitivity = list(csv.DictReader((folder / "sensitivity.csv").read_text("utf-8").splitlines()))
    assert not sensitivity or list(sensitivity[0]) == list(DependenceRow.__dataclass_fields__)


def test_the_report_shows_the_worst_members(folder: Path) -> None:
    text = (folder / "report.html").read_text("utf-8")
    pages.check(text)
    assert len(text) < 6_000_000
    assert 'data-player="playback-worst-1"' in text
    assert (folder / "report.md").read_text("utf-8").startswith("# bodycheck: Ensemble of spin")
    assert list((folder / "worst").glob("spin-*.case.toml"))
    assert html.MOST_OPEN >= 4  # so that all parts of the report are open at first


def test_a_broken_expectation_is_a_failure(case: Path, tmp_path: Path) -> None:
    strict = tmp_path / "strict.case.toml"
    expected = [expecting("mujoco", "Euler", 0.002, attitude_error=1e-9)]
    strict.write_text(a_case(body=BRICK, initial=SPIN, expect=expected) + ENSEMBLE, "utf-8")
    done = bodycheck("ensemble", strict, *METHODS, "--jobs", "1", "--quiet", "--members", "20")
    assert done.returncode == 1
    assert facts(done.stdout, "FAILED", "spin", "mujoco Euler", "attitude_error")[:8] == [
        *("FAILED", "spin", "mujoco Euler", "0.002", "20", "20", "0", "attitude_error"),
    ]
    assert done.stdout.count("FAILED") == 1


def test_a_member_that_diverges_is_a_result(tmp_path: Path) -> None:
    """With 10 rad in a step an explicit integrator has energy from nothing, which ends the run."""
    fast = tmp_path / "fast.case.toml"
    fast.write_text(a_case(body=BRICK, initial=SPIN) + ENSEMBLE.replace("[3.0, 3.0, 3.0]", "[1e5, 1e5, 1e5]"), "utf-8")
    done = bodycheck("ensemble", fast, *METHODS, "--jobs", "1", "--json", "--members", "16")
    assert done.returncode == 0
    assert max(row["failed"] for row in json.loads(done.stdout)["rows"]) > 0.5


def test_one_member_alone(case: Path, tmp_path: Path) -> None:
    path = tmp_path / "one.case.toml"
    assert call("ensemble", case, "--member", 17, "--write", path) == 0
    assert load(path).name == "spin-17"
    assert load(path).ensemble is None


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--member", "1"), "--member and --write: give both"),
        (("--member", "48", "--write", "x.case.toml"), "read member 48; allowed: 0 to 47"),
        (("--shard", "1/2"), "--shard 1/2: needs --out"),
        (("--dask", "local", "--shard", "1/2", "--out", "x"), "--dask and --shard: give only one of them"),
        (("--shard", "3/2", "--out", "x"), "--shard 3/2: read '3/2'; allowed: I/N"),
        (("--members", "0"), "read 0 members"),
        (("--columns", "speed"), "there is no column 'speed'"),
        (("--from", "none.csv"), "none.csv: cannot be read"),
    ],
)
def test_wrong_options(case: Path, tmp_path: Path, options: tuple[str, ...], message: str) -> None:
    done = bodycheck("ensemble", case, "--engine", "mujoco", *options, folder=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_member_that_is_no_case_ends_the_command_before_anything_runs(case: Path, tmp_path: Path) -> None:
    table = tmp_path / "masses.csv"
    table.write_text("body.mass\n" + "1.0\n" * 2500 + "-1.0\n", "utf-8")
    done = bodycheck("ensemble", case, *METHODS, "--from", table, "--out", tmp_path / "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "spin: member 2500: body.mass: read -1.0; should be greater than 0\n"
    assert not (tmp_path / "out").exists()


def test_a_case_without_an_ensemble() -> None:
    done = bodycheck("ensemble", "free-brick")
    assert done.returncode == 2
    assert "free-brick: has no table [ensemble]" in done.stderr


def test_the_report_is_made_again_without_running_anything(folder: Path, tmp_path: Path) -> None:
    assert call("report", folder, "--out", tmp_path) == 0
    assert (tmp_path / "report.html").read_bytes() == (folder / "report.html").read_bytes()
    assert (tmp_path / "report.md").read_bytes() == (folder / "report.md").read_bytes()


def test_shares_are_gathered_into_the_same_tables(case: Path, folder: Path, tmp_path: Path) -> None:
    for share in ("1/2", "2/2"):
        assert call("ensemble", case, *METHODS, "--out", tmp_path, "--jobs", 1, "--shard", share, "--quiet") == 0
        assert not (tmp_path / "ensemble.csv").exists()
    assert call("gather", tmp_path, "--out", tmp_path, "--jobs", 1, "--quiet") == 0
    for name in ("ensemble.csv", "sensitivity.csv"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()
    assert {path.name for path in (tmp_path / "worst").iterdir()} == {path.name for path in (folder / "worst").iterdir()}


def test_a_cluster_leaves_the_environment_as_it_was() -> None:
    """Dask sets variables for its workers, with which those of engines would be started anew for every call.

    Another program may have the port on which Dask usually shows its page.
    """
    pytest.importorskip("distributed")
    from bodycheck.running.members.executors import dask_cluster

    before = dict(os.environ)
    with socket.socket() as other:
        with contextlib.suppress(OSError):  # it is in use already
            other.bind(("", 8787))
            other.listen()
        with dask_cluster._client(dask_cluster.LOCAL, 1):
            assert dict(os.environ) != before
    assert dict(os.environ) == before
