"""Ranges and actuators that a case takes over from a robot's file (`[model] use`)."""

from pathlib import Path

import pytest

from bodycheck import CaseFaults, load
from bodycheck.casefile.case import parse_stored
from bodycheck.casefile.content import Case
from bodycheck.casefile.robots.direct import text_of_robot
from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.mechanism import Mechanism

MJCF = """<mujoco><compiler angle="radian"/><worldbody>
<body><joint name="j" range="-1 2"/><geom size="0.1" pos="1 0 0"/></body>
<body pos="0 3 0"><joint name="k" type="slide" range="0.5 0.7"/><geom size="0.1" pos="1 0 0"/></body>
<body pos="0 6 0"><joint name="l"/><geom size="0.1" pos="1 0 0"/></body>
</worldbody>
<tendon><fixed name="t" range="-5 5"><joint joint="j" coef="1"/><joint joint="l" coef="2"/></fixed></tendon>
<actuator><position joint="j" kp="20" kv="0.4"/><position tendon="t"/><motor joint="l"/></actuator>
<keyframe><key qpos="0 0.6 0" ctrl="0.25 0 0"/></keyframe></mujoco>"""

URDF = """<robot name="r"><link name="base"/>
<link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="leader" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="follower" type="revolute"><parent link="base"/><child link="b"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="3" effort="1" velocity="1"/><mimic joint="leader" multiplier="-2" offset="1"/></joint></robot>"""


def read(folder: Path, keys: str, robot: str = MJCF, tables: str = "") -> tuple[Case, Mechanism]:
    """Return the case of a model with some keys, and its scene; its stored text is the same case."""
    file = "robot.urdf" if robot.startswith("<robot") else "robot.xml"
    (folder / file).write_text(robot)
    path = folder / "robot.case.toml"
    path.write_text(
        f'format = 2\nname = "robot"\ntitle = "Robot"\n[model]\nfile = "{file}"\n{keys}\n[scene]\ngravity = 9.81\n'
        f"[run]\nduration = 1.0\nsamples = 11\n{tables}"
    )
    case = load(path)
    assert isinstance(case.scene, Mechanism)
    assert parse_stored(case.text, "stored").scene == case.scene
    return case, case.scene


def stops(scene: Mechanism) -> dict[str, Stops]:
    return {joint.name: joint.stops for joint in scene.joints if joint.stops is not None}


def test_ranges_are_rigid_stops(tmp_path: Path) -> None:
    case, scene = read(tmp_path, 'use = ["limits"]\nignore = ["actuators"]\nkeyframe = 0')
    assert stops(scene) == {"j": Stops(-1.0, 2.0), "k": Stops(0.5, 0.7)}
    assert case.robot is not None
    assert [each.name for each in case.robot.ranges] == ["tendon t"]
    assert case.robot.without == ("actuators",)


def test_a_joint_that_starts_outside_its_range(tmp_path: Path) -> None:
    with pytest.raises(
        CaseFaults, match=r"joint 'k': its range: lower 0.5 the joint starts outside, at 0.0.*leaves this range out"
    ):
        read(tmp_path, 'use = ["limits"]\nignore = ["actuators"]')
    case, scene = read(tmp_path, 'use = ["limits"]\nignore = ["actuators", "limits"]')
    assert stops(scene) == {"j": Stops(-1.0, 2.0)}
    assert case.robot is not None
    assert any(notice.startswith("The range of the joint k is left out") for notice in case.robot.notices)


def test_the_stops_of_joints_that_follow_others_are_those_of_their_leader(tmp_path: Path) -> None:
    """The follower is at 1 - 2 q, in its range for q from -1 to 1."""
    assert stops(read(tmp_path, 'use = ["limits"]', URDF)[1]) == {"leader": Stops(-1.0, 1.0)}


def test_stops_of_joints_that_follow_others_are_left_out_where_the_case_allows_it(tmp_path: Path) -> None:
    """The truth does not have them, so that the notices say when the range of the leader is passed."""
    case, scene = read(tmp_path, 'use = ["limits"]\nignore = ["limits"]', URDF)
    assert not stops(scene)
    assert case.robot is not None
    assert [(each.name, each.lower, each.upper) for each in case.robot.ranges] == [("leader", -1.0, 1.0)]
    left_out = "The range of the joint leader is left out: stops of joints that follow others or are followed are not modelled."
    assert left_out in case.robot.notices


def test_actuators_are_controllers(tmp_path: Path) -> None:
    case, scene = read(tmp_path, 'use = ["actuators"]\nignore = ["actuators"]\nkeyframe = 0')
    assert scene.controllers == (Controller(0, kp=20.0, kd=0.4, target=0.25),)
    assert case.robot is not None
    assert "1 position servo (line 7) acts with the controls of the keyframe." in case.robot.notices
    assert "1 position servo (line 7) acts on something else than a joint, and is left out." in case.robot.notices
    assert "1 motor (line 7) is without control and exerts nothing." in case.robot.notices


def test_an_actuator_that_is_no_controller_is_a_fault(tmp_path: Path) -> None:
    with pytest.raises(CaseFaults) as caught:
        read(tmp_path, 'use = ["actuators"]')
    assert [fault.message for fault in caught.value.faults] == [
        "read 'robot.xml'; 1 position servo (robot.xml, line 7) acts on something else than a joint, "
        'which a case cannot state yet; ignore = ["actuators"] leaves it out'
    ]


def test_a_controller_takes_the_place_of_an_actuator(tmp_path: Path) -> None:
    controller = '[[controllers]]\njoint = "j"\nlaw = "effort"\neffort = 3.0\n'
    _, scene = read(tmp_path, 'use = ["actuators"]\nignore = ["actuators"]', tables=controller)
    assert scene.controllers == (Controller(0, "effort", effort=3.0),)


def test_a_robot_by_itself_has_its_actuators_as_controllers(tmp_path: Path) -> None:
    robot = tmp_path / "arm.xml"
    robot.write_text(MJCF)
    case = load(robot)
    assert isinstance(case.scene, Mechanism)
    assert case.scene.controllers == (Controller(0, kp=20.0, kd=0.4, target=0.25),)
    assert stops(case.scene) == {"j": Stops(-1.0, 2.0), "k": Stops(0.5, 0.7)}
    assert case.robot is not None
    assert [each.name for each in case.robot.ranges] == ["tendon t"]
    written = tmp_path / "arm.case.toml"
    written.write_text(text_of_robot(robot))
    assert load(written) == case
    without = load(robot, ignore=["actuators"])
    assert isinstance(without.scene, Mechanism)
    assert without.scene.controllers == ()
    assert without.robot is not None
    assert without.robot.without == ("actuators",)
