"""The reason of a failed run names the joint that is too stiff for the time step, if there is one."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms.control import Controller
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.results.outcome import Completed, Diverged, Outcome
from bodycheck.running.simulation import outcome_in
from bodycheck.running.stiff_joints import explained
from tests.support.coupled_joints import pair
from tests.support.jointed import four_bar, free_chain, on_one_joint

STEP = 0.002

METHODS = [("mujoco", "RK4"), ("pinocchio", "semi-implicit-euler"), ("pinocchio", "rk4")]


def planted(**acting: float) -> Mechanism:
    """The free chain with something in the joint of its last body."""
    chain = free_chain()
    shoulder, wrist = chain.joints
    return replace(chain, joints=(shoulder, replace(wrist, **acting)))  # type: ignore[arg-type]


def ran(mechanism: Mechanism, name: str, spelling: str, step: float = STEP) -> Outcome:
    """The outcome of a run of half a second."""
    times = np.arange(0.0, 0.5, 0.01)
    return outcome_in(registry.load(name), name, mechanism, Method.parse(spelling, step), times)


def needed(reason: str) -> float:
    """The step (s) that a reason calls for."""
    return float(reason.split("h < ")[1].split()[0])


@pytest.mark.parametrize(("name", "spelling"), METHODS)
@pytest.mark.parametrize(
    ("acting", "words"), [({"damping": 900.0}, "damping × h / inertia = "), ({"stiffness": 4e5, "rest": -0.7}, "h × √(")]
)
def test_a_run_that_fails_names_the_stiff_joint_and_the_step_that_it_needs(
    name: str, spelling: str, acting: dict[str, float], words: str
) -> None:
    failed = ran(planted(**acting), name, spelling)
    assert isinstance(failed, Diverged)
    assert f"; wrist: {words}" in failed.reason
    # The step of the reason is that at the limit; nine tenths of it are stable, as one joint alone is stiff.
    assert isinstance(ran(planted(**acting), name, spelling, 0.9 * needed(failed.reason)), Completed)


@pytest.mark.parametrize(
    ("gains", "words"),
    [({"kd": 900.0}, "(damping + kd) × h / inertia = "), ({"kp": 4e5}, "h × √((stiffness + kp) / inertia) = ")],
)
def test_the_gains_of_a_controller_make_a_joint_stiff(gains: dict[str, float], words: str) -> None:
    chain = free_chain()
    driven = replace(chain, controllers=(Controller(1, target=0.7, **gains),))
    failed = ran(driven, "mujoco", "RK4")
    assert isinstance(failed, Diverged)
    assert f"; wrist: {words}" in failed.reason
    assert isinstance(ran(driven, "mujoco", "RK4", 0.9 * needed(failed.reason)), Completed)
    cut = replace(driven, controllers=(replace(driven.controllers[0], effort_limit=1.0),))
    assert explained(failed, cut, Method("RK4", STEP), 4) == failed


def test_the_time_and_the_signal_of_the_engine_stay_in_the_reason() -> None:
    failed = ran(planted(damping=900.0), "mujoco", "RK4")
    assert isinstance(failed, Diverged)
    assert failed.signal == "reset"
    assert failed.reason.startswith("MuJoCo reset itself after BADQACC at t = ")


@pytest.mark.parametrize(
    ("mechanism", "spelling"),
    [
        (planted(damping=0.1, stiffness=1.0, friction=1.0), "RK4"),
        (four_bar(), "RK4"),
        (planted(damping=900.0), "RK4:accuracy=1e-6"),
    ],
)
def test_nothing_is_added_where_no_joint_is_beyond_the_limit_or_where_it_is_not_known(
    mechanism: Mechanism, spelling: str
) -> None:
    failure = Diverged("not a number at t = 0.01 s", "gave up")
    assert explained(failure, mechanism, Method.parse(spelling, STEP), 4) == failure


@pytest.mark.parametrize(("order", "limit"), [(None, 2.0), (1, 2.0), (4, 2.785)])
def test_the_limit_is_that_of_the_scheme(order: int | None, limit: float) -> None:
    """A wheel of 1 kg m^2 with the damping c has h c = 0.002 c."""
    for factor, stiff in ((0.99, False), (1.01, True)):
        wheel = on_one_joint("revolute", 0.0, 1.0, damping=factor * limit / STEP)
        failure = explained(Diverged("not a number"), wheel, Method.parse("any", STEP), order)
        expected = f"; joint: damping × h / inertia = {factor * limit:.3g}: an explicit step needs h < {STEP / factor:.2g} s"
        assert failure.reason == "not a number" + expected * stiff


def test_joints_that_move_together_share_their_inertia_and_their_damping() -> None:
    """The inertia is 0.04 + 4 * 0.05 kg m^2 and the damping 1000 (0.1 + 4 * 0.2) N m s/rad."""
    leader, follower = pair(-2.0).joints
    both = replace(pair(-2.0), joints=(replace(leader, damping=100.0), replace(follower, damping=200.0)))
    reason = explained(Diverged("not a number"), both, Method.parse("rk4", STEP), 4).reason
    assert f"; leader: damping × h / inertia = {STEP * 900 / 0.24:.3g}: an explicit" in reason
    assert reason.endswith(" s")


def test_dry_friction_is_named_if_it_turns_a_hinge_by_more_than_a_radian_in_a_step() -> None:
    failure = Diverged("not a number at t = 0.01 s")
    reason = explained(failure, planted(friction=1e6), Method.parse("rk4", STEP), 4).reason
    assert "wrist: friction × h² / inertia = " in reason
    assert reason.count(" rad: an explicit step needs h < ") == 1


def test_of_several_stiff_joints_the_stiffest_is_named() -> None:
    shoulder, wrist = planted(damping=900.0).joints
    both = replace(planted(), joints=(replace(shoulder, damping=5e4), wrist))
    reason = explained(Diverged("not a number"), both, Method.parse("rk4", STEP), 4).reason
    assert reason.startswith("not a number; shoulder: damping × h / inertia = ")
    assert reason.endswith(" s (and 1 more)")
