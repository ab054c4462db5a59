"""A URDF means what its specification says, and what the specification refuses is told with its place."""

import itertools
import math
from typing import get_args

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bodycheck.errors import BadInput
from bodycheck.reference.robots.model import Mimic, RobotJoint, RobotModel, Wide
from bodycheck.robots import elements, urdf
from bodycheck.robots.faults import MAX_FAULTS, FaultyQuantity, FileReading
from tests.support.robot_texts import rotation

BOX = '<mass value="2"/><inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0.02" iyz="0.03"/>'

#: Every type of joint, and defaults as well as values for everything that has them.
ROBOT = f"""\
<?xml version="1.0"?>
<robot name="robot" xmlns:xacro="http://ros.org/wiki/xacro">
  <link name="base"><inertial><origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/>{BOX}</inertial></link>
  <link name="arm"><visual/><inertial>{BOX}</inertial></link>
  <link name="frame"/>
  <link name="slider"><inertial><origin xyz="1 2 3"/>{BOX}</inertial></link>
  <link name="wheel"><inertial><origin rpy="1 0 0"/>{BOX}</inertial></link>
  <link name="ship"><inertial>{BOX}</inertial></link>
  <link name="puck"><inertial>{BOX}</inertial></link>
  <joint name="shoulder" type="revolute">
    <origin xyz="1 -2 3" rpy="0.1 0.2 0.3"/><parent link="base"/><child link="arm"/><axis xyz="0 3 4"/>
    <limit lower="-1" upper="2" effort="3" velocity="4"/><dynamics damping="0.5" friction="0.25"/>
    <safety_controller k_velocity="1"/><calibration rising="1"/>
  </joint>
  <joint name="weld" type="fixed"><parent link="arm"/><child link="frame"/></joint>
  <joint name="drawer" type="prismatic"><parent link="arm"/><child link="slider"/><limit effort="5" velocity="inf"/></joint>
  <joint name="axle" type="continuous">
    <parent link="slider"/><child link="wheel"/><limit lower="-1" upper="1" effort="7" velocity="8"/><dynamics/>
    <mimic joint="shoulder" multiplier="-2" offset="0.5"/>
  </joint>
  <joint name="keel" type="floating"><parent link="frame"/><child link="ship"/><axis xyz="0 0 0"/></joint>
  <joint name="table" type="planar"><parent link="ship"/><child link="puck"/><axis xyz="0 0 -2"/></joint>
  <transmission name="t"><joint name="shoulder"/></transmission><gazebo reference="arm"><mu1>1</mu1></gazebo>
  <mujoco><compiler meshdir="/etc"/></mujoco><material name="m"/>
</robot>
"""


def read(text: str) -> FileReading:
    return urdf.read(text.encode(), "robot.urdf")


def model(text: str) -> RobotModel:
    made = read(text)
    assert made.faults == ()
    assert made.model is not None
    return made.model


def joints(text: str = ROBOT) -> dict[str, RobotJoint]:
    return {joint.name: joint for joint in model(text).joints}


#: Roundings of a few products of matrices with elements of order one, in the widest type.
ROUNDING = 16 * float(np.finfo(np.longdouble).eps)


def assert_near(found: Wide, expected: Wide) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING * max(1.0, float(np.abs(expected).max())))


def test_the_tree() -> None:
    made = model(ROBOT)
    assert made.name == "robot"
    names = [link.name for link in made.links]
    assert names == ["base", "arm", "frame", "slider", "wheel", "ship", "puck"]
    assert [(joint.name, names[joint.parent], names[joint.child], joint.type) for joint in made.joints] == [
        ("shoulder", "base", "arm", "revolute"),
        ("weld", "arm", "frame", "fixed"),
        ("drawer", "arm", "slider", "prismatic"),
        ("axle", "slider", "wheel", "revolute"),
        ("keel", "frame", "ship", "floating"),
        ("table", "ship", "puck", "planar"),
    ]
    assert made.root == 0


