"""The command line, as a user calls it."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bodycheck import load, truth
from bodycheck.adapters import offers, registry
from bodycheck.casefile.case import shipped
from bodycheck.reference.observables import observe
from tests.support import ROOT
from tests.support.cases import a_case, expecting
from tests.support.commands import bodycheck, bodycheck_process, call

GRAVITY = {"gravity": 9.81}


def short_case(position_error: float = 1e-9) -> str:
    """A sphere that spins and falls, and how far RK4 may be off (m); it integrates a parabola without error."""
    return a_case("short", scene=GRAVITY, expect=[expecting("mujoco", "RK4", 0.002, position_error=position_error)])


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.case.toml"
    path.write_text(short_case())
    return path


def test_run_writes_everything_it_promises(short: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = bodycheck_process("run", short, "projectile", "--out", out, "--jobs", 2)
    assert done.returncode == 0, done.stderr
    names = {"results.csv", "results.parquet", "results.json", "trajectories", "report.html", "report.md", "run.jsonl"}
    assert {path.name for path in out.iterdir()} == names | {"results.csv-metadata.json"}
    results = pd.read_csv(out / "results.csv")
    assert set(results.case) == {"short", "projectile"}
    assert set(results.engine) == {"mujoco", "pinocchio"}
    assert set(results.timestep) == {0.002}
    offered = [
        len(offers.offered(registry.load(engine).engine, load("projectile").scene)) for engine in ("mujoco", "pinocchio")
    ]
    assert len(results) == 2 * sum(offered)
    assert str(out / "report.html") in done.stderr
    assert "runs: " in done.stdout


def test_without_out_nothing_is_written(calls_here: None, short: Path, tmp_path: Path) -> None:
    done = bodycheck("run", short, "--engine", "mujoco", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert [path.name for path in tmp_path.iterdir()] == [short.name]


def test_run_prints_json(calls_here: None, short: Path) -> None:
    options = ("--engine", "mujoco", "--integrator", "RK4", "--timestep", "0.002", "--timestep", "0.001", "--json")
    done = bodycheck("run", short, *options)
    rows = json.loads(done.stdout)
    assert [(row["integrator"], row["timestep"]) for row in rows] == [("RK4", 0.002), ("RK4", 0.001)]
    assert [row["passed"] for row in rows] == [True, None]


def test_a_broken_expectation_exits_1(calls_here: None, short: Path) -> None:
    short.write_text(short_case(position_error=1e-30))
    done = bodycheck("run", short, "--engine", "mujoco")
    assert done.returncode == 1
    assert "position_error is" in done.stdout
    assert "1 failed" in done.stdout


@pytest.fixture
def broken(tmp_path: Path) -> tuple[list[Path], list[str]]:
    """Case files with faults, one that is not there, and what must be told of them."""
    bad, worse, none = (tmp_path / f"{name}.case.toml" for name in ("bad", "worse", "none"))
    bad.write_text(short_case().replace("mass = 1.0", "mass = -1.0").replace("samples = 6", "samples = 0"))
    worse.write_text("= 3")
    words = [f"{bad}:7:1: body.mass: read -1.0", f"{bad}:14:1: run.samples: read 0", f"{worse}:1:1: not TOML"]
    return [bad, worse, none], [*words, f"{none}: there is no such file"]


def test_broken_cases_among_good_ones_are_all_told_and_left_out(
    calls_here: None, short: Path, broken: tuple[list[Path], list[str]]
) -> None:
    paths, words = broken
    done = bodycheck("run", *paths[:1], short, *paths[1:], "--engine", "mujoco", "--json")
    assert done.returncode == 1
    assert {row["case"] for row in json.loads(done.stdout)} == {"short"}
    assert all(word in done.stderr for word in words)
    checked = bodycheck("validate", *paths[:1], short, *paths[1:])
    assert (checked.returncode, checked.stdout) == (1, "short: valid\n")
    assert all(word in checked.stderr for word in words)


@pytest.mark.parametrize("command", ["run", "validate", "extremes"])
def test_broken_cases_alone_exit_2_before_simulating(
    command: str, tmp_path: Path, broken: tuple[list[Path], list[str]]
) -> None:
    paths, words = broken
    done = bodycheck(command, *paths, *(() if command == "validate" else ("--out", tmp_path / "out")))
    assert (done.returncode, done.stdout) == (2, "")
    assert not (tmp_path / "out" / "results.csv").exists()
    assert all(word in done.stderr for word in words)
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(("engine", "scheme"), [("mujoco", "rk4"), ("pinocchio", "RK4")])
def test_with_one_engine_absent_the_other_runs(
    short: Path, tmp_path: Path, engine: str, scheme: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BODYCHECK_CACHE", str(tmp_path / "cache"))  # which knows no engine
    commands = (
        ("run", short, "--integrator", scheme, "--allow-missing", "--out", tmp_path / "out"),
        ("run", short, "--engine", engine),
    )
    code = (
        f"import json, sys\nsys.modules[{engine!r}] = None\n"
        "from tests.support.commands import bodycheck\nfrom tests.support.processes import calls_here\n"
        "with calls_here():\n    done = [bodycheck(*command) for command in json.loads(sys.argv[1])]\n"
        "print(json.dumps([(one.returncode, one.stderr) for one in done]))"
    )
    asked = json.dumps([list(map(str, command)) for command in commands])
    told = subprocess.run([sys.executable, "-c", code, asked], capture_output=True, text=True, cwd=ROOT)
    assert told.returncode == 0, told.stderr
    (ended, said), (refused, why) = json.loads(told.stdout)
    assert ended == 0, said
    assert f"{engine} is not installed" in said
    results = pd.read_csv(tmp_path / "out" / "results.csv")
    assert set(results.engine) == {"mujoco", "pinocchio"} - {engine}
    assert f"{engine} is not installed" in (tmp_path / "out" / "report.md").read_text()
    assert refused == 2
    assert f"{engine} is not installed" in why


def test_what_is_not_modelled_yet_is_unsupported(calls_here: None, short: Path) -> None:
    short.write_text(a_case("short", scene=GRAVITY | {"plane": {"friction": 0.5}, "drag": {"quadratic": 0.1}}))
    done = bodycheck("run", short, "--json")
    assert done.returncode == 1  # a command without any result does not pass
    rows = json.loads(done.stdout)
    assert {row["status"] for row in rows} == {"unsupported"}
    assert all(row["reason"] and row["attitude_error"] is None for row in rows)
    assert bodycheck("truth", short).returncode == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("run", "nobody"), "no such file, and no shipped case of this name"),
        (("run", "--engine", "nobody"), "there is no engine 'nobody'; there are: "),
        (("run", "--integrator", "rk5"), "no engine has an integrator 'rk5'"),
        (("run", "free-brick", "--integrator", "RK4:drag=fluid"), "nothing to run"),
        (("run", "--timestep", "-1"), "must be positive"),
        (("run", "--timestep", "soon"), "soon"),
        (("run", "--jobs", "0"), "--jobs 0: must be at least 1"),
        (("run", "--frob"), "frob"),
        (("frob",), "frob"),
        (("truth",), "CASE"),
        (("truth", "projectile", "--at", "-1"), "--at"),
        (("validate",), "give at least one"),
    ],
)
def test_bad_usage_exits_2_with_a_word(arguments: tuple[str, ...], words: str) -> None:
    done = bodycheck(*arguments)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


def test_truth_prints_its_arrays(calls_here: None) -> None:
    done = bodycheck("truth", "gimbal-start", "--at", "1.5", "0", "0.25", "--json")
    found = json.loads(done.stdout)
    arrays = ["t", "position", "quaternion", "velocity", "angular_velocity", "truth_error", "truth_position_error"]
    bounds = ["truth_velocity_error", "truth_angular_velocity_error", "truth_energy_error", "truth_angular_momentum_error"]
    assert list(found) == ["case", "model", "reason", "backend", "witnesses", "word", *arrays, *bounds]
    assert found["t"] == [0, 0.25, 1.5]
    expected = truth(load("gimbal-start"), [0, 0.25, 1.5])
    np.testing.assert_array_equal(found["position"], expected.trajectory.position)
    np.testing.assert_array_equal(found["quaternion"], expected.trajectory.quaternion)
    np.testing.assert_array_equal(found["truth_error"], expected.bounds.error)
    np.testing.assert_array_equal(found["truth_angular_velocity_error"], expected.bounds.angular_velocity_error)
    energy = observe(expected.scene, expected.trajectory).kinetic_energy[0]  # what energy_drift is relative to
    np.testing.assert_array_equal(found["truth_energy_error"], expected.bounds.energy_error / energy)
    assert len(json.loads(bodycheck("truth", "projectile", "--json").stdout)["t"]) == 201


def test_truth_prints_the_bounds_of_every_figure(calls_here: None) -> None:
    expected = truth(load("intermediate-axis-flip"), [1.0])
    printed = bodycheck("truth", "intermediate-axis-flip", "--at", "1").stdout
    assert "model" in printed
    (line,) = [line for line in printed.splitlines() if line.startswith("velocity error at most ")]
    words = line.split()
    told = float(words[words.index("most") + 1]), float(words[words.index("rad/s,") - 1])
    for number, bound in zip(told, (expected.bounds.velocity_error, expected.bounds.angular_velocity_error), strict=True):
        assert bound[0] <= number <= 1.1 * bound[0]  # rounded up to two digits
    assert "\nenergy error " in printed
    assert ", angular momentum error " in printed


def test_lists() -> None:
    assert {case["name"] for case in json.loads(bodycheck("cases", "--json").stdout)} == set(shipped())
    assert "free-brick" in bodycheck("cases").stdout
    checked = {engine["name"]: engine for engine in json.loads(bodycheck("engines", "check", "mujoco", "--json").stdout)}
    assert checked == {"mujoco": {"name": "mujoco", "faults": []}}
    engines = {engine["name"]: engine for engine in json.loads(bodycheck("engines", "--json").stdout)}
    assert {engines["mujoco"]["place"], engines["pinocchio"]["place"]} == {"here"}
    assert "RK4" in engines["mujoco"]["integrators"]


def test_validate(short: Path, tmp_path: Path) -> None:
    assert bodycheck("validate", short).returncode == 0
    short.write_text(short_case().replace("mass", "mas"))
    done = bodycheck("validate", short)
    assert done.returncode == 2
    assert f"{short}:7:1: body.mas: read 1.0; unknown key; allowed: mass, inertia, shape, radius" in done.stderr


def test_help_imports_nothing_heavy() -> None:
    heavy = ("numpy", "scipy", "pandas", "pydantic", "mujoco", "pinocchio", "rich.progress", "heyoka")
    code = (
        "import sys\nsys.argv = ['bodycheck', '--help']\nfrom bodycheck.commands.command_line import main\n"
        f"try:\n    main()\nexcept SystemExit:\n    print([m for m in {heavy} if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stderr.strip() == "[]"
    assert "Exit codes" in done.stdout


def test_results_of_workers_that_print_stay_readable(short: Path, miniatures: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert call("run", short, "--engine", "printing", "--json") == 0
    printed = capfd.readouterr()
    assert [row["engine"] for row in json.loads(printed.out)] == ["printing"]
    assert "an engine that talks" in printed.err
    assert "one that talks from C" in printed.err
