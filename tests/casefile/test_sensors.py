"""The tables [[sensors]] of both formats, their faults, and limits of sensors in expectations."""

from pathlib import Path

import pytest

from bodycheck.casefile.case import Case, CaseFaults, load, parse
from bodycheck.casefile.expectation import Limit
from bodycheck.reference.sensors.sensor import SENSOR_TYPES

BRICK = """
format = 1
name = "brick"
title = "A brick"
[body]
shape = "brick"
semi_axes = [0.1, 0.2, 0.3]
mass = 1.0
[run]
duration = 1.0
samples = 11
"""

ARM = """
format = 2
name = "arm"
title = "An arm"
[[bodies]]
name = "upper"
mass = 1.0
inertia = [0.1, 0.1, 0.1]
[[bodies]]
name = "lower"
mass = 1.0
inertia = [0.1, 0.1, 0.1]
[[joints]]
name = "shoulder"
type = "spherical"
child = "upper"
[[joints]]
name = "elbow"
type = "revolute"
parent = "upper"
child = "lower"
axis = [0.0, 1.0, 0.0]
[run]
duration = 1.0
samples = 11
"""

IMU = '[[sensors]]\nname = "imu"\ntype = "accelerometer"\n'
WRENCH = '[[sensors]]\nname = "wrench"\ntype = "force_torque"\njoint = "elbow"\n'
EXPECT = '[[expect]]\nengine = "mujoco"\nintegrator = "RK4"\ntimestep = 0.002\n'


def test_sensors_of_a_single_body_need_no_body() -> None:
    (imu, touch) = parse(
        BRICK + IMU + "position = [0.1, 0.0, 0.2]\nquaternion = [0.0, 1.0, 0.0, 0.0]\n"
        '[[sensors]]\nname = "touch"\ntype = "contact_force"\n',
        "brick",
    ).sensors
    assert (imu.name, imu.type, imu.body, imu.joint) == ("imu", "accelerometer", 0, None)
    assert (imu.position, imu.attitude) == ((0.1, 0.0, 0.2), (0.0, 1.0, 0.0, 0.0))
    assert imu.columns == ("imu.x", "imu.y", "imu.z")
    assert touch.form is SENSOR_TYPES["contact_force"]


def test_sensors_of_a_mechanism_name_a_body_or_a_joint() -> None:
    text = ARM + IMU + 'body = "lower"\n' + WRENCH + '[[sensors]]\nname = "torque"\ntype = "joint_effort"\njoint = "elbow"\n'
    imu, wrench, torque = parse(text, "arm").sensors
    assert (imu.body, imu.joint) == (1, None)
    assert (wrench.body, wrench.joint) == (torque.body, torque.joint) == (1, 1)  # the child, and the joint
    assert torque.columns == ("torque",)


