"""What the contract asks of an adapter whose engine reads robot models, tried on every one whose engine is installed here.

The model is a pole on a cart, with a tip welded to the pole, whose equations of motion are written down here.
"""

from dataclasses import replace
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.robot_reading import FormatUnknown, ModelRefused, ReadBody, RobotFile, RobotModels, RobotReading
from bodycheck.reference.robots.model import RobotJointType
from bodycheck.reference.robots.state import VELOCITIES, RobotState
from bodycheck.reference.trajectory import Array
from tests.support.asked import adapter_asked_for
from tests.support.robot_texts import GRAVITY, RIDES, hinges, on, ridden, written
from tests.support.robot_truths import assert_the_same

ONLY = adapter_asked_for()
INSTALLED = [ONLY] if ONLY else [name for name in registry.names() if registry.installed(name)]
NAMES = [name for name in INSTALLED if isinstance(registry.load(name), RobotModels)]

#: Engines whose readers ignore how the frame of an inertia is turned, which is for the study of robot models to tell.
UNTURNED = {"rapier"}

#: Engines whose adapters leave out the state of a joint that the engine takes for one of another type.
LEAVING_OUT = {"mujoco", "mujoco_warp", "pinocchio", "pybullet"}

#: The masses (kg) of cart, pole and tip.
CART, POLE, TIP = 2.0, 1.5, 0.25

URDF = f"""<?xml version="1.0"?>
<robot name="cart_pole">
  <link name="rail"/>
  <link name="cart">
    <inertial><origin xyz="0.1 0 0"/><mass value="{CART}"/>
      <inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial>
  </link>
  <link name="pole">
    <inertial><origin xyz="0.05 0.02 -0.4" rpy="0.3 -0.2 0.5"/><mass value="{POLE}"/>
      <inertia ixx="0.05" iyy="0.06" izz="0.02" ixy="0.004" ixz="0.003" iyz="-0.002"/></inertial>
  </link>
  <link name="tip">
    <inertial><origin xyz="0.01 0 0.02"/><mass value="{TIP}"/>
      <inertia ixx="0.001" iyy="0.002" izz="0.0015" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="3" effort="40" velocity="5"/><dynamics damping="0.5" friction="0.25"/>
  </joint>
  <joint name="hinge" type="revolute">
    <parent link="cart"/><child link="pole"/><origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="7" velocity="5"/><dynamics damping="0.1" friction="0.05"/>
  </joint>
  <joint name="weld" type="fixed">
    <parent link="pole"/><child link="tip"/><origin xyz="0 0 -0.8" rpy="0.4 0.1 -0.7"/>
  </joint>
</robot>
"""

JOINTS = ("slide", "hinge")
STATES = tuple(
    RobotState(*({name: (value,) for name, value in zip(JOINTS, values, strict=True)} for values in parts))
    for parts in (
        ((0.3, 0.7), (0.4, -1.3), (0.6, 1.1), (3.0, 0.5)),
        ((-0.5, -2.1), (-1.2, 0.8), (-0.9, 0.4), (-2.0, 0.3)),
    )
)