def test_masses_and_inertias_in_the_frames_of_the_links() -> None:
    links = {link.name: link for link in model(ROBOT).links}
    own = np.array([[0.1, 0.01, 0.02], [0.01, 0.2, 0.03], [0.02, 0.03, 0.25]], np.longdouble)
    assert links["base"].mass == 2.0
    assert links["base"].center_of_mass.tolist() == [0.1, 0.2, 0.3]
    assert links["slider"].center_of_mass.tolist() == [1.0, 2.0, 3.0]
    for name, angles in {"base": (0.4, -0.5, 0.6), "arm": (0.0, 0.0, 0.0), "wheel": (1.0, 0.0, 0.0)}.items():
        assert_near(links[name].inertia, rotation(*angles) @ own @ rotation(*angles).T)
        assert links[name].inertia.dtype == np.longdouble
    assert (links["arm"].inertia == own).all()
    assert links["frame"].mass == 0.0, "without <inertial>"
    assert not links["frame"].inertia.any()


def test_joints_and_their_defaults() -> None:
    made = joints()
    shoulder, drawer, axle = made["shoulder"], made["drawer"], made["axle"]
    assert shoulder.position.tolist() == [1.0, -2.0, 3.0]
    assert_near(shoulder.rotation, rotation(0.1, 0.2, 0.3))
    assert_near(shoulder.axis, np.array([0, 3, 4], np.longdouble) / 5)
    assert (shoulder.damping, shoulder.friction) == (0.5, 0.25)
    assert (shoulder.lower, shoulder.upper, shoulder.effort_limit, shoulder.velocity_limit) == (-1.0, 2.0, 3.0, 4.0)
    assert (drawer.position == 0).all()
    assert (drawer.rotation == np.eye(3)).all()
    assert drawer.axis.tolist() == [1.0, 0.0, 0.0]
    assert (drawer.damping, drawer.friction) == (0.0, 0.0)
    assert (drawer.lower, drawer.upper, drawer.effort_limit, drawer.velocity_limit) == (0.0, 0.0, 5.0, None)
    assert (axle.lower, axle.upper, axle.effort_limit) == (None, None, 7.0), "a continuous joint has no limits"
    assert axle.mimic == Mimic("shoulder", -2.0, 0.5)
    assert made["table"].axis.tolist() == [0.0, 0.0, -1.0]
    assert not made["keel"].axis.any()
    assert {joint.armature for joint in made.values()} == {0.0}


def test_a_fixed_joint_follows_nothing() -> None:
    weld = '<joint name="weld" type="fixed"><mimic joint="shoulder"/>'
    assert joints(ROBOT.replace('<joint name="weld" type="fixed">', weld))["weld"].mimic is None


def test_a_mimic_has_defaults_and_may_follow_a_joint_that_follows() -> None:
    second = '<axis xyz="1 0 0"/><limit effort="5" velocity="5"/><mimic joint="axle"/>'
    made = joints(ROBOT.replace('<limit effort="5" velocity="inf"/>', second))
    assert made["drawer"].mimic == Mimic("axle", 1.0, 0.0)


@given(st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3))
def test_any_angles_are_turns_about_fixed_axes(angles: list[float]) -> None:
    words = " ".join(map(repr, angles))
    made = joints(ROBOT.replace('rpy="0.1 0.2 0.3"', f'rpy="{words}"'))["shoulder"]
    assert_near(made.rotation, rotation(*angles))


def test_a_quaternion_counts_from_version_1_1_on() -> None:
    """Half angles of 30 and 0 degrees, of a quaternion whose length is 2."""
    text = ROBOT.replace('rpy="0.1 0.2 0.3"', f'quat_xyzw="0 0 1 {math.sqrt(3)!r}"')
    assert (joints(text)["shoulder"].rotation == np.eye(3)).all(), "version 1.0 does not have it"
    newer = text.replace('name="robot"', 'name="robot" version="1.1"')
    # sqrt(3) is rounded to a double.
    np.testing.assert_allclose(
        joints(newer)["shoulder"].rotation.astype(float), rotation(0.0, 0.0, math.pi / 3).astype(float), atol=1e-15
    )
    both = read(newer.replace("quat_xyzw=", 'rpy="0 0 0" quat_xyzw='))
    assert [fault.quantity for fault in both.faults] == ["pose"]


def test_numbers_are_separated_by_any_space_of_xml() -> None:
    text = ROBOT.replace('xyz="1 -2 3"', 'xyz="\n 1.\t-2e0\r\n   +.3e1 "')
    assert joints(text)["shoulder"].position.tolist() == [1.0, -2.0, 3.0]