def test_sensors_of_a_robot_name_the_parts_of_its_file(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(
        '<robot name="arm"><link name="base"/><link name="tip"><inertial><mass value="1"/>'
        '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="pin" type="continuous"><parent link="base"/><child link="tip"/><axis xyz="0 1 0"/></joint></robot>'
    )
    case = tmp_path / "robot.case.toml"
    case.write_text(
        'format = 2\nname = "robot"\ntitle = "A robot"\n[model]\nfile = "arm.urdf"\n[run]\nduration = 1.0\nsamples = 11\n'
        + IMU
        + 'body = "tip"\n'
        + WRENCH.replace("elbow", "pin")
    )
    loaded = load(case)
    assert isinstance(loaded, Case)
    assert [sensor.name for sensor in loaded.sensors] == ["imu", "wrench"]
    case.write_text(case.read_text().replace('body = "tip"', 'body = "tpi"'))
    with pytest.raises(CaseFaults, match=r"sensors\[1\].body.*tip"):
        load(case)


@pytest.mark.parametrize(
    ("text", "key", "said"),
    [
        (BRICK + IMU + IMU, "sensors[2].name", "stands twice"),
        (BRICK + IMU.replace("accelerometer", "acelerometer"), "sensors[1].type", "accelerometer"),
        (BRICK + IMU + 'joint = "elbow"\n', "sensors[1].joint", "unknown key"),
        (BRICK + WRENCH, "sensors[1].joint", "there is no such joint"),
        (BRICK + IMU + "quaternion = [2.0, 0.0, 0.0, 0.0]\n", "sensors[1].quaternion", "length"),
        (
            BRICK + IMU + "quaternion = [1.0, 0.0, 0.0, 0.0]\neuler_zxz = [0.0, 0.0, 0.0]\n",
            "sensors[1].quaternion",
            "euler_zxz",
        ),
        (ARM + IMU, "sensors[1].body", "is missing"),
        (ARM + IMU + 'body = "loewr"\n', "sensors[1].body", "did you mean 'lower'?"),
        (ARM + WRENCH + "position = [0.0, 0.0, 0.0]\n", "sensors[1].position", "unknown key"),
        (ARM + WRENCH.replace('"elbow"', '"elbwo"'), "sensors[1].joint", "did you mean 'elbow'?"),
        (
            ARM + WRENCH.replace("force_torque", "joint_effort").replace("elbow", "shoulder"),
            "sensors[1].joint",
            "needs a revolute or prismatic joint",
        ),
        (BRICK + IMU + EXPECT + "sensors = {ium = 1e-6}\n", "expect[1].sensors.ium", "did you mean 'imu'?"),
        (BRICK + IMU + EXPECT + "sensors = {imu = -1.0}\n", "expect[1].sensors.imu", "0"),
        (BRICK + IMU + EXPECT + "sensors = {}\n", "expect[1].sensors", "1"),
        (BRICK + EXPECT + "sensors = {imu = 1e-6}\n", "expect[1].sensors.imu", "there is no sensor"),
        (BRICK + IMU + EXPECT + 'status = "unsupported"\nsensors = {imu = 1.0}\n', "expect[1].sensors", "no errors to limit"),
    ],
)
def test_faults_of_sensors_are_named(text: str, key: str, said: str) -> None:
    with pytest.raises(CaseFaults) as refused:
        parse(text, "case")
    fault = next(fault for fault in refused.value.faults if fault.key == key)
    assert said in fault.message


@pytest.mark.parametrize("name", ["\\u001b[31mred", "two\\nlines", "a\\u202eb"])
def test_a_name_that_acts_on_a_terminal_is_escaped_in_all_messages(name: str) -> None:
    """The name is in the list of those that an expectation may have, too."""
    text = BRICK + IMU.replace('"imu"', f'"{name}"') + EXPECT + "sensors = {imu = 1e-6}\n"
    with pytest.raises(CaseFaults) as refused:
        parse(text, "brick")
    assert [fault.key for fault in refused.value.faults] == ["sensors[1].name", "expect[1].sensors.imu"]
    assert all(line.isprintable() for line in str(refused.value).split("\n"))
    assert str(refused.value).count("\n") == 1


def test_more_sensors_than_allowed_are_refused() -> None:
    sensors = "".join(IMU.replace('"imu"', f'"imu {index}"') for index in range(101))
    with pytest.raises(CaseFaults, match="100"):
        parse(BRICK + sensors, "brick")


def test_limits_of_a_wrench_are_those_of_its_force_and_its_moment() -> None:
    case = parse(ARM + WRENCH + EXPECT + "sensor_error = 0.1\nsensors = {wrench = 1e-6}\n", "arm")
    assert case.expectations[0].limits == (
        Limit("sensor_error", None, 0.1),
        Limit("sensors.wrench.force", None, 1e-6, "N"),
        Limit("sensors.wrench.moment", None, 1e-6, "N m"),
    )
    assert case.expectations[0].limits[2].text == "at most 1e-06 N m"
