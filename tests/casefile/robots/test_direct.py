"""The case that a robot's file is by itself."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import CaseFaults, load, truth
from bodycheck.casefile.authoring import new_of_model
from bodycheck.casefile.case import parse_stored
from bodycheck.casefile.robots import direct
from bodycheck.casefile.robots.direct import scene_of_robot, text_of_robot
from bodycheck.casefile.robots.named import case_name, short_name
from bodycheck.files import reading
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.mechanisms.truth import end_of_stops
from tests.support.robot_cases import URDF


def test_a_file_is_a_case_and_its_text_is_the_file_of_that_case(tmp_path: Path) -> None:
    robot = tmp_path / "arm.urdf"
    robot.write_text(URDF)
    case = scene_of_robot(robot, base="free", ignore=["friction"])
    assert (case.name, case.duration, case.samples) == ("arm", 1.0, 101)
    assert isinstance(case.scene, Mechanism)
    assert case.scene.gravity == 9.81
    assert [joint.name for joint in case.scene.joints] == ["base", "shoulder", "reach", "wrist"]
    assert case.robot is not None
    assert case.robot.without == ("friction",)
    written = tmp_path / "arm.case.toml"
    written.write_text(text := text_of_robot(robot, base="free", ignore=["friction"], stops=False))
    assert load(written) == case
    for joint in ("shoulder", "reach", "wrist"):
        assert f"[initial.joints.{joint}]" in text
    robot.unlink()
    assert parse_stored(case.text, "stored") == case


#: A leg that swings down to the range of its follower, of which stops are not modelled.
#: A weight that falls along a rail, which ends at 0.1 m.
RAIL = """<robot name="rail"><link name="rail"/>
<link name="weight"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="weight"/><axis xyz="0 0 -1"/>
  <limit lower="-1" upper="0.1" effort="1" velocity="1"/></joint></robot>"""

FOLLOWED = """<robot name="leg">
<link name="hip"/>
<link name="upper"><inertial><origin xyz="0.3 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"
  ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.2 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"
  ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="revolute"><parent link="hip"/><child link="upper"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="knee" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
  <mimic joint="hinge" multiplier="0.5"/><limit lower="-1" upper="0.25" effort="1" velocity="1"/></joint>
</robot>"""


def test_the_truth_with_stops_ends_at_a_stop_that_is_not_modelled(tmp_path: Path) -> None:
    """The knee bends with the hinge, and reaches its stop where the hinge is at 0.5 rad."""
    (tmp_path / "leg.urdf").write_text(FOLLOWED)
    (tmp_path / "leg.case.toml").write_text(
        'format = 2\nname = "leg"\ntitle = "Leg"\n[model]\nfile = "leg.urdf"\nuse = ["limits"]\n'
        "[scene]\ngravity = 9.81\n[run]\nduration = 1.0\nsamples = 101\n"
    )
    case = load(tmp_path / "leg.case.toml")
    assert isinstance(case.scene, Mechanism)
    ended = end_of_stops(case.scene, case.instants)
    assert ended is not None
    until, reason = ended
    assert until in case.instants
    assert reason.startswith("the stop of hinge, a joint that follows another or is followed, is not modelled, from t = ")
    free = truth(replace(case, scene=replace(case.scene, joints=without_stops(case.scene))))
    assert free.joints is not None
    hinge = free.joints.position[:, 0]
    assert hinge[case.instants == until] < 0.5 <= hinge[int(np.searchsorted(case.instants, until)) + 1]
    known = truth(replace(case, scene=replace(case.scene, stops_until=until)))
    assert known.joints is not None
    assert known.joints.position[:, 0] == pytest.approx(hinge, abs=1e-12)  # no stop is reached before: one motion


def test_stops_act_until_the_truth_with_them_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever ends the truth with stops, they act until then, and the notice says why."""
    (tmp_path / "rail.urdf").write_text(RAIL)
    monkeypatch.setattr(direct, "_ended", lambda _: (0.2, "two stops meet"))
    case = load(tmp_path / "rail.urdf")
    assert isinstance(case.scene, Mechanism)
    assert case.scene.stops_until == 0.2
    assert case.robot is not None
    said = "From 0.2 s on this is the robot without its stops, since the truth with stops ends there: two stops meet."
    assert case.robot.notices[0] == said
    assert parse_stored(case.text, "stored") == case
    known = truth(case)
    assert known.joints is not None
    position = known.joints.position[:, 0]
    assert position[15] == position[20] == 0.1  # it rests at the stop, and falls on from there
    assert position[40] == pytest.approx(0.1 + 9.81 * 0.2**2 / 2, abs=1e-14)
    monkeypatch.chdir(tmp_path)
    written = new_of_model(None, Path(), Path("rail.urdf"), (), ())
    assert 'use = ["actuators"]' in written.read_text()
    assert isinstance(scene := load(written).scene, Mechanism)
    assert not any(joint.stops for joint in scene.joints)


