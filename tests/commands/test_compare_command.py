"""`bodycheck compare`: motions that somebody recorded, compared with the truth of a case."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import bodycheck
from bodycheck.errors import BadInput
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.results.outcome import Completed
from bodycheck.running import logs
from tests.support.commands import Done
from tests.support.commands import bodycheck as command

POSE, VELOCITIES = ("px", "py", "pz", "qw", "qx", "qy", "qz"), ("vx", "vy", "vz", "wx", "wy", "wz")

Log = dict[str, Array]


def columns(trajectory: Trajectory, prefix: str = "", velocities: bool = True) -> Log:
    """The columns of a log of one body."""
    states = (trajectory.position, trajectory.quaternion, trajectory.velocity, trajectory.angular_velocity)
    names = (*POSE, *VELOCITIES) if velocities else POSE
    values = np.concatenate(states, axis=-1).T[: len(names)]
    return {f"{prefix}{name}": value for name, value in zip(names, values, strict=True)}


def truth_of(case: str) -> bodycheck.Truth:
    return bodycheck.truth(bodycheck.load(case), np.linspace(0.0, 0.5, 26))


def write(path: Path, log: Log) -> Path:
    with path.open("w", newline="") as file:
        lines = csv.writer(file)
        lines.writerow(log)
        lines.writerows([repr(float(value)) for value in row] for row in zip(*log.values(), strict=True))
    return path


def compared(path: Path, case: str, *options: object) -> list[dict[str, object]]:
    done = command("compare", path, case, "--name", "isaac", "--json", *options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def brick() -> Log:
    truth = truth_of("free-brick").trajectory
    return {"t": truth.t, **columns(truth)}


def test_the_truth_as_a_log_has_no_error_beyond_rounding(brick: Log, tmp_path: Path) -> None:
    (row,) = compared(write(tmp_path / "log.csv", brick), "free-brick", "--version", "4.5")
    assert (row["engine"], row["version"], row["integrator"], row["timestep"]) == ("isaac", "4.5", "recorded", 0.02)
    for name in ("position_error", "velocity_error", "attitude_error", "angular_velocity_error"):
        assert row[name] < 1e-14, name  # numbers are written to the last digit, and quaternions normalised again
    assert row.get("wall_time") is None


def test_what_the_script_of_a_driven_case_prints_is_a_log(tmp_path: Path) -> None:
    """A line for each body at each instant, with x for px."""
    trajectory = truth_of("driven-arm").trajectory
    names = ["upper-arm", "forearm"]
    states = [np.hstack([each.position, each.quaternion]) for each in map(trajectory.body, range(len(names)))]
    head = "t,body,x,y,z,qw,qx,qy,qz\n"
    lines = [
        ",".join([repr(float(t)), name, *map(repr, of_body[row].tolist())])
        for row, t in enumerate(trajectory.t)
        for name, of_body in zip(names, states, strict=True)
    ]
    (tmp_path / "script.csv").write_text(head + "\n".join(lines) + "\n")
    case = bodycheck.load("driven-arm")
    outcome = logs.read(tmp_path / "script.csv", case, "isaac", "1").run.outcome
    assert isinstance(outcome, Completed)
    np.testing.assert_array_equal(outcome.trajectory.position, trajectory.position)
    np.testing.assert_allclose(outcome.trajectory.quaternion, trajectory.quaternion, rtol=0, atol=1e-15)  # normalised again
    (tmp_path / "script.csv").write_text(head + "\n".join(lines[:-1]) + "\n")
    with pytest.raises(BadInput, match="its bodies differ from instant to instant"):
        logs.read(tmp_path / "script.csv", case, "isaac", "1")


def test_an_error_of_a_log_is_measured(brick: Log, tmp_path: Path) -> None:
    drifting = brick | {"px": brick["px"] + 0.25 * brick["t"]}
    (row,) = compared(write(tmp_path / "log.csv", drifting), "free-brick")
    assert row["position_error"] == pytest.approx(0.125, rel=1e-12)


def test_without_velocities_figures_of_velocities_are_left_out(brick: Log, tmp_path: Path) -> None:
    poses = {name: brick[name] for name in ("t", *POSE)}
    (row,) = compared(write(tmp_path / "log.csv", poses), "free-brick", "--out", tmp_path / "out")
    assert row["attitude_error"] < 1e-14
    assert row.get("velocity_error") is row.get("energy_drift") is None
    assert command("report", tmp_path / "out").returncode == 0


@pytest.mark.parametrize("by", ["bodies", "joints"])
def test_mechanisms_are_given_by_bodies_or_by_joints(by: str, tmp_path: Path) -> None:
    truth = truth_of("double-pendulum")
    scene, trajectory = bodycheck.load("double-pendulum").scene, truth.trajectory
    log: Log = {"t": trajectory.t}
    if by == "bodies":
        for index, body in enumerate(scene.bodies):
            log |= columns(trajectory.body(index), f"{body.name}.")
    else:
        motion = kinematics.joints(scene, trajectory)
        for index, joint in enumerate(scene.joints):
            log |= {f"{joint.name}.position": motion.position[:, index], f"{joint.name}.velocity": motion.velocity[:, index]}
    (row,) = compared(write(tmp_path / "log.csv", log), "double-pendulum")
    assert row["position_error"] < 1e-14
    assert row["attitude_error"] < 1e-14
    assert row["energy_drift"] < 1e-13


def test_the_results_are_a_folder_like_any_other(brick: Log, tmp_path: Path) -> None:
    logs = {"before": brick, "after": brick | {"pz": brick["pz"] + 0.1 * brick["t"]}}
    for name, log in logs.items():
        path = write(tmp_path / f"{name}.csv", log)
        compared(path, "free-brick", "--out", tmp_path / name, "--save", tmp_path / f"{name}.parquet")
    both = (tmp_path / "before", tmp_path / "after")
    assert command("report", *both, "--out", tmp_path / "both").returncode == 0
    compare_again = "bodycheck compare LOG.csv free-brick --name isaac --version unknown"
    assert compare_again in (both[0] / "report.html").read_text("utf-8")
    assert command("submit", both[0], "--out", tmp_path / "one.zip").returncode == 0
    assert command("site", tmp_path / "one.zip", "--out", tmp_path / "site").stderr.startswith("site: ")
    again = command("rerun", both[0])
    assert again.returncode == 2
    assert "has a recorded motion, which cannot be made again" in again.stderr
    pages = (path.read_text("utf-8") for path in (tmp_path / "site").rglob("*") if path.suffix in (".html", ".js", ".json"))
    assert "--integrator recorded" not in " ".join(pages)
    same = command("diff", tmp_path / "before.parquet", tmp_path / "before.parquet")
    assert same.returncode == 0
    worse = command("diff", tmp_path / "before.parquet", tmp_path / "after.parquet")
    assert worse.returncode == 1
    assert "position_error" in worse.stdout


def test_what_a_log_has_beside_is_told(brick: Log, tmp_path: Path) -> None:
    after = brick | {"t": brick["t"] * 40, "torque": brick["px"]}
    done = command("compare", write(tmp_path / "log.csv", after), "free-brick", "--name", "isaac", "--quiet")
    assert done.returncode == 0
    assert "columns that are not used: torque" in done.stderr
    assert "12 instants after the end of the case at 10 s are not used" in done.stderr or "after the end" in done.stderr
    short = command("compare", write(tmp_path / "log.csv", brick), "free-brick", "--name", "isaac", "--quiet")
    assert "ends at 0.5 s, before the end of the case at 10 s" in short.stderr


def refused(log: Path, case: str = "free-brick", name: str = "isaac") -> Done:
    done = command("compare", log, case, "--name", name)
    assert (done.returncode, done.stdout) == (2, "")
    # One line for each fault; a file has at least one.
    assert all(line.startswith(("there is", "'", str(log), case)) for line in done.stderr.splitlines())
    return done


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda log: {name: log[name] for name in log if name != "qy"}, "log.csv: lacks the columns qy; it has: t, px"),
        (lambda log: {name: log[name] for name in log if name != "wy"}, "log.csv: lacks the columns wy; it has: t, px"),
        (lambda log: {name: log[name] for name in log if name != "t"}, "log.csv:1: read 'px, py"),
        (lambda log: log | {"t": log["t"][::-1]}, "log.csv:3: t: read 0.48; allowed: ascending numbers of at least 0 s"),
        (lambda log: log | {"t": log["t"] - 1}, "log.csv:2: t: read -1; allowed: ascending numbers of at least 0 s"),
        (lambda log: log | {"px": log["px"] * np.inf}, "log.csv:2: px: read "),
        (lambda log: log | {"qw": log["qw"] * 2}, "log.csv:2: qw to qz: read a quaternion of length "),
        (lambda log: {name: values[:1] for name, values in log.items()}, "log.csv: has 1 instants; allowed: 2 to 300000"),
        (lambda log: log | {"t": log["t"] + 50}, "log.csv: has fewer than 2 instants within the duration of the case, 10 s"),
    ],
)
def test_a_log_that_cannot_be_read_is_refused(brick: Log, tmp_path: Path, change: Callable[[Log], Log], told: str) -> None:
    with np.errstate(invalid="ignore"):
        log = change(brick)
    assert refused(write(tmp_path / "log.csv", log)).stderr.startswith(f"{tmp_path}/{told}")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "read ''; allowed: different names of columns, among them t"),
        (b"t,px\n0,1,2\n", ":2: has 3 values; allowed: 2"),
        (b"t,px\n0,\xff\n", "is not UTF-8"),
        (b"t,t\n0,1\n", "allowed: different names of columns"),
    ],
)
def test_what_is_no_log_is_refused(tmp_path: Path, content: bytes, told: str) -> None:
    log = tmp_path / "log.csv"
    log.write_bytes(content)
    assert told in refused(log).stderr


def test_names_cases_and_missing_files_are_checked(brick: Log, tmp_path: Path) -> None:
    log = write(tmp_path / "log.csv", brick)
    assert "is no name of an engine;" in refused(log, name=".x").stderr
    versioned = command("compare", log, "free-brick", "--name", "isaac", "--version", ".x")
    assert (versioned.returncode, "is no name of an engine's version;" in versioned.stderr) == (2, True)
    assert "no shipped case of this name" in refused(log, "nobody").stderr
    assert "cannot be read: No such file" in refused(tmp_path / "missing.csv").stderr
    assert "lacks the columns" in refused(log, "double-pendulum").stderr
    (joint,) = bodycheck.load("spherical-pendulum").scene.joints
    by_joint = write(tmp_path / "joint.csv", {"t": brick["t"], f"{joint.name}.position": brick["px"]})
    assert "has several coordinates" in refused(by_joint, "spherical-pendulum").stderr
