"""The case that a robot's file is by itself."""

from pathlib import Path

import pytest

from bodycheck import CaseFaults, load
from bodycheck.casefile.case import parse_stored
from bodycheck.casefile.robots.direct import case_name, scene_of_robot, text_of_robot
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
    [("Arm_2.urdf", "arm-2"), ("panda/robot.xml", "panda"), ("é/model.xml", "model"), ("é/é.xml", "robot")],
)
def test_the_name_of_the_case(tmp_path: Path, path: str, name: str) -> None:
    assert case_name(tmp_path / path) == name


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
