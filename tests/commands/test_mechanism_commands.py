"""Commands on a mechanism: what is made of free bodies is made of joints too, or says that it is not."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import bodycheck as package
from bodycheck.casefile.case import load
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import Mechanism
from tests.support.commands import bodycheck
from tests.support.mechanism_texts import CART_POLE

TEXT = CART_POLE.replace("duration = 4.0", "duration = 0.5").replace("samples = 81", "samples = 6")
TEXT += "[extremes]\ngravity = [0.0, 1.0]\n"

MUJOCO = ("--engine", "mujoco", "--integrator", "RK4")

pytestmark = pytest.mark.usefixtures("calls_here")


@pytest.fixture
def case(tmp_path: Path) -> Path:
    file = tmp_path / "cart-pole.case.toml"
    file.write_text(TEXT, "utf-8")
    return file


def rows(file: Path) -> list[dict[str, str]]:
    lines = [line for line in file.read_text("utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def test_the_truth_is_told_by_joints_and_bodies(case: Path) -> None:
    told = json.loads(bodycheck("truth", case, "--json").stdout)
    mechanism = load(case).scene
    assert isinstance(mechanism, Mechanism)
    start = kinematics.initial(mechanism)
    assert told["t"] == load(case).instants.tolist()
    assert {name: (len(own["position"]), own["velocity"][0]) for name, own in told["joints"].items()} == {
        "rail": (6, 0.5),
        "pin": (6, 0.0),
    }
    for place, name in enumerate(("cart", "pole")):
        assert np.array(told["bodies"][name]["position"])[0] == pytest.approx(start.position[place, 0], abs=1e-15)
        assert {len(values) for values in told["bodies"][name].values()} == {6}
    assert all(0 < error < 1e-12 for error in told["truth_error"] + told["truth_position_error"])
    assert "position" not in told


def test_the_terminal_has_the_coordinates_of_joints_and_until_when_they_are_known(case: Path) -> None:
    printed = bodycheck("truth", case, "--at", 0, 0.5).stdout
    assert "t s  rail m" in printed
    assert "pin rad/s" in printed
    assert "all angles and attitudes are known within 1e-09 rad" in printed
    refused = bodycheck("truth", case, "--columns", "pin,quaternion")
    assert (refused.returncode, refused.stderr.count("there is no column 'quaternion'")) == (2, 1)


def test_runs_have_a_report_and_results_with_the_figures_of_mechanisms(case: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = bodycheck("run", case, *MUJOCO, "--timestep", 0.01, "--timestep", 0.005, "--out", out)
    assert done.returncode == 0, done.stderr
    coarse, fine = rows(out / "results.csv")
    assert (coarse["status"], coarse["kind"]) == ("ok", "mechanism")
    for name in ("position_error", "attitude_error", "joint_position_error", "joint_slide_error"):
        # A scheme of fourth order: a sixteenth, and up to twice that where the errors of single instants change their signs.
        assert float(fine[name]) < 2 / 16 * float(coarse[name]), name
    assert float(coarse["attitude_error"]) == pytest.approx(float(coarse["joint_position_error"]), rel=1e-6)
    # Rounding of positions of half a metre, in some joints.
    assert float(fine["constraint_error"]) < 1e-14
    assert coarse["rotational_energy_drift"] == coarse["angular_momentum_drift"] == ""
    for name in ("report.html", "report.md"):
        text = (out / name).read_text("utf-8")
        assert "Bodies on joints" in text
        assert "rail: prismatic, cart on the world; pin: revolute, pole on cart" in text
    again = bodycheck("report", out, "--out", tmp_path / "again")
    assert again.returncode == 0, again.stderr


def test_studies_take_mechanisms(case: Path, tmp_path: Path) -> None:
    steps = ("--timestep", 0.02, "--timestep", 0.01, "--timestep", 0.005, "--timestep", 0.0025, "--timestep", 0.00125)
    assert (
        bodycheck("tradeoff", case, "--engine", "mujoco", "--integrator", "Euler", *steps, "--out", tmp_path / "t").returncode
        == 0
    )
    orders = {row["quantity"]: row["order"] for row in rows(tmp_path / "t" / "orders.csv")}
    assert float(orders["position"]) == pytest.approx(1, abs=0.1)
    done = bodycheck("recommend", case, *MUJOCO, "--error", 1e-6)
    assert "mujoco RK4 at " in done.stdout
    assert bodycheck("extremes", case, *MUJOCO, "--out", tmp_path / "e").returncode == 0
    assert {row["status"] for row in rows(tmp_path / "e" / "extremes.csv")} == {"ok"}


def test_expectations_baselines_and_python_take_mechanisms(case: Path, tmp_path: Path) -> None:
    assert bodycheck("expect", case, *MUJOCO, "--timestep", 0.01).returncode == 0
    assert "joint_position_error = " in case.read_text("utf-8")
    for name in ("one", "two"):
        done = bodycheck("run", case, *MUJOCO, "--timestep", 0.01, "--save", tmp_path / f"{name}.parquet")
        assert (done.returncode, "1 passed" in done.stdout) == (0, True)
    compared = bodycheck("diff", tmp_path / "one.parquet", tmp_path / "two.parquet")
    assert (compared.returncode, compared.stdout.startswith("no change in 1 run")) == (0, True)
    loaded = package.load(case)
    found = package.compare(package.truth(loaded), package.simulate(loaded, "mujoco", "RK4", 0.01))
    assert found.maxima()["joint_slide_error"] > 0


def test_members_of_an_ensemble_are_run_one_by_one(case: Path, tmp_path: Path) -> None:
    drawn = '[ensemble]\nmembers = 3\nseed = 1\n[[ensemble.vary]]\nkey = "joints.pin.damping"\n'
    case.write_text(f'{TEXT}{drawn}distribution = "uniform"\nlow = 0.0\nhigh = 0.1\n', "utf-8")
    done = bodycheck("ensemble", case, *MUJOCO, "--timestep", 0.01, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "No member failed" in done.stdout


def test_a_mechanism_that_has_only_one_model_is_refused_in_one_line(case: Path) -> None:
    done = bodycheck("ablate", case, "--engine", "mujoco")
    assert done.returncode == 2
    assert "mujoco offer no models of these cases" in done.stderr
    assert done.stderr.count("\n") == 1
