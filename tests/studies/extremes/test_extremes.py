"""The study of extremes: what it finds with real engines, what it makes of engines that fail, and that nothing ends it."""

import json
import random
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import vl_convert

from bodycheck import Case, load, simulate, truth
from bodycheck.adapters import registry
from bodycheck.casefile import axes
from bodycheck.errors import BadInput
from bodycheck.reference.scene import State
from bodycheck.reference.truths import NoTruth
from bodycheck.results import journal
from bodycheck.results.outcome import Completed
from bodycheck.studies.extremes import study as extremes
from bodycheck.studies.extremes.diagnosis import Diagnosis, diagnose
from bodycheck.studies.extremes.outcome_map import LETTERS
from bodycheck.studies.extremes.page import present
from bodycheck.studies.extremes.rows import STATUSES, Limit, Row
from bodycheck.studies.extremes.study import follow, points
from tests.support.campaigns import header, records
from tests.support.cases import OF_ONE_BODY, STEADY_SPIN, a_case
from tests.support.commands import Done, as_process, bodycheck
from tests.support.processes import calls_here, stopped_when_last
from tests.support.wording import facts

SPIN = load("extreme-spin")


def run(case: Case, engine: str, integrator: str, timestep: float = 0.002) -> Diagnosis:
    outcome = simulate(case, engine, integrator, timestep).outcome
    exact = follow(case.scene, outcome.trajectory.t) if isinstance(outcome, Completed) else NoTruth("it did not end")
    return diagnose(case.scene, outcome, exact)


def spun(s: float, duration: float = 2.0) -> Case:
    """The brick 1 : 3 : 2 with body rates (0.01 s, 0, s)."""
    scene = replace(SPIN.scene, initial=State(angular_velocity=(0.01 * s, 0.0, s)))
    return replace(SPIN, scene=scene, duration=duration)


def study(
    cases: list[Case], engines: tuple[str, ...], folder: Path, integrators: tuple[str, ...] = (), jobs: int = 0, **options: Any
) -> tuple[list[Row], list[Limit]]:
    """What a study finds. jobs: worker processes, which engines need that die or hang; options: those of `extremes.results`."""
    prepared = extremes.prepare(cases, records(*engines), integrators)
    options = {"progress": lambda done, count=1: None} | options
    with (
        nullcontext() if jobs else calls_here(),
        extremes.results(prepared, folder, header(*engines), jobs or 1, **options) as found,
    ):
        return found


def test_euler_gains_energy_at_100_rad_per_second() -> None:
    found = run(spun(100.0), "mujoco", "Euler")
    assert (found.status, found.engine_said) == ("energy-gain", "healthy")
    assert facts(found.detail, "energy of rotation")[:2] == ["energy of rotation", "48.3"]


def test_euler_ends_in_a_reset_at_300_rad_per_second() -> None:
    found = run(spun(300.0), "mujoco", "Euler")
    assert found.status == "reset"
    assert facts(found.engine_said, "reset", "BADQACC") == ["reset", "BADQACC", "0.29"]
    names = ("angular momentum", "energy of rotation")
    assert facts(found.detail, *names)[:4] == ["angular momentum", "0.292", "energy of rotation", "3.08e+09"]


def test_rk4_does_not_survive_10000_rad_per_second() -> None:
    found = run(spun(1e4), "mujoco", "RK4")
    assert found.status == "reset"
    assert "BADQVEL at t = 0.004 s" in found.engine_said


