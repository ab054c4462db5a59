"""Engines in environments of their own run beside those that are installed here, by the same commands."""

import json
from pathlib import Path

import pandas as pd
import pytest

from bodycheck.adapters import registry
from bodycheck.environments import environments
from bodycheck.running import campaign, engines
from bodycheck.running.plan import plan
from tests.support import wheels
from tests.support.cases import STEADY_SPIN, a_case, expecting
from tests.support.commands import bodycheck
from tests.support.processes import calls_here

VERSIONS = ("1.0", "2.0")


@pytest.fixture(scope="module")
def added(place: Path) -> None:
    """Both releases as a user adds them, who is told that the second one is wrong."""
    for version, kind in zip(VERSIONS, ("exact", "wrong"), strict=True):
        wheels.wheel(place / "wheels", version, f"KIND = '{kind}'")
        done = bodycheck("engines", "add", f"toy@{version}", "--json")
        (row,) = json.loads(done.stdout)
        assert row["name"] == f"toy@{version}"
        assert list(row["packages"]) == [f"toy_engine=={version}"]
        assert done.returncode == bool(row["faults"]) == (version == "2.0"), done.stderr


@pytest.fixture
def two_releases(added: None) -> None:
    """The engine is exact in its release 1.0 and wrong in 2.0; none is installed here. What a test has removed is back."""
    for version in VERSIONS:
        environments.obtain("toy", version)


def test_releases_stand_side_by_side_in_one_run(two_releases: None, tmp_path: Path) -> None:
    case = tmp_path / "spin.case.toml"
    case.write_text(a_case(), "utf-8")
    names = ("toy@1.0", "toy@2.0", "toy", "mujoco")
    asked = [word for name in names for word in ("--engine", name)]
    done = bodycheck("run", case, *asked, "--timestep", "0.01", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    table = pd.read_csv(tmp_path / "out" / "results.csv", dtype={"version": str})
    toys = table[table.engine.str.startswith("toy")].set_index("engine")
    assert list(toys.version) == ["1.0", "2.0", "2.0"]  # without a version, the newest that has an environment
    error = toys.position_error
    assert error["toy@1.0"] < 1e-9 < 0.9 < error["toy@2.0"] == error["toy"]
    with calls_here():
        alone = bodycheck("run", case, "--engine", "mujoco", "--timestep", "0.01", "--json")
    others = table[table.engine == "mujoco"]
    errors = {row["integrator"]: row["attitude_error"] for row in json.loads(alone.stdout)}
    assert errors == dict(zip(others.integrator, others.attitude_error, strict=True)), "the same to the last bit"
    header = json.loads((tmp_path / "out" / "results.json").read_text("utf-8"))["sets"][0]["header"]
    assert {name: list(packages) for name, packages in header["environments"].items()} == {
        "toy@1.0": ["toy_engine==1.0"],
        "toy@2.0": ["toy_engine==2.0"],
        "toy": ["toy_engine==2.0"],
    }
    assert all(len(digest) == 64 for packages in header["environments"].values() for digest in packages.values())
    schemes = ("--integrator", "closed-form", "--integrator", "Euler", "--timestep", "0.01")
    priced = bodycheck("tradeoff", case, "--engine", "toy@1.0", "--engine", "mujoco", *schemes, "--json")
    assert {row["engine"] for row in json.loads(priced.stdout)["rows"] if row["cost"]} == {"toy@1.0", "mujoco"}


def test_what_is_not_there_is_said_with_the_command_to_type(two_releases: None) -> None:
    done = bodycheck("run", "free-brick", "--engine", "toy@9.9")
    assert done.returncode == 2
    assert "install it by: bodycheck engines add toy@9.9" in done.stderr
    assert bodycheck("run", "free-brick", "--engine", "toy@new").returncode == 2
    assert bodycheck("engines", "add", "toy@9.9").returncode == 1
    assert bodycheck("engines", "add").returncode == bodycheck("engines", "add", "nobody").returncode == 2
    assert engines.describe(["toy@1.0"])[0]["toy@1.0"].version == "1.0"
    assert json.loads(bodycheck("engines", "remove", "toy@1.0", "--json").stdout) == {"removed": ["toy@1.0"]}
    assert environments.cached("toy") == ("2.0",)
    assert "toy@1.0" in engines.faults(["toy@1.0"])


def test_an_expectation_of_a_release_binds_it_to_its_environment(
    two_releases: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(registry, "names", lambda: ("mujoco", "toy"))  # without the miniature engines that fail
    case = tmp_path / "spin.case.toml"
    expected = [expecting(f"toy@{version}", "closed-form", 0.01, position_error=1e-6) for version in ("1.0", "2.0")]
    case.write_text(a_case(expect=expected), "utf-8")
    done = bodycheck("run", case, "--integrator", "closed-form", "--json")
    passed = {row["engine"]: row["passed"] for row in json.loads(done.stdout) if "@" in row["engine"]}
    assert (done.returncode, passed) == (1, {"toy@1.0": True, "toy@2.0": False})
    case.write_text(a_case(expect=[*expected[:1], expecting("toy@9.9", "closed-form", 0.01, position_error=1e-6)]), "utf-8")
    done = bodycheck("run", case)
    assert done.returncode == 2
    assert "install it by: bodycheck engines add toy@9.9" in done.stderr
    allowed = bodycheck("run", case, "--allow-missing", "--integrator", "closed-form")
    assert allowed.returncode == 0
    assert "1 expectation of toy@9.9 was not checked (--allow-missing): toy@9.9 is not installed" in " ".join(
        allowed.stdout.split()
    )


def test_an_environment_that_is_removed_meanwhile_fails_its_runs_alone(two_releases: None, tmp_path: Path) -> None:
    records, _ = engines.describe(["toy@1.0", "mujoco"])
    tasks = plan([STEADY_SPIN], records, ("closed-form", "RK4"), (0.1,))
    assert environments.remove("toy", ["1.0"]) == ("1.0",)
    with campaign.results(tasks, tmp_path / "out", campaign.header([], records, {}), 1) as results:
        outcomes = {run.engine: run.outcome for run in results.runs()}
    assert outcomes["mujoco"].status == "ok"
    assert "toy@1.0 is not installed" in outcomes["toy@1.0"].reason
