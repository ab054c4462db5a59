"""What the contract asks of an adapter whose engine runs whole scenes from files, tried on every one that is installed here.

The robot is an arm that swings about a horizontal hinge and a block that falls along a vertical slide, whose motions are known
in closed form.
"""

from math import asin, sin
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.file_motion import FileMotion, FileMotions, FileRun, MotionRefused
from bodycheck.adapters.robot_reading import FormatUnknown, ModelRefused, RobotFile
from bodycheck.reference.trajectory import Array
from tests.support.asked import adapter_asked_for
from tests.support.robot_texts import written

ONLY = adapter_asked_for()
INSTALLED = [ONLY] if ONLY else [name for name in registry.names() if registry.installed(name)]
NAMES = [name for name in INSTALLED if isinstance(registry.load(name), FileMotions)]

#: The distance (m) of the arm's centre of mass from the hinge, and its moment of inertia about the hinge per mass (m^2).
REACH, MOMENT = 0.3, 0.3**2 + 0.02

GRAVITY = 9.81

#: The arm starts level, at rest: its largest angle from hanging (rad) is the right angle.
AMPLITUDE = np.pi / 2

URDF = f"""<robot name="arm_and_block">
  <link name="stand"/>
  <link name="arm"><inertial><origin xyz="{REACH} 0 0"/><mass value="1.5"/>
    <inertia ixx="0.03" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="block"><inertial><mass value="0.5"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="swing" type="continuous"><parent link="stand"/><child link="arm"/><axis xyz="0 1 0"/></joint>
  <joint name="fall" type="prismatic"><parent link="stand"/><child link="block"/><origin xyz="0 2 0"/><axis xyz="0 0 1"/>
    <limit lower="-20" upper="20" effort="100" velocity="100"/></joint>
</robot>"""

#: A ball that falls on a floor.
BALL = """<mujoco model="ball"><worldbody>
  <geom name="floor" type="plane" size="5 5 0.1"/>
  <body name="ball" pos="0 0 0.3"><freejoint name="loose"/><geom name="skin" type="sphere" size="0.1"/></body>
</worldbody></mujoco>"""

TIMES = np.arange(1, 11) * 0.04


def exact_angle(t: Array) -> Array:
    """The angle (rad) of an arm that is let go level: sin(θ/2) = k sn(K + ω t), with θ from hanging, k = sin(amplitude/2)."""
    parameter = sin(AMPLITUDE / 2) ** 2
    frequency = np.sqrt(GRAVITY * REACH / MOMENT)
    sine, *_ = ellipj(ellipk(parameter) + frequency * t, parameter)
    return np.asarray(AMPLITUDE - 2 * np.arcsin(sin(AMPLITUDE / 2) * sine))


def test_the_exact_angle_keeps_the_energy() -> None:
    t = np.linspace(0, 0.4, 4001)
    rate = np.gradient(exact_angle(t), t, edge_order=2)
    assert asin(1.0) == AMPLITUDE
    assert np.allclose(MOMENT * rate**2 / 2, GRAVITY * REACH * np.sin(exact_angle(t)), atol=1e-4)


def run(name: str, file: RobotFile, timestep: float, nudged: bool = False, times: Array = TIMES) -> FileMotion:
    """A run with the first method of an engine; the test is skipped where the engine has no reader of the format."""
    adapter = registry.load(name)
    assert isinstance(adapter, FileMotions)
    try:
        method = adapter.file_facts(file).method
        return adapter.run_file(file, FileRun(Method(method.integrator, timestep, method.options), times, nudged=nudged))
    except FormatUnknown as unknown:
        pytest.skip(str(unknown))


def error(motion: FileMotion) -> float:
    """The largest error of angle (rad) and height (m)."""
    angle, height = motion.angles[motion.names.angles.index("swing")], motion.slides[motion.names.slides.index("fall"), :, 0]
    assert np.allclose(motion.t, TIMES)
    return float(max(np.abs(angle - exact_angle(TIMES)).max(), np.abs(height + GRAVITY * TIMES**2 / 2).max()))


@pytest.mark.parametrize("name", NAMES)
def test_the_motion_of_a_file_tends_to_the_exact_one(name: str, tmp_path: Path) -> None:
    """The first methods are of first order: their error is about the time step, and halves with it, within a tenth."""
    coarse, fine = (error(run(name, written(URDF, tmp_path), step)) for step in (0.002, 0.001))
    assert fine < 0.005
    assert coarse / fine == pytest.approx(2, abs=0.2)


@pytest.mark.parametrize("name", NAMES)
def test_bodies_and_joints_have_the_names_of_the_file(name: str, tmp_path: Path) -> None:
    motion = run(name, written(URDF, tmp_path), 0.002)
    assert {"arm", "block"} <= set(motion.names.bodies)
    arm = motion.names.bodies.index("arm")
    # The centre of mass is at its reach from the hinge, and the attitude turns by the angle of the joint. Poses are in single
    # precision in some engines.
    assert np.allclose(np.linalg.norm(motion.position[arm], axis=-1), REACH, atol=1e-5)
    turned = 2 * np.arccos(np.clip(np.abs(motion.quaternion[arm, :, 0]), 0, 1))
    assert np.allclose(turned, motion.angles[motion.names.angles.index("swing")], atol=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_one_rounding_at_the_start_is_not_lost(name: str, tmp_path: Path) -> None:
    """The change has the size of the engine's precision, and grows little in 0.4 s."""
    file = written(URDF, tmp_path)
    here, there = run(name, file, 0.002), run(name, file, 0.002, nudged=True)
    apart = float(np.abs(here.angles - there.angles).max())
    assert 0 < apart < 1e3 * float(np.finfo(registry.load(name).engine.precision).eps)


@pytest.mark.parametrize("name", [name for name in NAMES if name != "dart"])  # DART welds a body with a free joint
def test_a_ball_comes_to_rest_on_a_floor_and_touches_it(name: str, tmp_path: Path) -> None:
    motion = run(name, written(BALL, tmp_path, "mjcf"), 0.001, times=np.array([0.05, 2.0]))
    ball = motion.names.bodies.index("ball")
    assert abs(motion.position[ball, -1, 2] - 0.1) < 0.01  # engines let it sink by a part of a millimetre to some millimetres
    assert not motion.regimes[0]
    assert name == "newton" or any("ball" in one for one in motion.regimes[-1])  # Newton's MuJoCo finds contacts itself


@pytest.mark.parametrize("name", [name for name in NAMES if not name.startswith("mujoco")])
def test_a_keyframe_that_an_engine_does_not_read_is_refused(name: str, tmp_path: Path) -> None:
    adapter = registry.load(name)
    assert isinstance(adapter, FileMotions)
    file = written(URDF, tmp_path)
    method = adapter.file_facts(file).method
    with pytest.raises(MotionRefused, match="keyframe 'raised'"):
        adapter.run_file(file, FileRun(method, TIMES, keyframe="raised"))


@pytest.mark.parametrize("name", NAMES)
def test_a_file_that_an_engine_cannot_read_is_refused(name: str, tmp_path: Path) -> None:
    adapter = registry.load(name)
    assert isinstance(adapter, FileMotions)
    broken = written(URDF.replace("</robot>", ""), tmp_path)
    with pytest.raises((ModelRefused, FormatUnknown)):
        adapter.file_facts(broken)