def test_the_study_finds_the_reset_after_minutes_without_being_told_where(tmp_path: Path) -> None:
    rows, _ = study([replace(SPIN, extremes=(("steps", dict(SPIN.extremes)["steps"]),))], ("mujoco",), tmp_path, ("Euler",))
    assert [(row.value, row.status, row.believed) for row in rows[:3]] == [
        (value, "energy-gain", True) for value in (1e3, 1e4, 1e5)
    ]
    # The steps of 100 s and more are seen from 200 samples a minute: the growth is faster than exponential, as a blow-up is.
    assert "growing faster than exponentially" in rows[2].detail
    assert rows[3].status == "reset"
    assert float(rows[3].engine_said.split("t = ")[1].removesuffix(" s")) == pytest.approx(209.4, abs=0.1)
    # Exactly: what the engine says of the brick with body rates (0.1, 0, 10) itself.
    assert "at t = 209.436 s" in run(spun(10.0, 220.0), "mujoco", "Euler").engine_said


@pytest.mark.parametrize(
    ("name", "timestep", "status", "off"),
    [
        ("osrf-boxes-complex", 0.001, "energy-gain", "centre of mass 17.3 m off"),
        ("free-brick", 0.002, "inaccurate", "centre of mass 201 m off after a path of 471 m"),
    ],
)
def test_body_twist_euler_is_found_out_by_its_centre_of_mass(name: str, timestep: float, status: str, off: str) -> None:
    found = run(load(name), "pinocchio", "body-twist-euler", timestep)
    assert (found.status, found.engine_said) == (status, "healthy")
    assert off in found.detail


def test_positions_lose_their_digits_far_from_the_origin() -> None:
    by_distance = {point.value: point.case for point in points(load("free-brick")) if point.axis == "distance"}
    near, far = by_distance[1e6], by_distance[1e14]
    assert run(near, "pinocchio", "semi-implicit-euler").status == "ok"
    stands = run(far, "pinocchio", "semi-implicit-euler")
    # 1 m/s for 2 ms is 0.13 of a rounding at 1e14 m.
    assert (stands.status, stands.engine_said) == ("frozen", "healthy")
    assert facts(stands.detail, "x stands still")[:2] == ["x stands still", "5"]
    assert run(by_distance[1e11], "mujoco", "Euler").status == "reset"


def test_a_brick_at_rest_sinks_into_a_plane_of_much_friction() -> None:
    by_friction = {point.value: point.case for point in points(load("resting-brick")) if point.axis == "friction"}
    assert run(by_friction[0.5], "mujoco", "Euler").status == "ok"
    sinks = run(by_friction[10.0], "mujoco", "Euler")
    assert (sinks.status, sinks.engine_said) == ("inaccurate", "healthy")
    assert "m into the plane" in sinks.detail
    assert run(by_friction[10.0], "mujoco", "Euler:cone=elliptic").status == "ok"


FAILING = {
    "exact": ("ok", "healthy", "centre of mass by"),
    "wrong": ("inaccurate", "healthy", "centre of mass 1 m off after a path of 0.99 m"),
    "drifting": ("ok", "healthy", "attitude off by"),
    "exploding": ("diverged", "healthy", "times the most possible"),
    "not-a-number": ("diverged", "healthy", "not a number at t = 0.5 s"),
    "frozen": ("frozen", "healthy", "stands still"),
    "jumping": ("diverged", "healthy", "has jumped 0.495 m by t = 0.6 s, of which the engine says nothing"),
    "crying": ("diverged", "the miniature engine starts over at t = 0.5 s", "its states show no break"),
    "resetting": ("reset", "the miniature engine starts over at t = 0.5 s", "has jumped 0.495 m by t = 0.6 s"),
    "raising": ("crashed", "RuntimeError: the miniature engine gives up", "the engine raised an error"),
}

#: These take their processes with them.
DEADLY = {
    "dying": ("crashed", "nothing", "its process exited with code 3"),
    "segfaulting": ("crashed", "nothing", "its process died of signal SIGSEGV"),
    "hanging": ("timeout", "nothing", "stopped after 8 s"),
}