def changed(old: str, new: str) -> str:
    assert old in ROBOT
    return ROBOT.replace(old, new, 1)


#: A change of the file, and subject, quantity and words of the fault; what is left has a meaning.
TOLERATED = {
    "no name": (changed('name="robot"', ""), "model", "", ":2: <robot name>: is missing"),
    "version": (changed('name="robot"', 'name="r" version="3"'), "model", "", "<robot version>: read '3'; allowed: 1.0, 1.1"),
    "macro": (changed("<link", "<xacro:if/><link"), "model", "", ":3: <xacro:if>: is a macro of xacro, which is not expanded"),
    "two inertials": (changed("<visual/>", f"<inertial>{BOX}</inertial>"), "arm", "mass", "a second <inertial> of one <link>"),
    "no mass": (changed('<mass value="2"/>', ""), "base", "mass", "<inertial>: has no <mass>, which URDF requires"),
    "no inertia": (changed(BOX, '<mass value="1"/>'), "base", "inertia", "<inertial>: has no <inertia>, which URDF requires"),
    "no row": (changed(' ixy="0.01"', ""), "base", "inertia", ":3: <inertia ixy>: is missing; allowed: one number"),
    "nan": (changed('value="2"', 'value="nan"'), "base", "mass", "<mass value>: read 'nan'; allowed: one number"),
    "too large": (changed('ixx="0.1"', 'ixx="1e999"'), "base", "inertia", "<inertia ixx>: read '1e999'"),
    "comma": (changed('value="2"', 'value="2,5"'), "base", "mass", "<mass value>: read '2,5'; allowed: one number"),
    "a no-break space": (
        changed('xyz="0.1 0.2 0.3"', 'xyz="0.1\u00a00.2 0.3"'),
        "base",
        "center_of_mass",
        "allowed: 3 numbers separated by spaces",
    ),
    "commas": (changed('xyz="0.1 0.2 0.3"', 'xyz="1,2,3"'), "base", "center_of_mass", "allowed: 3 numbers separated by spaces"),
    "left of xacro": (changed('value="2"', 'value="${m}"'), "base", "mass", "read '${m}'"),
    "other digits": (changed('value="2"', 'value="٢"'), "base", "mass", "read '٢'"),
    "underscore": (changed('value="2"', 'value="1_0"'), "base", "mass", "read '1_0'"),
    "hexadecimal": (changed('value="2"', 'value="0x1p1"'), "base", "mass", "read '0x1p1'"),
    "nothing": (changed('value="2"', 'value=""'), "base", "mass", "read ''"),
    "long": (changed('value="2"', f'value="{"1" * 9999}"'), "base", "mass", "read '1111"),
    "two angles": (changed('rpy="0.4 -0.5 0.6"', 'rpy="1 2"'), "base", "inertia", "<origin rpy>: read '1 2'"),
    "place": (changed('xyz="1 -2 3"', 'xyz="a b c"'), "shoulder", "pose", "<origin xyz>: read 'a b c'"),
    "no axis": (changed('<axis xyz="0 3 4"/>', "<axis/>"), "shoulder", "axis", "<axis xyz>: is missing"),
    "no limit": (changed('<limit effort="5" velocity="inf"/>', ""), "drawer", "effort_limit", "has no <limit>, which URDF"),
    "no effort": (changed(' effort="3"', ""), "shoulder", "effort_limit", "<limit effort>: is missing; allowed: one number"),
    "no speed": (changed(' velocity="4"', ""), "shoulder", "effort_limit", "<limit velocity>: is missing"),
    "lower": (changed('lower="-1" upper="2"', 'lower="3" upper="2"'), "shoulder", "effort_limit", "read 3.0, which exceeds"),
    "nan limit": (changed('effort="3"', 'effort="nan"'), "shoulder", "effort_limit", "<limit effort>: read 'nan'"),
    "damping": (changed('damping="0.5"', 'damping="x"'), "shoulder", "damping", "<dynamics damping>: read 'x'"),
    "friction": (changed('friction="0.25"', 'friction="-inf"'), "shoulder", "friction", "<dynamics friction>: read '-inf'"),
    "mimic": (changed('joint="shoulder" mul', 'joint="none" mul'), "axle", "joint_type", "there is no joint 'none'"),
    "mimic itself": (changed('joint="shoulder" mul', 'joint="axle" mul'), "axle", "joint_type", "one another in a circle"),
    "mimic a weld": (changed('joint="shoulder" mul', 'joint="weld" mul'), "axle", "joint_type", "cannot follow a fixed one"),
    "mimic nothing": (changed('joint="shoulder" mul', "mul"), "axle", "joint_type", "<mimic joint>: is missing"),
    "spherical": (changed('"floating"', '"spherical"'), "keel", "joint_type", "read 'spherical'; allowed: revolute"),
}  # fmt: skip

