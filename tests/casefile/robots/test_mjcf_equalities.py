"""Equalities, welds and keyframes of MJCF mean for a case what they mean for MuJoCo."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.robots.reading import Read
from bodycheck.errors import BadInput
from bodycheck.reference.robots.dynamics import terms_at
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.from_mechanism import robot_model

mujoco: Any = pytest.importorskip("mujoco")

from tests.support.mjcf_readers import mechanism, read_text  # noqa: E402  (needs MuJoCo)

#: For positions of the size of 1 m, of the rounding of a few products of matrices in double precision.
ROUNDING = 1e-14

CHAIN = """
<mujoco>
  <worldbody>
    <site name="hook" pos="0.3 0.1 2" euler="10 20 30"/>
    <body name="a" pos="0 0 1">
      <joint name="one" axis="0 1 0" pos="0.1 0 0" ref="10"/><geom type="box" size="0.1 0.2 0.3"/>
      <body name="b" pos="0.5 0 0" euler="0 0 30">
        <joint name="two" type="slide" axis="1 0 0" ref="0.2"/><joint name="three" axis="1 1 0" pos="0 0.2 0"/>
        <geom type="box" size="0.1 0.2 0.3"/><site name="tip" pos="0.1 0.2 0.3"/>
      </body>
    </body>
    <body name="ball" pos="1 2 3" euler="20 30 40"><freejoint name="float"/><geom size="0.1"/>
      <site name="top" pos="0 0 0.1"/></body>
  </worldbody>
  <equality>EQUALITY</equality>
</mujoco>
"""


TENDONS = """
<tendon>
  <fixed name="pair"><joint joint="one" coef="2"/><joint joint="three" coef="3"/></fixed>
  <fixed name="alone"><joint joint="one" coef="1"/></fixed><fixed name="other"><joint joint="two" coef="3"/></fixed>
  <fixed name="all"><joint joint="one" coef="1"/><joint joint="two" coef="1"/><joint joint="three" coef="1"/></fixed>
  <spatial name="rope"><site site="top"/><site site="tip"/></spatial>