def test_every_engine_that_fails_on_purpose_has_its_own_status(miniatures: Path, tmp_path: Path) -> None:
    case = replace(STEADY_SPIN, extremes=(("timestep", (0.1,)),))
    rows, limits = study([case], tuple(FAILING), tmp_path / "here")
    with stopped_when_last(len(DEADLY)) as clock:
        dead, none = study([case], tuple(DEADLY), tmp_path / "there", jobs=2, limit=8.0, progress=clock.advance)
    assert {row.engine for row in rows if row.believed} == {
        engine for engine, (status, said, _) in FAILING.items() if said == "healthy" and status != "ok"
    }
    assert [row.engine for row in (*rows, *dead)] == [*FAILING, *DEADLY]
    for row in (*rows, *dead):
        status, said, words = (FAILING | DEADLY)[row.engine]
        assert (row.engine, row.status, row.engine_said) == (row.engine, status, said)
        assert words in row.detail
    assert limits == none == []


@pytest.mark.parametrize("engine", ["raising", pytest.param("dying", marks=pytest.mark.slow)])
def test_steps_at_which_an_engine_dies_are_not_stable(engine: str, miniatures: Path, tmp_path: Path) -> None:
    case = replace(STEADY_SPIN, extremes=(("spin", (1.0,)),))
    _, limits = study([case], ("exact", engine), tmp_path, jobs=2 if engine == "dying" else 0)
    found = {limit.engine: limit for limit in limits}
    assert found["exact"].spin_times_step == pytest.approx(2 * np.pi)
    assert found["exact"].smallest_unstable_timestep is None
    assert found[engine].largest_stable_timestep is None


METHODS = ("--engine", "mujoco", "--integrator", "Euler", "--integrator", "RK4")


def small(folder: Path, **axes: list[float]) -> Path:
    """The file of a brick that spins, to be pushed along some axes."""
    body = {"shape": "brick", "semi_axes": [0.1, 0.3, 0.2], "mass": 1.0}
    run = {"duration": 2.0, "samples": 101}
    path = folder / "small.case.toml"
    spin = {"angular_velocity": [0.1, 0.0, 10.0]}
    path.write_text(a_case("small", title="A brick to be pushed a little", body=body, initial=spin, run=run, extremes=axes))
    return path


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Done]:
    """The case of a study that nothing disturbs, and how it ended; its results are in `out` beside."""
    folder = tmp_path_factory.mktemp("whole")
    case = small(folder, spin=[300.0], timestep=[0.01], steps=[1e3])
    with calls_here():
        return case, bodycheck("extremes", case, *METHODS[:4], "--out", folder / "out")