def without_stops(scene: Mechanism) -> tuple[Joint, ...]:
    return tuple(replace(joint, stops=None) for joint in scene.joints)


def test_a_link_that_the_user_names_is_followed(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF)
    (tmp_path / "link.urdf").symlink_to("arm.urdf")
    assert scene_of_robot(tmp_path / "link.urdf").scene == scene_of_robot(tmp_path / "arm.urdf").scene


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("Arm_2.urdf", "arm-2"),
        ("panda/robot.xml", "panda"),
        ("panda/scene.xml", "panda"),
        ("é/model.xml", "robot"),
        ("é/é.xml", "robot"),
    ],
)
def test_the_name_of_the_case(tmp_path: Path, path: str, name: str) -> None:
    assert case_name(short_name(tmp_path / path)) == name


def test_each_file_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first keyframe is that of an included file, which is not known before the files are read."""
    body = '<body><joint name="j"/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/></body>'
    (tmp_path / "arm.xml").write_text(f'<mujoco><include file="keys.xml"/><worldbody>{body}</worldbody></mujoco>')
    (tmp_path / "keys.xml").write_text('<mujoco><keyframe><key name="home" qpos="0.5"/></keyframe></mujoco>')
    content, opened = reading.content, list[str]()

    def counted(path: Path, *limits: Any) -> bytes:
        opened.append(path.name)
        return content(path, *limits)

    monkeypatch.setattr(reading, "content", counted)
    case = scene_of_robot(tmp_path / "arm.xml")
    assert sorted(opened) == ["arm.xml", "keys.xml"]
    assert 'keyframe = "home"' in case.text
    assert isinstance(case.scene, Mechanism)
    assert case.scene.joints[0].start == (0.5,)


def test_the_command_that_runs_a_refused_robot_keeps_the_options_of_the_user(tmp_path: Path) -> None:
    body = '<body gravcomp="1"><joint name="j"/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/></body>'
    servo = '<actuator><position joint="j" kp="1"/></actuator>'
    robot = tmp_path / "arm.xml"
    robot.write_text(f"<mujoco><worldbody>{body}</worldbody>{servo}</mujoco>")
    with pytest.raises(CaseFaults) as caught:
        load(robot, packages=[tmp_path / "parts"], ignore=["actuators"])
    assert [fault.ignore for fault in caught.value.faults] == ["gravity_compensation", None]
    options = f"--package-path {tmp_path / 'parts'} --ignore actuators --ignore gravity_compensation"
    assert caught.value.faults[-1].message == f"runs without them by: bodycheck run {robot} {options}"


def test_faults_name_the_robot_s_file_alone(tmp_path: Path) -> None:
    robot = tmp_path / "arm.urdf"
    robot.write_text(URDF.replace('izz="0.03"', 'izz="0.3"'))
    with pytest.raises(CaseFaults) as caught:
        scene_of_robot(robot)
    assert str(caught.value).startswith(f"{robot}: body 'tool': inertia: no body has these moments")
    robot.write_text(URDF.replace('<mass value="0.5"/>', '<mass value="x"/>'))
    with pytest.raises(CaseFaults) as caught:
        scene_of_robot(robot)
    assert [str(fault).startswith(f"{robot}: arm.urdf:") for fault in caught.value.faults] == [True, True]
    with pytest.raises(CaseFaults, match="No such file"):
        scene_of_robot(tmp_path / "none.urdf")