</tendon>
"""


def chain(equality: str) -> str:
    return CHAIN.replace("EQUALITY", equality)


def residual(text: str, coordinates: dict[str, Any]) -> Any:
    """Return by how much the equalities of a file are not met in MuJoCo at some coordinates; others are those of the file."""
    compiled = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(compiled)
    for name, values in coordinates.items():
        data.joint(name).qpos[:] = values
    mujoco.mj_fwdPosition(compiled, data)
    return np.array(data.efc_pos)[np.array(data.efc_type) == 0]


def table(read: Read, name: str) -> dict[str, Any]:
    return next(joint for joint in read.tables["joints"] if joint["name"] == name)


@pytest.mark.parametrize(
    ("attributes", "rule"),
    [
        ('joint1="one" joint2="two"', (1.0,)),
        ('joint1="one" joint2="two" polycoef="0.3 2 0 0 0"', (2.0,)),
        ('joint1="two" joint2="three" polycoef="0.3 -0.5"', (-0.5,)),
        ('joint1="three" joint2="one" polycoef="0.3"', (1.0,)),
        ('tendon1="pair" polycoef="0.4 0"', (-1.5,)),
        ('tendon1="alone" tendon2="other" polycoef="0.4 0.7"', (2.1,)),
    ],
)
def test_a_joint_follows_another_one(attributes: str, rule: tuple[float]) -> None:
    text = chain(f"<{attributes[: attributes.index('1')]} {attributes}/>").replace("</mujoco>", TENDONS + "</mujoco>")
    read = read_text(text)
    follower = next(joint for joint in read.tables["joints"] if "mimic" in joint)
    mimic = follower["mimic"]
    assert (mimic["multiplier"],) == pytest.approx(rule, rel=1e-15)
    assert "initial" not in follower
    there = {mimic["joint"]: 0.7, follower["name"]: mimic["multiplier"] * 0.7 + mimic["offset"]}
    assert np.abs(residual(text, there)).max() < ROUNDING


@pytest.mark.parametrize("attributes", ['joint1="one" polycoef="0.3 0 0 0 0"', 'joint1="two" joint2="three" polycoef="0.3 0"'])
def test_a_joint_with_a_constant_coordinate_is_fixed(attributes: str) -> None:
    """Also with a constant coordinate, its bodies are where MuJoCo has them."""
    text = chain(f"<joint {attributes}/>")
    read, name = read_text(text), attributes[8:11]
    assert table(read, name)["type"] == "fixed"
    coordinate = {"one": np.radians(10), "two": 0.2}[name] + 0.3
    assert np.abs(residual(text, {name: coordinate})).max() < ROUNDING
    others = {"one": 0.4, "two": 0.5, "three": 0.6} | {name: coordinate}
    assert_placed_alike(read, text, others)


def assert_placed_alike(read: Read, text: str, coordinates: dict[str, float]) -> None:
    """Assert that the centres of mass of bodies are where MuJoCo has them at coordinates of hinges and slides."""
    compiled = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(compiled)
    for name, value in coordinates.items():
        data.joint(name).qpos[:] = value
    mujoco.mj_fwdPosition(compiled, data)
    for name, place in places(read, coordinates).items():
        if name in ("a", "b"):
            there = next(body for body in read.tables["bodies"] if body["name"] == name)["center_of_mass"]
            np.testing.assert_allclose(place(there), data.body(name).xipos, atol=ROUNDING)


def places(read: Read, coordinates: dict[str, float]) -> dict[str, Any]:
    """Return functions from points of bodies to the world, at coordinates of hinges and slides."""
    model = robot_model(mechanism(replace(read, tables=read.tables | {"loops": []})), "robot")
    names = [joint["name"] for joint in read.tables["joints"]]
    state = seeded_states(model, 1, 0)[0]
    positions = dict(state.positions)
    for index, name in enumerate(names):
        if name in coordinates and f"j{index}" in positions:
            positions[f"j{index}"] = (coordinates[name],)
        elif read.tables["joints"][index]["type"] == "free":
            initial = read.tables["joints"][index]["initial"]
            positions[f"j{index}"] = (*initial["position"], *initial["quaternion"])
    poses = terms_at(model, [RobotState(positions, state.velocities, state.accelerations, state.efforts)], (0, 0, 0))[0].poses
    bodies = {"world": "world"} | {body["name"]: f"b{index}" for index, body in enumerate(read.tables["bodies"])}

    def place(name: str) -> Any:
        pose, turn = np.array(poses[bodies[name]], float), np.empty(9)
        mujoco.mju_quat2Mat(turn, pose[3:])
        return lambda point: pose[:3] + turn.reshape(3, 3) @ np.array(point)

    return {name: place(name) for name in bodies}


@pytest.mark.parametrize(
    "attributes",
    [
        'body1="b" body2="a" anchor="0.1 0.2 0.3"',
        'body1="b" anchor="0.1 0.2 0.3"',
        'site1="tip" site2="hook"',
        'site1="top" site2="tip"',
    ],
)
def test_a_loop_is_closed_where_mujoco_closes_it(attributes: str) -> None:
    text, there = chain(f"<connect {attributes}/>"), {"one": 0.4, "two": 0.5, "three": 0.6}
    read = read_text(text)
    (loop,) = read.tables["loops"]
    placed = places(read, there)
    ends = [placed[body](point) for body, point in zip(loop["bodies"], loop["points"], strict=True)]
    np.testing.assert_allclose(ends[0] - ends[1], residual(text, there), atol=10 * ROUNDING)


@pytest.mark.parametrize(
    "attributes",
    [
        *('body1="ball" body2="b"', 'body1="a" body2="ball"', 'body1="ball"', 'site1="top" site2="tip"'),
        'body1="b" body2="ball" relpose="0.1 0.2 0.3 1 2 3 4"',
    ],
)
def test_a_weld_fixes_a_body_that_floats(attributes: str) -> None:
    text, there = chain(f"<weld {attributes}/>"), {"one": 0.4, "two": 0.5, "three": 0.6}
    read = read_text(text)
    joint = table(read, "float")
    assert joint["type"] == "fixed"
    assert not any(feature.acts for feature in read.features)
    at, turn, whole = places(read, there), np.empty(9), np.empty(4)
    mujoco.mju_quat2Mat(turn, np.array(joint.get("quaternion", [1.0, 0, 0, 0])))
    corner = at["ball"]((0, 0, 0))
    axes = np.stack([at["ball"](axis) - corner for axis in np.eye(3)], axis=1)
    mujoco.mju_mat2Quat(whole, axes.reshape(9))
    assert np.abs(residual(text, there | {"float": [*corner, *whole]})).max() < 10 * ROUNDING


@pytest.mark.parametrize(
    "equality",
    [
        '<joint joint1="one" joint2="two" polycoef="0 1 1 0 0"/>',
        '<weld body1="a" body2="b"/>',
        '<joint joint1="one" joint2="two"/><joint joint1="two" joint2="one"/>',
    ],
)
def test_what_a_case_cannot_say_of_equalities_acts(equality: str) -> None:
    acting = [feature for feature in read_text(chain(equality)).features if feature.acts]
    assert [(feature.word, len(feature.lines)) for feature in acting] == [("equalities", 1)]


@pytest.mark.parametrize("tendon", ["all", "rope"])
def test_other_equalities_of_tendons_act(tendon: str) -> None:
    text = chain(f'<tendon tendon1="{tendon}"/>').replace("</mujoco>", TENDONS + "</mujoco>")
    assert {feature.word for feature in read_text(text).features if feature.acts} == {"equalities"}


def test_a_joint_that_others_follow_follows_one_itself() -> None:
    """The second equality has its two joints the other way round, as the first of them follows another one already."""
    text = chain('<joint joint1="one" joint2="two"/><joint joint1="one" joint2="three" polycoef="0 2"/>')
    read = read_text(text)
    assert table(read, "three")["mimic"]["joint"] == "one"
    rules = {name: table(read, name)["mimic"] for name in ("one", "three")}
    one = rules["one"]["multiplier"] * 0.7 + rules["one"]["offset"]
    there = {"two": 0.7, "one": one, "three": rules["three"]["multiplier"] * one + rules["three"]["offset"]}
    assert np.abs(residual(text, there)).max() < ROUNDING


def test_equalities_that_do_not_act() -> None:
    for text in (
        chain('<weld body1="a" body2="b" active="false"/>'),
        chain('<weld body1="a" body2="b"/>').replace("<mujoco>", '<mujoco><option><flag equality="disable"/></option>'),
        chain('<weld body1="a" body2="b"/>').replace("<mujoco>", '<mujoco><default><equality active="false"/></default>'),
    ):
        assert not any(feature.word == "equalities" for feature in read_text(text).features)


def test_equalities_that_a_case_ignores() -> None:
    text = chain('<joint joint1="one" joint2="two"/><connect site1="tip" site2="hook"/>')
    for ignored, loops, rules in (("equalities", 0, 0), ("mimic", 1, 0)):
        read = read_text(text, ignore=frozenset({ignored}))
        assert len(read.tables.get("loops", [])) == loops
        assert sum("mimic" in joint for joint in read.tables["joints"]) == rules
        assert {feature.word for feature in read.features if feature.acts} == {ignored}


KEYS = '<keyframe><key qpos="0.1 0.2 0.3 1 2 3 0.5 0.5 0.5 0.5"/><key name="home" qvel="1 2 3 4 5 6 7 8 9"/></keyframe>'


def test_a_keyframe_is_where_a_motion_begins() -> None:
    text = chain("").replace("</mujoco>", KEYS + "</mujoco>")
    first, home = (read_text(text, keyframe=which) for which in (0, "home"))
    assert first.keyframes == ("", "home")
    assert table(first, "three")["initial"] == {"position": 0.3}
    assert table(first, "float")["initial"] == {"position": [1, 2, 3], "quaternion": [0.5, 0.5, 0.5, 0.5]}
    assert table(home, "two")["initial"] == {"position": 0.2, "velocity": 2.0}
    float_start = table(home, "float")["initial"]
    assert (float_start["linear"], float_start["velocity"], float_start["position"]) == ([4, 5, 6], [7, 8, 9], [1, 2, 3])
    for wrong, words in (("hom", "has no keyframe 'hom'; allowed: 0, 'home'; did you mean 'home'?"), (2, "has no keyframe 2")):
        with pytest.raises(BadInput, match=words):
            read_text(text, keyframe=wrong)
    with pytest.raises(BadInput, match="<key qpos>: read 3 numbers; allowed: 10"):
        read_text(text.replace("0.1 0.2 0.3 1 2 3 0.5 0.5 0.5 0.5", "1 2 3"), keyframe=0)


def test_the_velocities_of_a_free_joint_are_those_of_mujoco() -> None:
    """In MuJoCo, they are those of the frame's origin along the axes of the world, and of the body's axes: so in a case."""
    compiled = mujoco.MjModel.from_xml_string(chain(""))
    data, step = mujoco.MjData(compiled), 1e-7
    before = data.joint("float").qpos.copy()
    data.joint("float").qvel[:] = 1, 2, 3, 4, 5, 6
    mujoco.mj_integratePos(compiled, data.qpos, data.qvel, step)
    after = data.joint("float").qpos
    # Differences over a short time are rounded to 1e-8.
    np.testing.assert_allclose((after[:3] - before[:3]) / step, [1, 2, 3], atol=1e-6)
    back, turned = np.empty(4), np.empty(4)
    mujoco.mju_negQuat(back, before[3:])
    mujoco.mju_mulQuat(turned, back, after[3:])
    np.testing.assert_allclose(2 * turned[1:] / step, [4, 5, 6], atol=1e-5)
