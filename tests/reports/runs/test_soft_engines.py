"""The report of a case says what engines model by springs and dampers, and which joints follow others."""

from dataclasses import replace

from bodycheck.adapters import registry
from bodycheck.casefile.case import load
from bodycheck.reports.runs.scenes import describe, softness
from tests.support.coupled_joints import gripper
from tests.support.jointed import cart_pole, four_bar

SOFT = {"mujoco": registry.load("mujoco").engine.soft, "mjx": registry.load("mujoco").engine.soft}


def test_only_what_a_scene_has_is_named() -> None:
    (fact,) = softness(gripper(friction=0.1), SOFT)
    assert fact.text == (
        "joint friction (solreffriction, solimpfriction) and mimic joints (solref, solimp) in mujoco and mjx. "
        "A part of the error does not vanish with the time step."
    )
    (fact,) = softness(four_bar(), SOFT)
    assert fact.text.startswith("loops (solref, solimp) in mujoco and mjx.")
    assert softness(cart_pole(), SOFT) == ()
    assert softness(gripper(), {}) == ()


def test_a_joint_that_follows_another_is_told_as_one() -> None:
    case = replace(load("cart-pole"), scene=gripper())
    joints = next(fact.text for fact in describe(case, ()) if fact.term == "Joints")
    assert "second: prismatic, second on link, follows first" in joints
    many = replace(case, scene=replace(gripper(), joints=gripper().joints * 2))
    joints = next(fact.text for fact in describe(many, ()) if fact.term == "Joints")
    assert joints.endswith("with 2 joints that follow others")