#: The same for what leaves no tree.
WITHOUT_TREE = {
    "no link": ('<robot name="r"/>', "model", "parent", "<robot>: has no <link>"),
    "no root": (changed("</robot>", '<joint name="b" type="fixed"><parent link="puck"/><child link="base"/></joint></robot>'),
                "model", "parent", "without a parent: none; allowed: one"),
    "two roots": (changed("</robot>", '<link name="other"/></robot>'), "model", "parent", "'base', 'other'; allowed: one"),
    "circle": (changed('<parent link="ship"/>', '<parent link="puck"/>'), "puck", "parent", "is in a circle of links"),
    "two parents": (changed('<child link="ship"/>', '<child link="arm"/>'), "arm", "parent", "'arm' is the child of two"),
    "unknown child": (changed('<child link="arm"/>', '<child link="x"/>'), "shoulder", "parent", "child: there is no link 'x'"),
    "no parent": (changed('<parent link="base"/>', ""), "shoulder", "parent", "<joint>: parent: is missing"),
    "nameless end": (changed('<child link="arm"/>', "<child/>"), "shoulder", "parent", "<child link>: child: is missing"),
    "type": (changed('"floating"', '"ball"'), "keel", "joint_type", "<joint type>: read 'ball'; allowed: revolute, continuous"),
    "no type": (changed(' type="floating"', ""), "keel", "joint_type", "<joint type>: is missing; allowed: revolute"),
    "axis": (changed("0 3 4", "0 0 0"), "shoulder", "axis", "<axis xyz>: joint 'shoulder': axis: its length is 0"),
    "endless axis": (changed("0 3 4", "0 inf 0"), "shoulder", "axis", "<axis xyz>: read '0 inf 0'"),
    "nameless link": (changed('<link name="frame"/>', "<link/>"), "model", "parent", "<link name>: is missing"),
    "empty name": (changed('name="frame"', 'name=""'), "model", "parent", "<link name>: is missing"),
    "two of a name": (changed("</robot>", '<link name="arm"/></robot>'), "arm", "parent", "read 'arm', which stands twice"),
    "two joints of a name": (changed('"drawer"', '"axle"'), "axle", "parent", "<joint name>: read 'axle', which stands twice"),
    "long name": (changed('"frame"', f'"{"x" * 501}"'), "model", "parent", "<link name>: read 'xxx"),
}  # fmt: skip


@pytest.mark.parametrize("what", [*TOLERATED, *WITHOUT_TREE])
def test_what_the_specification_refuses(what: str) -> None:
    text, *expected, words = (TOLERATED | WITHOUT_TREE)[what]
    made = read(text)
    assert (made.model is not None) == (what in TOLERATED)
    fault = made.faults[0]
    assert [fault.subject, fault.quantity] == expected
    assert fault.text.startswith("robot.urdf:")
    assert words in fault.text
    assert len(made.faults) == 1


