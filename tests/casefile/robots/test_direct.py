"""The case that a robot's file is by itself."""

from pathlib import Path
from typing import Any

import pytest

from bodycheck import CaseFaults, load
from bodycheck.casefile.case import parse_stored
from bodycheck.casefile.robots.direct import scene_of_robot, text_of_robot
from bodycheck.casefile.robots.named import case_name, short_name
from bodycheck.files import reading
from bodycheck.reference.mechanisms.mechanism import Mechanism
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
    written.write_text(text := text_of_robot(robot, base="free", ignore=["friction"]))
    assert load(written) == case
    for joint in ("shoulder", "reach", "wrist"):
        assert f"[initial.joints.{joint}]" in text
    robot.unlink()
    assert parse_stored(case.text, "stored") == case


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
