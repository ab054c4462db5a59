"""What rounding may do to the figures of a run: runs from nudged initial states say it."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import Case, compare, load, simulate
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import parse
from bodycheck.judging.baselines import rounding
from bodycheck.judging.baselines.baseline import FIGURES
from bodycheck.reference.scene import State
from bodycheck.reference.trajectory import Trajectory
from bodycheck.results.outcome import Completed, Run
from bodycheck.running import campaign
from tests.support.cases import OF_ONE_BODY, TOUCHING, shortened
from tests.support.truths import truth_for_runs

WHOLE = load("intermediate-axis-flip").text.partition("[[expect]]")[0]
#: Half of it, with nothing expected.
FLIP = parse(WHOLE.replace("duration = 10.0", "duration = 5.0").replace("samples = 1001", "samples = 101"), "flip")

STEP = 0.005
U = 2.0**-53


def another_machine(case: Case, run: Run, seed: int) -> Run:
    """The run on a machine that rounds every number otherwise in every step, by up to one unit each."""
    assert isinstance(run.outcome, Completed)
    adapter, random = registry.load(run.engine), np.random.default_rng(seed)
    initial, rows = case.scene.initial, []
    row = np.array([*initial.position, *initial.quaternion, *initial.velocity, *initial.angular_velocity])
    for _ in range(run.outcome.steps + 1):
        rows.append(row)
        row = row * (1 + U * random.uniform(-1, 1, 13))
        state = State(tuple(row[:3]), tuple(row[3:7]), tuple(row[7:10]), tuple(row[10:]))
        row = adapter.prepare([replace(case.scene, initial=state)], run.method).advance(np.array([1]))[0, 0, 0]
    t = run.outcome.trajectory.t
    states = np.array(rows)[np.rint(t / run.method.timestep).astype(int)]
    trajectory = Trajectory(t, states[:, :3], states[:, 3:7], states[:, 7:10], states[:, 10:])
    return replace(run, outcome=replace(run.outcome, states=trajectory))


@pytest.mark.parametrize(
    ("engine", "integrator"),
    [("mujoco", "Euler"), ("mujoco", "RK4"), ("pinocchio", "rk4")],
)
def test_another_machine_has_not_changed_anything(engine: str, integrator: str) -> None:
    """Each step's rounding errors are carried by the flip, which makes of them what it would on a real machine."""
    run, reference = simulate(FLIP, engine, integrator, STEP), truth_for_runs(FLIP, STEP)
    nudged = [simulate(rounding.nudged(FLIP, run, seed), engine, integrator, STEP) for seed in range(rounding.NUDGES)]
    allowed = rounding.allowances(reference, run, nudged)
    figures = compare(reference, run).maxima()
    for seed in range(2):
        other = compare(reference, another_machine(FLIP, run, seed)).maxima()
        moved = [name for name in FIGURES if name in figures and other[name] != figures[name]]
        assert len(moved) > 4, "else nothing was tried"
        # Two machines add their allowances; this one alone is to be enough for either.
        assert [name for name in moved if abs(other[name] - figures[name]) > allowed[name]] == []


def test_single_precision_is_allowed_its_own_rounding() -> None:
    run, reference = simulate(FLIP, "mujoco", "RK4", STEP), truth_for_runs(FLIP, STEP)
    assert isinstance(run.outcome, Completed)
    parts = ("position", "quaternion", "velocity", "angular_velocity")
    single = {part: getattr(run.outcome.trajectory, part).astype(np.float32).astype(float) for part in parts}
    coarse = replace(run, outcome=replace(run.outcome, states=replace(run.outcome.trajectory, **single)))
    moves = [
        np.linalg.norm(np.subtract(rounding.nudged(FLIP, of, 0).scene.initial.velocity, FLIP.scene.initial.velocity))
        for of in (run, coarse)
    ]
    # Both are relative to the largest speed; that of 1e-14 m/s is itself rounded where it is added to 2 m/s, by a few per cent.
    assert moves[1] / moves[0] == pytest.approx(2.0**29, rel=0.1)
    assert rounding.allowances(reference, coarse, [coarse])["velocity_error"] > 1e-3


@pytest.mark.parametrize("name", sorted({*OF_ONE_BODY, *TOUCHING}))
def test_what_touches_or_lies_flat_does_so_when_nudged(name: str) -> None:
    case = shortened(load(name), 0.1, 3)
    adapter = registry.load("mujoco")
    run = simulate(case, "mujoco", offers.offered(adapter.engine, case.scene)[0], 0.01)
    for seed in range(rounding.NUDGES):
        nudged = rounding.nudged(case, run, seed)
        assert nudged.scene != case.scene
        assert isinstance(simulate(nudged, run.engine, run.method.name, 0.01).outcome, Completed), name


def test_what_rounding_decides_is_not_held_against_anyone() -> None:
    """Where nudged runs do not all end, nothing can be said of the figures."""
    run, reference = simulate(FLIP, "mujoco", "RK4", STEP), truth_for_runs(FLIP, STEP)
    other = replace(run, method=Method.parse("RK4", STEP), outcome=campaign.Crashed("it died"))
    assert set(rounding.allowances(reference, run, [run, other]).values()) == {np.inf}
