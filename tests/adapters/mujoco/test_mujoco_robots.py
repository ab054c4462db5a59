"""Robot models in MuJoCo: what its reader makes of what files say, and its compiled models as robot models."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters.mujoco import robots
from bodycheck.adapters.robot_reading import ModelRefused
from bodycheck.reference.robots.model import Mimic, RobotJointType
from bodycheck.reference.robots.state import RobotState
from tests.support.robot_texts import GRAVITY, MASSLESS, MIMIC, RIDES, WELDED_BASE, hinges, on, ridden, written
from tests.support.robot_truths import assert_the_same

#: Joints with anchors, references, springs and turned frames; several on a body; a body with a weld; a free body.
MJCF = """
<mujoco model="stack">
  <compiler angle="radian"/>
  <option gravity="0.1 0 -3"/>
  <worldbody>
    <body name="base" pos="0.1 0.2 0.3" quat="0.5 0.1 -0.7 0.5">
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.2 0.25"/>
      <joint name="slide" type="slide" axis="1 2 0" ref="0.2" armature="0.3" damping="0.4"/>
      <joint name="hinge" axis="0 1 1" pos="0.1 0 -0.2" ref="0.4" stiffness="2" springref="0.7" frictionloss="0.3"/>
      <body name="welded" pos="0 0 0.4" quat="0.7 0 0.7 0">
        <inertial pos="0 0.1 0" mass="0.7" fullinertia="0.05 0.06 0.02 0.004 0.003 -0.002"/>
        <body name="ball" pos="0 0.3 0">
          <inertial pos="0.02 0 0.1" mass="0.4" quat="0.6 0 0.8 0" diaginertia="0.01 0.02 0.025"/>
          <joint name="socket" type="ball" pos="0 0 -0.1" damping="0.05"/>
        </body>
      </body>
    </body>
    <body name="flyer" pos="1 0 0" quat="0.8 0 0 0.6">
      <freejoint name="free"/>
      <inertial pos="0.1 0.2 0" mass="2" diaginertia="0.1 0.2 0.25"/>
      <body name="finger">
        <joint name="curl" axis="0 0 1" range="-1 1.5" actuatorfrcrange="-4 4"/>
        <inertial pos="0.1 0 0" mass="0.1" diaginertia="0.01 0.01 0.01"/>
      </body>
      <body name="thumb">
        <joint name="follow" axis="0 0 1"/>
        <inertial pos="0.1 0 0" mass="0.1" diaginertia="0.01 0.01 0.01"/>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="follow" joint2="curl" polycoef="0.1 -2 0 0 0"/></equality>
  <actuator><motor name="pull" joint="curl" gear="3"/></actuator>
</mujoco>
"""


def test_what_is_welded_to_the_world_loses_its_name_and_its_mass(tmp_path: Path) -> None:
    reading = robots.read_robot(written(WELDED_BASE, tmp_path), [], GRAVITY)
    assert [(body.name, body.parent) for body in reading.bodies] == [("world", None), ("arm", "world")]
    assert [body.mass for body in reading.bodies] == [0.0, 1.5]
    assert reading.links == ("arm",)
    assert any("fusestatic" in note for note in reading.notes)


def test_a_moving_link_without_mass_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelRefused, match="mass and inertia of moving bodies must be larger than mjMINVAL"):
        robots.read_robot(written(MASSLESS, tmp_path), [], GRAVITY)


def test_mimic_joints_of_a_urdf_keep_their_own_velocities(tmp_path: Path) -> None:
    """A soft constraint ties them."""
    reading = robots.read_robot(written(MIMIC, tmp_path), [hinges("first", "second")], GRAVITY)
    assert [(joint.name, joint.first, joint.mimic) for joint in reading.joints] == [
        ("first", 0, None),
        ("second", 1, Mimic("first", -2.0, 0.1)),
    ]
    assert "not compared: equality constraints (1 joint)" in reading.notes


@pytest.mark.parametrize(("type", "axis"), [("floating", ""), ("spherical", ""), ("planar", "0.6 0 0.8"), ("planar", "0 0 1")])
def test_joints_of_several_velocities_have_the_motion_that_was_asked_for(
    type: RobotJointType, axis: str, tmp_path: Path
) -> None:
    reading = robots.read_robot(written(on(type, axis), tmp_path), [RIDES[type]], GRAVITY)
    assert [(joint.name, joint.type) for joint in reading.joints] == [("ride", type), ("spin", "revolute")]
    assert_the_same(reading.terms[0], ridden(type, axis), RIDES[type], GRAVITY)


#: A state of the joints of `MJCF`.
STACKED = RobotState(
    *(
        {"free": riding["ride"], "socket": rolling["ride"], **turning}
        for riding, rolling, turning in zip(
            *(
                (state.positions, state.velocities, state.accelerations, state.efforts)
                for state in (RIDES["floating"], RIDES["spherical"], hinges("slide", "hinge", "curl", "follow"))
            ),
            strict=True,
        )
    )
)


def test_a_compiled_model_is_a_robot_model_with_the_same_terms(tmp_path: Path) -> None:
    """In every joint, with MuJoCo's coordinates: references, anchors and several joints of one body."""
    file = written(MJCF, tmp_path, "mjcf")
    model = robots.compiled(file.path)
    assert model.name == "stack"
    assert model.gravity == (0.1, 0.0, -3.0)
    assert [joint.name for joint in model.joints] == [
        *("slide", "hinge", "base/weld", "welded/weld", "socket", "ball/weld", "free", "curl", "follow")
    ]
    assert {"base/slide", "base/hinge", "ball/socket", "base", "flyer"} <= {link.name for link in model.links}
    follow, curl = (next(joint for joint in model.joints if joint.name == name) for name in ("follow", "curl"))
    assert follow.mimic == Mimic("curl", -2.0, 0.1)
    assert (curl.lower, curl.upper, curl.effort_limit) == (-1.0, 1.5, 4.0)
    reading = robots.read_robot(file, [STACKED], GRAVITY)
    assert_the_same(reading.terms[0], model, STACKED, GRAVITY)
    assert reading.gravity == model.gravity
    assert [note for note in reading.notes if "pull with gear 3" in note or "1 joint" in note] == list(reading.notes)


def test_springs_damping_and_dry_friction_are_passive_forces(tmp_path: Path) -> None:
    """The spring is slack at its `springref`; dry friction slides at its limit."""
    (terms,) = robots.read_robot(written(MJCF, tmp_path, "mjcf"), [STACKED], GRAVITY).terms
    assert terms.passive_force is not None
    slide, hinge = -0.4 * STACKED.velocities["slide"][0], -2 * (STACKED.positions["hinge"][0] - 0.7)
    np.testing.assert_allclose(
        terms.passive_force[:2], [slide, hinge - 0.3 * np.sign(STACKED.velocities["hinge"][0])], rtol=0, atol=1e-14
    )
