"""The ablation: models that grow step by step, what they cost and what they change, as rows, files and sentences."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bodycheck import load, truth
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, Models
from bodycheck.errors import BadInput
from bodycheck.judging.judgement import Verdict, verdict
from bodycheck.processes.failures import Crashed
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Run
from bodycheck.running.simulation import run
from bodycheck.studies import cost
from bodycheck.studies.ablation import page as report
from bodycheck.studies.ablation import study as ablation
from bodycheck.studies.ablation.rows import MODELS, Change, ModelRow
from tests.support.campaigns import records
from tests.support.cases import shortened
from tests.support.commands import call
from tests.support.processes import calls_here
from tests.support.wording import facts

RECORDS = records("mujoco", "pinocchio")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the command writes of the two scenes in both engines, the flight cut to a second."""
    place = tmp_path_factory.mktemp("ablation")
    text = load("free-brick").text.partition("[[expect]]")[0].replace("duration = 10.0", "duration = 1.0")
    case = place / "free-brick.case.toml"
    case.write_text(text.replace("samples = 1001", "samples = 11"))
    out = place / "out"
    with calls_here(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(cost, "MIN_TIMING_S", cost.MIN_TIMING_S / 10)  # costs are held against each other, far apart
        assert call("ablate", case, "sliding-brick", "--out", out) == 0
    return out


def test_every_model_has_its_row(folder: Path) -> None:
    table = pd.read_csv(folder / "ablation.csv")
    first = (
        "case",
        "engine",
        "version",
        "integrator",
        "timestep",
        "model",
        "relative_cost",
        "relative_cost_low",
        "relative_cost_high",
    )
    assert tuple(table.columns[: len(first)]) == first
    assert {*table.columns} <= {*MODELS.by_name}
    for case in ("free-brick", "sliding-brick"):
        for engine in RECORDS:
            own = table[(table.case == case) & (table.engine == engine)]
            (integrator,) = set(own.integrator)
            adapter = registry.load(engine)
            assert isinstance(adapter, Models)
            assert list(own.model) == list(adapter.models(load(case).scene, integrator))
            assert set(own.status) == {"ok"}
            assert set(own.timestep) == {0.002}
            assert (own.iloc[0].relative_cost, own.iloc[0].relative_cost_low, own.iloc[0].relative_cost_high) == (1, 1, 1)
            assert (own.relative_cost_low <= own.relative_cost).all()
            assert (own.relative_cost <= own.relative_cost_high).all()
            assert (
                own[["position_error", "attitude_error", "energy_error" if case[0] == "s" else "energy_drift"]]
                .notna()
                .all(axis=None)
            )


def test_what_is_known_of_the_models_is_in_the_rows(folder: Path) -> None:
    table = pd.read_csv(folder / "ablation.csv").set_index(["case", "engine", "model"])
    flight = table.loc["free-brick", "mujoco"]
    assert (flight.position_change == 0).all()
    assert (flight.attitude_change < 1e-15).all()
    # On the body twist, Euler's scheme moves the centre of mass; that is of first order, and vanishes with the step.
    twist = table.loc["free-brick", "pinocchio", "six-coordinates"]
    assert 0.1 < twist.position_change < twist.position_time_step
    # MuJoCo's soft contact slides a little farther; planar and free joints under one law do not differ.
    slide = table.loc["sliding-brick", "mujoco"]
    assert slide.position_change["six-coordinates"] < 1e-14
    assert 1e-4 < slide.position_change["contact"] < 1e-2
    # Costs are measured: how large they are depends on what else the machine does.
    assert table.loc["sliding-brick", "pinocchio"].relative_cost.iloc[0] == 1
    assert (table.relative_cost > 0).all()


def test_the_report_has_the_tables_of_both_engines(folder: Path) -> None:
    text = (folder / "report.md").read_text()
    for words in (
        "mujoco Euler at 2 ms on free-brick",
        "pinocchio law-force at 2 ms on sliding-brick",
        "gravity, translation, planar rotation, contact and friction: 3 degrees of freedom",
        "one free-flyer joint",
        "errors and their changes",
    ):
        assert words in text
    (bars, *_) = (line for line in text.splitlines() if line.startswith("- Bars") and "planar" in line)
    assert facts(bars, "mujoco Euler", "planar")[:4] == ["mujoco Euler", "2", "planar", "1"]
    assert (folder / "report.html").stat().st_size > 1e5


def test_rows_can_be_read_by_a_program(calls_here: None, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    case = tmp_path / "disk.case.toml"
    text = load("curling-disk").text.partition("[[expect]]")[0]
    case.write_text(text.replace("duration = 0.8", "duration = 0.05").replace("samples = 801", "samples = 6"))
    assert call("ablate", case, "--engine", "pinocchio", "--timestep", 0.01, "--json") == 0
    rows = {row["model"]: row for row in json.loads(capsys.readouterr().out)}
    assert rows["planar"]["relative_cost"] == 1
    # A disk has no corners for rigid contacts.
    assert (rows["contact"]["status"], rows["contact"]["relative_cost"]) == ("unsupported", None)
    assert "corners" in rows["contact"]["reason"]
    assert rows["contact"]["position_error"] is None


def test_without_integrators_the_first_with_models_is_compared(calls_here: None) -> None:
    tasks = ablation.plan([load("sliding-brick"), load("free-brick")], RECORDS, (), ())
    methods = {(task.case.name, task.engine, task.method.name.partition(":")[0]) for task in tasks}
    assert methods == {
        ("sliding-brick", "mujoco", "Euler"),
        ("sliding-brick", "pinocchio", "law-force"),
        ("sliding-brick", "pinocchio", "admm"),  # the model of the law force that touches the plane
        ("free-brick", "mujoco", "Euler"),
        ("free-brick", "pinocchio", "semi-implicit-euler"),
    }
    assert {task.method.timestep for task in tasks} == {0.002, 0.001}
    asked = ablation.plan([load("free-brick")], RECORDS, ("RK4", "rk4"), (0.004, 0.002))
    assert {task.method.name.partition(":")[0] for task in asked} == {"RK4", "rk4"}
    assert len(asked) == len(set(asked)) == 3 * 2 * 3


def test_a_mechanism_is_compared_as_joints_as_hinges_and_as_free_bodies(calls_here: None) -> None:
    case = shortened(load("lagrange-top"), 0.1, 11)
    tasks = ablation.plan([case], RECORDS, ("RK4",), ())
    assert {task.method.name for task in tasks} == {f"RK4:model={name}" for name in ("joints", "three-hinges", "free-bodies")}
    held = {}
    for task in tasks:
        own = run(case, "mujoco", task.method)
        assert isinstance(own.outcome, Completed)
        held[own.key] = verdict(case, truth(case).at(own.outcome.trajectory.t), own)
    group = RunKey(case.name, "mujoco", Method.parse("RK4", 0.002))
    ((_, models),) = ablation.with_models((case, "mujoco", ("RK4",))).items()
    rows = {row.model: row for row in ablation.rows_of(case, group, models, held)}
    # MuJoCo's soft constraints give way by some tenths of a millimetre, and joints not at all.
    assert rows["joints"].errors["constraint_error"] < 1e-14
    assert 1e-5 < rows["free-bodies"].errors["constraint_error"] < 1e-2
    assert not rows["free-bodies"].changes["position"].agrees
    assert "ball joints: 3 degrees of freedom" in report.part(case, [list(rows.values())]).texts[0]


@pytest.mark.parametrize(
    ("integrators", "timesteps", "words"),
    [(("admm",), (), "nothing to compare"), (("rk5",), (), "rk5"), ((), (-1.0,), "must be positive")],
)
def test_bad_usage_is_refused(calls_here: None, integrators: tuple[str, ...], timesteps: tuple[float, ...], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        ablation.plan([load("sliding-brick")], RECORDS, integrators, timesteps)


def test_costs_are_compared_round_by_round() -> None:
    """A machine that slows down does so to all models of a round."""
    slowing = np.array([1.0, 1.0, 5.0, 3.0, 2.0])
    _, (seconds, relative) = ablation.compared([1e-6 * slowing, 3e-6 * slowing])
    assert (seconds.median, seconds.low, seconds.high) == (6e-6, 3e-6, 15e-6)
    for found in (relative.median, relative.low, relative.high):
        assert found == pytest.approx(3, rel=1e-15, abs=0)


def completed(aside: float, lean: float, timestep: float) -> Verdict:
    """A verdict on a run that stands aside (m) and leans (rad)."""
    t = np.linspace(0, 1, 3)
    attitude = np.tile([math.cos(lean / 2), math.sin(lean / 2), 0.0, 0.0], (3, 1))
    states = np.tile([aside, 0.0, 0.0], (3, 1))
    run = Run(
        "case", "engine", "1", Method.parse("i", timestep), Completed(Trajectory(t, states, attitude, states, states), 100, 1.0)
    )
    return Verdict(run, run.outcome, None, None, "")


def test_changes_are_held_against_the_time_step_errors_of_both() -> None:
    own, half = completed(1.30, 0.2, 0.1), completed(1.25, 0.2, 0.05)
    smallest, half_smallest = completed(1.00, 0.0, 0.1), completed(1.10, 0.0, 0.05)
    changes = ablation.changes(own, half, smallest, half_smallest)
    assert changes["position"].size == pytest.approx(0.3)
    assert changes["position"].time_step == pytest.approx(2 * (0.05 + 0.10))
    assert changes["position"].agrees
    assert changes["attitude"].size == pytest.approx(0.2)
    assert changes["attitude"].time_step == 0
    assert not changes["attitude"].agrees
    assert ablation.changes(own, half, own, half)["position"].is_rounding
    failed = replace(own, outcome=Crashed("it gave up"))
    assert ablation.changes(own, failed, smallest, half_smallest) == {}


def row(model: str, position: Change, attitude: Change, relative: float = 4.1) -> ModelRow:
    return ModelRow(
        *("sliding-brick", "mujoco", "4", "Euler", 0.002, model, "more", "ok", "", 1e-6),
        *(relative, relative - 0.1, relative + 0.1),
        {"position": position, "attitude": attitude},
        {"position_error": 0.01 + position.size},
    )


NOTHING = Change(0.0, 1e-12, 1e-3)


@pytest.mark.parametrize(
    ("position", "attitude", "words"),
    [
        (NOTHING, NOTHING, "the model contact costs 4.1 times as much (4 to 4.2) as planar and does not change the motion."),
        (
            Change(3e-4, 1e-12, 1e-3),
            NOTHING,
            " and changes the position by 0.3 mm, which is within the time-step errors of both models.",
        ),
        (
            Change(2.5, 1e-12, 1e-3),
            Change(0.1, 1e-12, 0.2),
            "changes the position by 2.5 m and the attitude by 0.1 rad, of which the change of the position is more than "
            "the time-step errors of both models.",
        ),
    ],
)
def test_findings_are_made_of_measurements(position: Change, attitude: Change, words: str) -> None:
    rows = [row("planar", NOTHING, NOTHING, 1.0), row("contact", position, attitude)]
    first, *others = report.findings(rows)
    assert words in first.text
    assert first.where == "sliding-brick"
    disagree = not (position.agrees and attitude.agrees)
    assert bool(others) is disagree
    if disagree:
        told = facts(others[0].text, "contact", "planar", "position", "attitude", "errors")
        assert told[-6:] == ["contact", "planar", "2.5", "position", "errors", "1"]
    assert report.costs(rows).failed == (False, disagree)


def test_the_table_of_errors_tells_their_change() -> None:
    rows = [row("planar", NOTHING, NOTHING, 1.0), row("same", NOTHING, NOTHING), row("contact", Change(3e-4, 0, 1), NOTHING)]
    texts = [entries[1].text for entries in report.errors(rows).rows]
    assert texts == ["0.01", "0.01 (=)", "0.0103 (+0.0003)"]


def test_the_chart_draws_every_model_with_its_spread() -> None:
    rows = [row("planar", NOTHING, NOTHING, 1.0), row("contact", NOTHING, NOTHING)]
    specification = report.chart(rows).specification
    assert [value["model"] for value in specification["data"]["values"]] == ["planar", "contact"]
    (most,) = {layer["encoding"]["x"]["scale"]["domain"][1] for layer in specification["layer"]}
    assert most > 4.2


def test_a_flight_too_short_for_a_step_still_has_costs(calls_here: None) -> None:
    """Timings repeat a short run from its start."""
    case = shortened(load("projectile"), 0.01, 2)
    stretches = [
        cost.Stretch(case.scene, "mujoco", Method.parse(f"Euler:model={model}", 0.01), 1)
        for model in ("translation", "everything")
    ]
    for measured in cost.measure(stretches, limit=60.0, rounds=2):
        assert isinstance(measured, cost.Measured)
        assert (measured.times > 0).all()


def test_changes_that_all_exceed_the_time_step_errors_are_told_together() -> None:
    told = report.effect({"position": Change(2.5, 1e-12, 1e-3), "attitude": Change(0.3, 1e-12, 0.2)})
    assert facts(told, "position", "attitude", "of which", "more") == ["position", "2.5", "attitude", "0.3", "more"]