@pytest.mark.slow
def test_a_study_that_was_killed_ends_as_if_it_had_not_been(whole: tuple[Path, Done], tmp_path: Path) -> None:
    case, done = whole
    assert done.returncode == 0, done.stderr
    undisturbed, killed = case.parent / "out", tmp_path / "killed"
    records = (undisturbed / extremes.RECORDS).read_text().splitlines()
    command = ("extremes", case, *METHODS[:4], "--out", killed)
    process = subprocess.Popen(as_process(*command, "--jobs", 2), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    lines = random.randint(2, len(records) - 2)
    while process.poll() is None:
        path = killed / extremes.RECORDS
        if path.exists() and path.read_bytes().count(b"\n") >= lines:
            process.send_signal(signal.SIGKILL)
            process.wait()
        time.sleep(0.002)
    assert process.returncode == -signal.SIGKILL, f"it was to be killed after {lines} lines of {len(records)}"
    with calls_here():
        done = bodycheck(*command, "--jobs", 1)
    assert done.returncode == 0, done.stderr
    assert "resuming the interrupted study" in done.stderr
    for name in ("extremes.csv", "limits.csv"):
        assert (killed / name).read_bytes() == (undisturbed / name).read_bytes()
    # Nothing was done twice.
    again = (killed / extremes.RECORDS).read_text().splitlines()
    assert len(set(again)) == len(again)


def test_the_command_writes_what_it_promises_and_findings_are_no_failures(whole: tuple[Path, Done]) -> None:
    case, done = whole
    out = case.parent / "out"
    assert done.returncode == 0, done.stderr
    names = {"extremes.csv", "limits.csv", "report.html", "report.md", "extremes.jsonl"}
    assert {path.name for path in out.iterdir()} == names | {"extremes.csv-metadata.json", "limits.csv-metadata.json"}
    rows, limits = pd.read_csv(out / "extremes.csv"), pd.read_csv(out / "limits.csv")
    columns = "case, engine, version, integrator, timestep, axis, value, status, engine_said, detail"
    assert list(rows.columns) == columns.split(", ")
    columns = "case, engine, version, integrator, spin, largest_stable_timestep, spin_times_step, smallest_unstable_timestep"
    assert list(limits.columns) == columns.split(", ")
    assert set(rows.status) <= set(STATUSES)
    assert (rows.query("axis == 'spin' and integrator == 'Euler'").status == "reset").all()
    np.testing.assert_allclose(limits.spin * limits.largest_stable_timestep, limits.spin_times_step, rtol=1e-15)
    assert journal.read(out / "extremes.jsonl").complete
    assert "wrong without any report by the engine" in done.stdout


def test_json_has_rows_and_limits(calls_here: None, tmp_path: Path) -> None:
    done = bodycheck("extremes", small(tmp_path, steps=[1e3]), *METHODS, "--out", tmp_path / "out", "--json")
    found = json.loads(done.stdout)
    assert [row["integrator"] for row in found["rows"]] == ["Euler", "RK4"]
    assert found["limits"] == []


def test_a_case_without_axes_gets_those_that_fit_it() -> None:
    records = {"mujoco": registry.load("mujoco").engine}
    flight, pendulum = load("projectile"), load("pendulum-large")
    assert dict(axes.default_axes(flight)).keys() == {"timestep", "steps", "gravity", "speed"}
    assert dict(axes.default_axes(SPIN)).keys() >= {"timestep", "steps", "gravity", "spin"}
    assert dict(axes.default_axes(pendulum)).keys() == {"timestep", "steps", "gravity"}
    assert dict(axes.default_axes(replace(pendulum, duration=0.005)))["timestep"] == (0.0005, 0.002)
    study = extremes.prepare([pendulum, SPIN], records, ("Euler",))
    tried = {(trial.point.case.name, trial.point.axis, trial.point.value) for trial in study.trials}
    assert {(axis, value) for case, axis, value in tried if case == pendulum.name} == {
        (axis, value) for axis, values in axes.default_axes(pendulum) for value in values
    }
    assert {axis for case, axis, _ in tried if case == SPIN.name} == dict(SPIN.extremes).keys() - {"timestep"}
    with pytest.raises(BadInput, match="no engine has an integrator 'rk5'"):
        extremes.prepare([SPIN], records, ("rk5",))


def test_the_report_begins_with_what_engines_take_for_healthy() -> None:
    case = replace(SPIN, extremes=(("spin", (1.0, 300.0, 1e3)), ("timestep", (0.002, 0.01)), ("steps", (1e3, 1.2e5))))
    methods = ("semi-implicit-euler", "rk4")
    rows = [
        Row(
            case.name,
            "pinocchio",
            "1",
            method,
            point.timestep,
            point.axis,
            point.value,
            found.status,
            found.engine_said,
            found.detail,
        )
        for point in points(case)
        for method in methods
        for found in [run(point.case, "pinocchio", method, point.timestep)]
    ]
    limits = [
        Limit(case.name, "pinocchio", "1", "rk4", 1.0, 3.2, 3.2, 3.3),
        Limit(case.name, "a", "1", "b", 1.0, None, None, 1e-3),
    ]
    report = present(header("pinocchio"), rows, limits)
    believed = sum(row.believed for row in rows)
    assert facts(report.headline, "no problem", "wrong") == [str(believed), str(len(rows)), "no problem", "wrong"]
    assert report.findings[0].subject == "Unreported errors"
    assert report.parts[0].name == report.findings[0].where == "unreported-errors"
    statuses = [row[4].text for row in report.parts[0].tables[0][1].rows]
    assert statuses == sorted(statuses, key=STATUSES.index, reverse=True)
    told = {finding.subject: finding.text for finding in report.findings}
    names = ("semi-implicit-euler", "without a warning", "fails", "not a number")
    assert [*names[:1], "1000", "without a warning", "1.2e5", "fails", "not a number"] == facts(told["Long runs"], *names)[:6]
    assert "3.2 rad with pinocchio rk4" in told["Stability"]
    assert facts(told["Unstable"], "No time step is stable", "a b") == ["No time step is stable", "1", "a b"]
    spun = report.parts[1]
    drawn = [value for chart in spun.charts for value in chart.specification["data"]["values"]]
    assert {(value["spin"], value["step"]) for value in drawn} == {(s, h) for s in (1.0, 300.0, 1e3) for h in (0.002, 0.01)}
    assert {value["status"] for value in drawn} == {row.status for row in rows if row.axis == "spin"}
    for chart in spun.charts:
        # The map is drawn, with a letter in every cell that is not ok.
        svg = vl_convert.vegalite_to_svg(json.dumps(chart.specification))
        letters = [LETTERS[value["status"]] for value in chart.specification["data"]["values"]]
        assert all(f">{letter}</text>" in svg for letter in letters if letter)
    anchors = {part.name for part in report.parts}
    assert all(finding.where in anchors for finding in report.findings if finding.where)


@pytest.mark.parametrize("name", [name for name in OF_ONE_BODY if load(name).extremes])
def test_the_truth_follows_to_every_shipped_corner_or_says_why_not(name: str) -> None:
    for point in points(load(name)):
        found = follow(point.case.scene, point.case.instants)
        if isinstance(found, NoTruth):
            assert "a body that would tip" in found.reason
        else:
            # Attitudes to a billionth, far below what is called lost.
            assert found.bounds.error.max() < 1e-9


CORNERS = [
    point
    for name in ("gimbal-start", "free-brick", "extreme-spin")
    for point in points(load(name))
    if point.axis in ("moment_ratio", "size", "spin") and point.timestep == 0.002 and point.value not in (1e4, 1e5, 1e6)
]


@pytest.mark.parametrize("point", CORNERS, ids=lambda point: f"{point.case.name} {point.axis} {point.value!r}")
def test_witnesses_bear_the_closed_form_out_wherever_they_can_follow(point: extremes.Point) -> None:
    witnessed = truth(point.case, point.case.instants[::100])
    assert witnessed.witnesses
    # Attitudes to a billionth, far below what is called lost.
    assert witnessed.bounds.error.max() < 1e-9


def longest(steps: float) -> tuple[int, int]:
    """The samples of a run, and the most memory (bytes) that a process of its own ever had for it."""
    code = (
        "import resource\nfrom bodycheck import load, simulate\nfrom bodycheck.casefile.axes import steps\n"
        f"case = steps(load('extreme-spin'), {steps!r})\nrun = simulate(case, 'mujoco', 'implicitfast')\n"
        "print(len(run.outcome.trajectory), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    samples, kilobytes = map(int, done.stdout.split())
    return samples, 1024 * kilobytes


@pytest.mark.parametrize("steps", [3e5, pytest.param(1e7, marks=pytest.mark.slow)])
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere ru_maxrss has other units")
def test_long_runs_take_no_more_memory_than_short_ones(steps: float) -> None:
    few, many = longest(1e4), longest(steps)
    assert few[0] == many[0] == SPIN.samples
    # A state is 13 doubles: 3e5 of them would be 31 MB. What two processes differ by is some pages.
    assert many[1] - few[1] < 20e6