def test_what_is_not_a_number_is_kept_and_what_cannot_be_read_is_the_default() -> None:
    for text, mass in (("nan", math.nan), ("inf", math.inf), ("-1", -1.0), ("2 kg", 0.0)):
        made = read(changed('value="2"', f'value="{text}"')).model
        assert made is not None
        np.testing.assert_equal(made.links[0].mass, mass)
    made = read(changed('rpy="0.4 -0.5 0.6"', 'rpy="0 nan 0"')).model
    assert made is not None
    assert np.isnan(made.links[0].inertia).all()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"<mujoco/>", "<mujoco>: is no URDF; allowed: <robot>"),
        (b"<ROBOT/>", "<ROBOT>: is no URDF"),
        (b"", "is not XML"),
        (b"\0<robot/>", "is not XML"),
        (b"<robot>\0</robot>", "is not XML"),
        (b"<robot name='&x;'/>", "is not XML: undefined entity"),
        (b"<!DOCTYPE robot><robot/>", "read a document type definition"),
        (b"<robot>" + b"<link>" * 300, "elements are nested more than 200 deep"),
        (b"<robot>" + b"<link name='x'/>" * 501 + b"</robot>", "has 501 links; allowed: at most 500"),
        (b"<robot>" + b"<joint/>" * 501 + b"</robot>", "has 501 joints; allowed: at most 500"),
        (b"<robot>" + b"<a/>" * 3001 + b"</robot>", "the file has more than 3000 elements"),
    ],
)
def test_what_is_no_model_at_all(content: bytes, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(elements, "MAX_ELEMENTS", 3000)  # 200,000 take seconds
    with pytest.raises(BadInput) as caught:
        urdf.read(content, "robot.urdf")
    assert words in str(caught.value)


@pytest.mark.parametrize("encoding", ["utf-16", "iso-8859-1", "utf-8-sig"])
def test_other_encodings(encoding: str) -> None:
    told = encoding.removesuffix("-sig")
    text = ROBOT.replace('version="1.0"', f'version="1.0" encoding="{told}"', 1).replace('"base"', '"bäse"')
    made = urdf.read(text.encode(encoding), "robot.urdf").model
    assert made is not None
    assert made.links[0].name == "bäse"


HOSTILE = "a&#10;b&#9;&lt;b&gt;&quot;'&#x202e;=1+1"


def test_names_are_kept_and_told_on_one_printable_line() -> None:
    text = ROBOT.replace('"arm"', f'"{HOSTILE}"')
    assert model(text).links[1].name == "a\nb\t<b>\"'\u202e=1+1"
    for made in (
        read(text.replace("<visual/>", "<inertial/>")),
        read(text.replace("</robot>", f'<link name="{HOSTILE}"/></robot>')),
    ):
        assert made.faults
        assert all(fault.text.isprintable() and len(fault.text) < 300 for fault in made.faults)


def test_faults_are_told_up_to_a_number() -> None:
    made = read(changed("</robot>", "<link/>" * 300 + "</robot>"))
    assert made.model is None
    assert len(made.faults) == MAX_FAULTS + 1
    assert made.faults[-1].text == "robot.urdf: has more faults, which are not listed"


VALUES = st.sampled_from([
    "", "x", "0", "nan", "-1", "1e300", "1e-320", "1e400", "0 0 0", "0 0 1", "1 2 3 4", "arm", "base", "shoulder", "fixed",
    "1.1", "planar", "revolute", "\x7f", "\u202e", "1 nan inf",
])  # fmt: skip


@given(st.lists(st.tuples(st.integers(0, 120), VALUES), max_size=6), st.lists(st.integers(0, 60), max_size=3))
def test_any_values_are_read_or_told(values: list[tuple[int, str]], left_out: list[int]) -> None:
    """Whatever stands in attributes and whichever lines are missing, there is a model or a fault, and numbers stay numbers."""
    pieces = ROBOT.split('"')
    for place, value in values:
        if 2 < 2 * place + 1 < len(pieces) and "http" not in pieces[2 * place + 1]:
            pieces[2 * place + 1] = value
    lines = '"'.join(pieces).split("\n")
    try:
        made = read("\n".join(line for number, line in enumerate(lines) if number not in left_out))
    except BadInput:  # a line is missing between the beginning and the end of an element
        assume(False)
    assert made.model is not None or made.faults
    for fault in made.faults:
        assert fault.quantity in get_args(FaultyQuantity)
        assert fault.text.isprintable()
    if made.model is not None and not made.faults:
        wide = [array for link in made.model.links for array in (link.center_of_mass, link.inertia)]
        wide += [array for joint in made.model.joints for array in (joint.position, joint.rotation, joint.axis)]
        assert all(np.isfinite(array).all() and array.dtype == np.longdouble for array in wide)


def test_links_may_stand_in_any_order() -> None:
    """Three orders of the same three lines of links give the same tree."""
    lines = ROBOT.split("\n")
    for order in itertools.islice(itertools.permutations((2, 3, 4)), 3):
        made = model("\n".join([*lines[:2], *(lines[number] for number in order), *lines[5:]]))
        assert made.links[made.root].name == "base"
        assert {(made.links[joint.parent].name, made.links[joint.child].name) for joint in made.joints} >= {("arm", "frame")}