def turn(roll: float, pitch: float, yaw: float) -> Array:
    """The matrix of turns about the fixed axes x, y and z."""
    about_x = np.array([[1, 0, 0], [0, cos(roll), -sin(roll)], [0, sin(roll), cos(roll)]])
    about_y = np.array([[cos(pitch), 0, sin(pitch)], [0, 1, 0], [-sin(pitch), 0, cos(pitch)]])
    about_z = np.array([[cos(yaw), -sin(yaw), 0], [sin(yaw), cos(yaw), 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)


def tensor(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> Array:
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


#: The turns of the pole's inertia and of the tip, and mass, centre of mass and inertia of each link along its own axes.
INERTIA_TURN, TIP_TURN = turn(0.3, -0.2, 0.5), turn(0.4, 0.1, -0.7)
PARTS = {
    "cart": (CART, np.array([0.1, 0, 0]), tensor(0.02, 0.03, 0.04, 0.001, -0.002, 0.003)),
    "pole": (
        POLE,
        np.array([0.05, 0.02, -0.4]),
        INERTIA_TURN @ tensor(0.05, 0.06, 0.02, 0.004, 0.003, -0.002) @ INERTIA_TURN.T,
    ),
    "tip": (TIP, np.array([0.01, 0, 0.02]), np.diag([0.001, 0.002, 0.0015])),
}


def offset(mass: float, arm: Array) -> Array:
    """The inertia of a point at an arm."""
    return np.asarray(mass * (arm @ arm * np.eye(3) - np.outer(arm, arm)))


def pole_with_tip() -> tuple[float, Array, Array]:
    """Mass, centre of mass and inertia about it of the pole and its tip, in the pole's frame."""
    mass, center, inertia = PARTS["pole"]
    end = np.array([0, 0, -0.8]) + TIP_TURN @ PARTS["tip"][1]
    whole = (mass * center + TIP * end) / (mass + TIP)
    turned = TIP_TURN @ PARTS["tip"][2] @ TIP_TURN.T
    return mass + TIP, whole, inertia + offset(mass, center - whole) + turned + offset(TIP, end - whole)


def expected(body: ReadBody, names: set[str]) -> tuple[float, Array, Array]:
    """Mass, centre of mass and inertia of a body; the tip belongs to the pole where the engine has joined them."""
    return pole_with_tip() if body.name == "pole" and "tip" not in names else PARTS[body.name]


def motion(state: RobotState, gravity: tuple[float, float, float]) -> dict[str, Array]:
    """The terms of the equations of motion of the cart and the pole, by the field names of `Terms`."""
    mass, (a, _, c), inertia = pole_with_tip()
    angle, spin = state.positions["hinge"][0], state.velocities["hinge"][0]
    along, up = c * cos(angle) - a * sin(angle), -a * cos(angle) - c * sin(angle)
    matrix = np.array([[CART + mass, mass * along], [mass * along, inertia[1, 1] + mass * (a * a + c * c)]])
    weight = -np.array([(CART + mass) * gravity[0], mass * (gravity[0] * along + gravity[2] * up)])
    coriolis = np.array([mass * spin**2 * up, 0.0])
    acceleration = np.array([state.accelerations[name][0] for name in JOINTS])
    return {
        "mass_matrix": matrix,
        "gravity_force": weight,
        "coriolis_force": coriolis,
        "inverse_dynamics": matrix @ acceleration + coriolis + weight,
    }


@pytest.fixture
def file(tmp_path: Path) -> RobotFile:
    """The file of the pole on a cart."""
    path = tmp_path / "cart_pole.urdf"
    path.write_text(URDF, "utf-8")
    return RobotFile(str(path), "urdf")


def read(name: str, file: RobotFile, states: tuple[RobotState, ...] = STATES) -> RobotReading:
    """What an engine makes of a file; the test is skipped where it has no reader of the format."""
    adapter = registry.load(name)
    assert isinstance(adapter, RobotModels)
    try:
        return adapter.read_robot(file, states, GRAVITY)
    except FormatUnknown as unknown:
        pytest.skip(str(unknown))


def rounding(name: str) -> float:
    """The relative size of an error by some hundred roundings in the engine's precision."""
    return 500 * float(np.finfo(registry.load(name).engine.precision).eps)


def in_order(reading: RobotReading, *values: float) -> Array:
    """Values of the slide and the hinge, in the order of the engine's velocities."""
    found = np.zeros(reading.velocities)
    for joint in reading.joints:
        if joint.name in JOINTS:
            found[joint.first] = values[JOINTS.index(joint.name)]
    return found


@pytest.mark.parametrize("name", NAMES)
def test_joints_are_those_of_the_file(name: str, file: RobotFile) -> None:
    reading = read(name, file)
    moving = {joint.name: joint for joint in reading.joints if joint.count}
    assert {joint: (own.type, own.child, own.count) for joint, own in moving.items()} == {
        "slide": ("prismatic", "cart", 1),
        "hinge": ("revolute", "pole", 1),
    }
    assert sorted(joint.first for joint in moving.values()) == [0, 1]
    assert reading.velocities == 2
    stated = {"slide": (0.5, 0.25, 40.0, -2.0, 3.0), "hinge": (0.1, 0.05, 7.0, -3.0, 3.0)}
    for joint, own in moving.items():
        for value, told in zip(stated[joint], (own.damping, own.friction, own.effort_limit, own.lower, own.upper), strict=True):
            # An engine keeps a value as it is, or has none, or has a property that its reader leaves at 0.
            assert told is None or told == pytest.approx(value, rel=1e-6) or told == 0
        if own.axis is not None:
            np.testing.assert_allclose(own.axis, [[1, 0, 0], [0, 1, 0]][JOINTS.index(joint)], rtol=0, atol=rounding(name))


@pytest.mark.parametrize("name", NAMES)
def test_bodies_are_in_the_frames_of_their_links(name: str, file: RobotFile) -> None:
    reading = read(name, file)
    names = {body.name for body in reading.bodies}
    assert {"cart", "pole"} <= names <= {"cart", "pole", "tip", "rail", "world"}
    assert {"cart", "pole"} <= set(reading.links)
    parents = {body.name: body.parent for body in reading.bodies}
    assert parents["pole"] == "cart"
    assert parents["cart"] in (None, "rail", "world")
    for body in reading.bodies:
        if body.name not in PARTS:
            continue
        mass, center, inertia = expected(body, names)
        if body.mass is not None:
            assert body.mass == pytest.approx(mass, rel=rounding(name))
        if body.center_of_mass is not None:
            np.testing.assert_allclose(body.center_of_mass, center, rtol=0, atol=rounding(name))
        if body.inertia is not None:
            # An engine may keep an inertia about another point, whose square adds up to a hundred times the inertia.
            limit = max(rounding(name), reading.rounding)
            turned = INERTIA_TURN if body.name == "pole" and name in UNTURNED else np.eye(3)
            np.testing.assert_allclose(turned @ tensor(*body.inertia) @ turned.T, inertia, rtol=0, atol=limit)


@pytest.mark.parametrize("name", NAMES)
def test_terms_are_those_of_the_equations_of_motion(name: str, file: RobotFile) -> None:
    reading = read(name, file)
    assert len(reading.terms) == len(STATES)
    order = in_order(reading, 0, 1).astype(int)
    for state, terms in zip(STATES, reading.terms, strict=True):
        for term, value in motion(state, GRAVITY).items():
            if (own := getattr(terms, term)) is not None:
                assert own.dtype == np.float64
                true = value[order] if value.ndim == 1 else value[np.ix_(order, order)]
                np.testing.assert_allclose(own, true, rtol=0, atol=rounding(name) * 20, err_msg=term)


@pytest.mark.parametrize("name", NAMES)
def test_forces_that_an_engine_applies_are_those_by_which_it_moves(name: str, file: RobotFile) -> None:
    """Whether an engine applies damping and dry friction is its own matter."""
    reading = read(name, file)
    order = in_order(reading, 0, 1).astype(int)
    for state, terms in zip(STATES, reading.terms, strict=True):
        velocity = np.array([state.velocities[joint][0] for joint in JOINTS])
        damping, friction = -np.array([0.5, 0.1]) * velocity, -np.array([0.25, 0.05]) * np.sign(velocity)
        possible = [np.zeros(2), damping, friction, damping + friction]
        if terms.passive_force is not None:
            given = terms.passive_force
            assert any(np.allclose(given, force[order], rtol=0, atol=rounding(name)) for force in possible), given
        if terms.forward_dynamics is None:
            continue
        true = motion(state, GRAVITY)
        effort = np.array([state.efforts[joint][0] for joint in JOINTS])
        free = [
            np.linalg.solve(true["mass_matrix"], effort + force - true["coriolis_force"] - true["gravity_force"])
            for force in possible
        ]
        # Accelerations are some tens, and the condition of the mass matrix is ten.
        given = terms.forward_dynamics
        assert any(np.allclose(given, moved[order], rtol=0, atol=100 * rounding(name)) for moved in free), (given, free)


@pytest.mark.parametrize("name", NAMES)
def test_poses_and_jacobians_are_those_of_the_links(name: str, file: RobotFile) -> None:
    reading = read(name, file)
    order = in_order(reading, 0, 1).astype(int)
    for state, terms in zip(STATES, reading.terms, strict=True):
        x, angle = (state.positions[joint][0] for joint in JOINTS)
        spin = turn(0, angle, 0)
        places = {
            "cart": np.array([x, 0, 0]),
            "pole": np.array([x, 0, 0.1]),
            "tip": np.array([x, 0, 0.1]) + spin @ [0, 0, -0.8],
        }
        turns = {"cart": np.eye(3), "pole": spin, "tip": spin @ TIP_TURN}
        for link, pose in terms.poses.items():
            if link not in places:
                continue
            np.testing.assert_allclose(pose[:3], places[link], rtol=0, atol=rounding(name))
            w, x_, y, z = pose[3:]
            across = np.array([[0, -z, y], [z, 0, -x_], [-y, x_, 0]])
            np.testing.assert_allclose(np.eye(3) + 2 * (w * across + across @ across), turns[link], rtol=0, atol=rounding(name))
        arms = {"pole": np.zeros(3), "tip": places["tip"] - places["pole"]}
        for link, jacobian in terms.jacobians.items():
            if link in arms:
                turning = np.concatenate([np.cross([0, 1, 0], arms[link]), [0, 1, 0]])
                columns = np.stack([[1, 0, 0, 0, 0, 0], turning], axis=1)[:, order]
                near = [columns, np.vstack([turns[link].T @ columns[:3], turns[link].T @ columns[3:]])]
                assert any(np.allclose(jacobian, one, rtol=0, atol=rounding(name)) for one in near), jacobian


@pytest.mark.parametrize("name", NAMES)
def test_a_joint_that_is_not_there_is_left_out_and_one_without_a_state_stays(name: str, file: RobotFile) -> None:
    first = STATES[0]
    alone = RobotState(
        *(
            {"hinge": values["hinge"], "ghost": (9.0,)}
            for values in (first.positions, first.velocities, first.accelerations, first.efforts)
        )
    )
    still = replace(
        first,
        **{part: {**getattr(first, part), "slide": (0.0,)} for part in ("positions", "velocities", "accelerations", "efforts")},
    )
    reading = read(name, file, (alone, still))
    for part in ("mass_matrix", "gravity_force", "coriolis_force", "inverse_dynamics"):
        np.testing.assert_array_equal(getattr(reading.terms[0], part), getattr(reading.terms[1], part))


@pytest.mark.parametrize("name", [name for name in NAMES if name in LEAVING_OUT])
def test_a_state_of_a_joint_of_another_type_is_left_out(name: str, tmp_path: Path) -> None:
    """As where the engine takes a joint for another one."""
    single = hinges("ghost", "spin")
    other = RobotState(
        *({**getattr(single, part), "ride": (0.3,)} for part in ("positions", "velocities", "accelerations", "efforts"))
    )
    given, still = read(name, written(on("floating"), tmp_path), (other, single)).terms
    np.testing.assert_array_equal(given.poses["arm"], still.poses["arm"])
    np.testing.assert_array_equal(given.inverse_dynamics, still.inverse_dynamics)


@pytest.mark.parametrize("name", NAMES)
def test_reading_twice_is_reading_once(name: str, file: RobotFile, capfd: pytest.CaptureFixture[str]) -> None:
    """And nothing is printed."""
    capfd.readouterr()
    once, again = read(name, file), read(name, file)
    assert capfd.readouterr() == ("", "")
    assert (once.bodies, once.joints, once.links, once.notes) == (again.bodies, again.joints, again.links, again.notes)
    for one, other in zip(once.terms, again.terms, strict=True):
        np.testing.assert_array_equal(one.mass_matrix, other.mass_matrix)
        np.testing.assert_array_equal(one.inverse_dynamics, other.inverse_dynamics)


@pytest.mark.parametrize("name", NAMES)
def test_a_model_without_a_parent_link_is_refused(name: str, file: RobotFile, capfd: pytest.CaptureFixture[str]) -> None:
    Path(file.path).write_text(URDF.replace('<parent link="cart"/>', '<parent link="nobody"/>'), "utf-8")
    with pytest.raises(ModelRefused) as refused:
        read(name, file)
    assert str(refused.value).strip()
    assert "\n" not in str(refused.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("type", sorted(RIDES))
@pytest.mark.parametrize("name", NAMES)
def test_joints_of_several_velocities_have_the_motion_that_was_asked_for(
    name: str, type: RobotJointType, tmp_path: Path
) -> None:
    """In the velocities of the engine. One without such joints may refuse them or leave them out."""
    axis = "0 0 1" if type == "planar" else ""
    try:
        reading = read(name, written(on(type, axis), tmp_path), (RIDES[type],))
    except ModelRefused as refused:
        pytest.skip(f"{name} refuses {type} joints: {refused}")
    kinds = {joint.name: (joint.type, joint.count) for joint in reading.joints}
    if kinds.get("ride") != (type, VELOCITIES[type]):
        pytest.skip(f"{name} has {kinds} of a {type} joint")
    if not reading.terms[0].jacobians:
        pytest.skip(f"{name} has no Jacobians, by which its velocities are told")
    assert_the_same(reading.terms[0], ridden(type, axis), RIDES[type], GRAVITY, rounding(name))
