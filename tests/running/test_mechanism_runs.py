"""Runs of mechanisms with a miniature engine: what is checked of their states, how they are stored, and what they are worth."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters.contract import Method
from bodycheck.casefile.case import Case, parse
from bodycheck.errors import BadFolder
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.discrepancy import compare
from bodycheck.judging.judgement import verdict
from bodycheck.reference.bounds import NAMES, Bounds
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import BodyStart, Joint, Mechanism
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results import trajectory_files
from bodycheck.results.outcome import Completed, Outcome, Run
from bodycheck.running import simulation
from tests.support import jointed
from tests.support.miniature import coasting

#: A slider on the world that carries a wheel, without gravity: its joints move at constant velocities.
TEXT = """
format = 2
name = "coast"
title = "A wheel on a slider"
[[bodies]]
name = "slider"
mass = 2.0
inertia = [0.1, 0.2, 0.3]
[[bodies]]
name = "wheel"
mass = 0.5
inertia = [0.02, 0.02, 0.03]
[[joints]]
name = "rail"
type = "prismatic"
child = "slider"
axis = [1.0, 0.0, 0.0]
initial = {position = 0.2, velocity = 0.5}
[[joints]]
name = "axle"
type = "revolute"
parent = "slider"
child = "wheel"
position = [0.0, 0.3, 0.0]
axis = [0.0, 0.0, 1.0]
initial = {position = 1.0, velocity = 40.0}
[scene]
gravity = 0.0
[run]
duration = 1.0
samples = 11
"""
METHOD = Method.parse("coast", 0.01)


@pytest.fixture(scope="module")
def case() -> Case:
    return parse(TEXT, "coast.case.toml")


def mechanism_of(case: Case) -> Mechanism:
    assert isinstance(case.scene, Mechanism)
    return case.scene


def exact_truth(case: Case) -> Truth:
    """The truth of the case, which is a closed form."""
    mechanism = mechanism_of(case)
    t = simulation.sampling_times(case.instants, METHOD.sampling)
    motion = coasting.motion(mechanism, t)
    joints = kinematics.joints(mechanism, motion)
    small = np.full(case.samples, 1e-15)
    return Truth(
        mechanism, motion, Bounds(*[small] * len(NAMES)), "closed form: coasting", "", "numpy", joints=joints, growth=small
    )


def outcome(case: Case, adapter: coasting.Coasting) -> Outcome:
    times = simulation.sampling_times(case.instants, METHOD.sampling)
    return simulation.outcome_in(adapter, "coasting", case.scene, METHOD, times)


def test_a_run_has_the_states_of_all_bodies_in_their_order(case: Case) -> None:
    done = outcome(case, coasting.Coasting())
    assert isinstance(done, Completed)
    assert done.trajectory.position.shape == (2, 11, 3)
    np.testing.assert_array_equal(done.trajectory.position, exact_truth(case).trajectory.position)


@pytest.mark.parametrize(
    ("adapter", "status", "reason"),
    [
        (coasting.Coasting(coasting.exploding), "diverged", "times the most possible at t = 0.2 s"),
        (coasting.Coasting(coasting.not_a_number), "diverged", "not a number at t = 0.5 s"),
        (coasting.Coasting(frozen=True), "diverged", "the state never changes although bodies move"),
    ],
    ids=["exploding", "not a number", "frozen"],
)
def test_impossible_motions_are_told(case: Case, adapter: coasting.Coasting, status: str, reason: str) -> None:
    ended = outcome(case, adapter)
    assert ended.status == status
    assert reason in ended.reason


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (coasting.misplaced, r"at t = 0 the position of the body wheel is \[0.2, 0.3, 0.001\], not \[0.2, 0.3, 0.0\]"),
        (coasting.bodiless, r"its states have the shape \(1, 11, 1, 13\), not \(1, 11, 2, 13\)"),
    ],
)
def test_states_that_cannot_be_those_of_the_mechanism_are_faults_of_the_adapter(
    case: Case, spoil: coasting.Spoil, reason: str
) -> None:
    with pytest.raises(simulation.AdapterFault, match=reason):
        outcome(case, coasting.Coasting(spoil))


def test_what_an_engine_does_not_model_is_named(case: Case) -> None:
    mechanism = mechanism_of(case)
    damped = tuple(replace(joint, damping=0.1) for joint in mechanism.joints)
    ended = outcome(replace(case, scene=replace(mechanism, joints=damped, gravity=9.81)), coasting.Coasting())
    assert (ended.status, ended.reason) == ("unsupported", "coasting 1.0 does not model gravity, joint damping")


def run_of(case: Case, spoil: coasting.Spoil) -> Run:
    return Run(case.name, "coasting", "1.0", METHOD, outcome(case, coasting.Coasting(spoil)), scene=case.scene)


def test_figures_are_the_largest_over_bodies_and_joints(case: Case) -> None:
    found = compare(exact_truth(case), run_of(case, coasting.aside)).maxima()
    assert found["position_error"] == pytest.approx(0.05, rel=1e-12)
    assert found["constraint_error"] == pytest.approx(0.05, rel=1e-12)
    assert found["joint_slide_error"] == found["joint_position_error"] == 0
    assert found["energy_drift"] == pytest.approx(0, abs=1e-15)
    assert not {"rotational_energy_drift", "angular_momentum_drift", "momentum_drift", "energy_error"} & set(found)
    exact = compare(exact_truth(case), run_of(case, coasting.exact)).maxima()
    assert all(value <= 1e-15 for name, value in exact.items() if not FIGURES[name].of_truth)


def test_the_verdict_of_a_mechanism_has_the_figures_of_its_joints(case: Case) -> None:
    row = verdict(case, exact_truth(case), run_of(case, coasting.aside)).row()
    assert row["kind"] == "mechanism"
    assert {"joint_position_error", "joint_slide_error", "constraint_error"} <= set(row) & set(FIGURES)


def test_angles_and_slides_are_told_apart(case: Case) -> None:
    mechanism, truth = mechanism_of(case), exact_truth(case)
    rail, axle = mechanism.joints
    faster = replace(mechanism, joints=(replace(rail, start_velocity=(0.6,)), replace(axle, start_velocity=(40.5,))))
    moved = coasting.motion(faster, truth.trajectory.t)
    found = compare(truth, Run(case.name, "coasting", "1.0", METHOD, Completed(moved, 100, 1.0))).maxima()
    assert found["joint_slide_error"] == pytest.approx(0.1)
    assert found["joint_position_error"] == pytest.approx(0.5)
    assert found["constraint_error"] == pytest.approx(0, abs=1e-15)


def test_momenta_of_a_floating_pair_drift_by_what_is_planted() -> None:
    """Two bodies of a free-floating chain: one per mille more of all velocities from the second instant on."""
    start = BodyStart(velocity=(1.0, 0.0, 0.0), rotation=(0.0, 0.0, 2.0))
    pair = Mechanism(
        (replace(jointed.body("one", 1.0, (0.1, 0.2, 0.3)), start=start), jointed.body("two", 1.0, (0.1, 0.2, 0.3))),
        (Joint("pin", "revolute", 0, 1, (1.0, 0.0, 0.0), start=(0.0,), start_velocity=(0.0,)),),
    )
    still = kinematics.initial(pair)
    t = np.array([0.0, 1.0])
    states = [np.repeat(part, 2, axis=1) for part in (still.position, still.quaternion, still.velocity, still.angular_velocity)]
    exact = Trajectory(t, *states)
    small = np.zeros(2)
    truth = Truth(pair, exact, Bounds(*[small] * len(NAMES)), "made up", "", "numpy", joints=kinematics.joints(pair, exact))
    grown = np.array([1.0, 1.001])[:, None]
    seen = replace(exact, velocity=exact.velocity * grown, angular_velocity=exact.angular_velocity * grown)
    run = Run("pair", "made up", "1.0", METHOD, Completed(seen, 100, 1.0))
    found = compare(truth, run).maxima()
    assert found["momentum_drift"] == pytest.approx(1e-3)
    falling = replace(truth, scene=replace(pair, gravity=9.81))
    heavier = replace(seen, angular_velocity=exact.angular_velocity, velocity=exact.velocity + np.array([[0.0], [1.0]]))
    assert compare(falling, replace(run, outcome=Completed(heavier, 100, 1.0))).maxima()["momentum_drift"] < 1e-15


def test_trajectories_of_mechanisms_are_stored_by_the_names_of_bodies(case: Case, tmp_path: Path) -> None:
    motion, names = exact_truth(case).trajectory, ("slider", "wheel")
    trajectory_files.write(tmp_path, Path("run.parquet"), motion, {"truth_growth": motion.t}, names)
    read, _, growth = trajectory_files.read_truth(tmp_path / "run.parquet", names)
    np.testing.assert_array_equal(read.quaternion, motion.quaternion)
    np.testing.assert_array_equal(read.velocity, motion.velocity)
    np.testing.assert_array_equal(growth, motion.t)
    for wrong in ((), ("slider", "lever")):
        with pytest.raises(BadFolder, match="no column"):
            trajectory_files.read(tmp_path / "run.parquet", wrong)
