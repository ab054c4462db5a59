"""Gravity of an MJCF file that is not along -z, in a world of which the axes are turned."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bodycheck
from bodycheck.reference.mechanisms.mechanism import Mechanism

mujoco: Any = pytest.importorskip("mujoco")

#: A swing, and a free body that is not at the pose of the file but at that of a keyframe.
MODEL = """<mujoco>
  <option gravity="{}" timestep="0.01" integrator="RK4"/>
  <worldbody>
    <body name="swing" pos="0.1 0.2 0.3" euler="10 20 30">
      <joint name="swing" axis="0 1 0.5"/><geom size="0.1" pos="0.3 0 0.1" {}/>
    </body>
    <body name="stone" pos="1 0 0"><freejoint name="stone"/><geom type="box" size="0.1 0.2 0.3" {}/>
      <body name="arm" pos="0.2 0 0"><joint name="arm" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0" {}/></body>
    </body>
  </worldbody>
  <keyframe><key qpos="0.4 1 2 3 0.8 0 0.6 0 0.2" qvel="1 0.3 0.2 0.1 1 2 3 -1"/></keyframe>
</mujoco>"""


@pytest.mark.parametrize("gravity", ["1e-5 0 -9.81", "3 -4 5", "0 0 9.81"])
def test_the_motion_is_that_of_mujoco_in_turned_axes(tmp_path: Path, gravity: str) -> None:
    """Distances between centres of mass need no axes. The step's error of RK4 of MuJoCo is below 1e-6 m."""
    (tmp_path / "tilted.xml").write_text(MODEL.format(gravity, *['contype="0" conaffinity="0"'] * 3))
    case = bodycheck.load(tmp_path / "tilted.xml")
    assert isinstance(case.scene, Mechanism)
    assert case.scene.gravity == pytest.approx(np.linalg.norm(np.array(gravity.split(), float)), rel=1e-15)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "tilted.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    from bodycheck.running import truths

    truth = truths.truth(case).trajectory
    for index in (0, 50):
        while data.time < truth.t[index] - 1e-9:
            mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        there = data.xipos[1:] @ -np.array(gravity.split(), float) / case.scene.gravity
        here = np.array([truth.body(body).position[index, 2] for body in range(3)])
        np.testing.assert_allclose(here, there, atol=1e-6, err_msg="heights against gravity")
        apart = np.linalg.norm(data.xipos[1:, None] - data.xipos[None, 1:], axis=-1)
        places = np.array([truth.body(body).position[index] for body in range(3)])
        np.testing.assert_allclose(np.linalg.norm(places[:, None] - places[None], axis=-1), apart, atol=1e-6)


def test_turned_axes_are_told(tmp_path: Path) -> None:
    (tmp_path / "tilted.xml").write_text(MODEL.format("1 0 -9", "", "", ""))
    case = bodycheck.load(tmp_path / "tilted.xml")
    assert case.robot is not None
    said = (
        "1 gravity (line 2) is 1 0 -9 m/s^2: the world is turned so that gravity points along -z, and no contact is looked for."
    )
    assert any(said in notice for notice in case.robot.notices), case.robot.notices
    assert not case.robot.touching
    assert "upright = true" in case.text


def test_a_case_that_states_its_own_gravity_has_the_axes_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "tilted.xml").write_text(MODEL.format("1 0 -9", "", "", ""))
    (tmp_path / "own.case.toml").write_text(
        'format = 2\nname = "own"\ntitle = "Own gravity."\n[model]\nfile = "tilted.xml"\n[scene]\ngravity = 9.81\n'
        "[run]\nduration = 0.1\nsamples = 2\n"
    )
    scene = bodycheck.load(tmp_path / "own.case.toml").scene
    assert isinstance(scene, Mechanism)
    assert scene.joints[0].position == (0.1, 0.2, 0.3)
