"""The keys of the table [model] of a case file, the start of a free base, and what is stored of a model."""

import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from bodycheck import CaseFaults, load
from bodycheck.casefile.case import parse_stored
from bodycheck.casefile.content import Case
from bodycheck.casefile.identity import identity
from bodycheck.casefile.mechanisms import model_files
from bodycheck.casefile.mechanisms.stored import EARLIER_MARK, MARK, file_text
from bodycheck.casefile.robot_notes import JointRange
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, Mimic
from bodycheck.reference.mechanisms.start import frames
from tests.support.robot_cases import MJCF, URDF, case_file, start

#: Two fingers, of which one follows the other one backwards with an offset, and a planar foot across the axis y.
GRIPPER = """\
<robot name="gripper">
  <link name="palm"/>
  <link name="left">{inertial}<visual/><visual/></link>
  <link name="right">{inertial}<collision/></link>
  <link name="foot">{inertial}</link>
  <transmission name="t"/>
  <joint name="a" type="revolute"><parent link="palm"/><child link="left"/>
    <limit lower="-1" upper="0.5" effort="1" velocity="1"/><dynamics damping="0.1" friction="0.2"/></joint>
  <joint name="b" type="continuous"><parent link="palm"/><child link="right"/><axis xyz="0 0 1"/>
    <mimic joint="a" multiplier="-2" offset="0.25"/></joint>
  <joint name="c" type="planar"><parent link="right"/><child link="foot"/><axis xyz="0 1 0"/><origin xyz="0 0 1"/></joint>
</robot>
""".replace(
    "{inertial}",
    '<inertial><origin xyz="0 0.1 0"/><mass value="1"/>'
    '<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial>',
)


def gripper(folder: Path, keys: str = "") -> Case:
    return load(case_file(folder, GRIPPER, keys, "robot.urdf"))


def joints(case: Case) -> dict[str, Joint]:
    assert isinstance(case.scene, Mechanism)
    return {joint.name: joint for joint in case.scene.joints}


def test_a_joint_follows_another_one(tmp_path: Path) -> None:
    case = gripper(tmp_path, start("a", position=0.5, velocity=3.0))
    assert joints(case)["b"].mimic == Mimic(0, -2.0, 0.25)
    assert (joints(case)["b"].start, joints(case)["b"].start_velocity) == ((-0.75,), (-6.0,))
    with pytest.raises(CaseFaults, match=r"initial\.joints\.b: the joint follows another one"):
        gripper(tmp_path, start("b", position=0.5))
    alone = gripper(tmp_path, 'ignore = ["mimic"]\n' + start("b", position=0.5))
    assert (joints(alone)["b"].mimic, joints(alone)["b"].start) == (None, (0.5,))


def test_what_is_ignored_is_left_out_and_noted(tmp_path: Path) -> None:
    case = gripper(tmp_path, 'ignore = ["friction", "damping", "limits", "contacts", "mimic", "tendons"]\n')
    assert (joints(case)["a"].damping, joints(case)["a"].friction) == (0.0, 0.0)
    assert case.robot is not None
    assert (case.robot.without, case.robot.ranges, case.robot.touching) == (
        ("contacts", "damping", "friction", "limits", "mimic"),
        (),
        False,
    )
    assert "The damping of 1 joint (line 8) is left out, as the case ignores it." in case.robot.notices
    assert "1 element <mimic> (line 10) is left out, as the case ignores it." in case.robot.notices


def test_the_notes_on_a_model(tmp_path: Path) -> None:
    case = gripper(tmp_path)
    assert case.robot is not None
    assert case.robot.file == "robot.urdf"
    assert case.robot.ranges == (JointRange("a", -1.0, 0.5),)
    assert case.robot.touching
    assert case.robot.without == ()
    assert case.robot.notices == (
        "2 visual elements (line 3) have no mass.",
        "1 transmission (line 6) is without control and exerts nothing.",
    )


def test_the_plane_of_a_planar_joint_is_across_its_axis(tmp_path: Path) -> None:
    """The foot moves across y: its axes are turned, and its centre of mass stays where the file has it."""
    case = gripper(tmp_path, start("a", position=0.125) + start("c", velocity=[1.0, 2.0, 3.0]))
    assert isinstance(case.scene, Mechanism)
    foot = frames(case.scene)[2]
    assert foot.velocity[1] == pytest.approx(0.0, abs=1e-15)
    assert np.linalg.norm(foot.velocity.astype(float)) == pytest.approx(math.sqrt(5))
    assert foot.spin.astype(float) == pytest.approx([0.0, 3.0, 0.0], abs=1e-15)
    at_rest = gripper(tmp_path, start("a", position=0.125)).scene
    assert isinstance(at_rest, Mechanism)
    centre = frames(at_rest)[2].point(np.array(at_rest.bodies[2].center_of_mass, np.longdouble))
    assert centre.astype(float) == pytest.approx([0.0, 0.1, 1.0], abs=1e-15)


BASE = "[initial.base]\nposition = [1.0, 2.0, 3.0]\nvelocity = [0.1, 0.2, 0.3]\nangular_velocity = [0.0, 0.0, 2.0]\n"


def test_a_free_base_starts_with_its_origin(tmp_path: Path) -> None:
    case = gripper(tmp_path, 'base = "free"\n' + BASE + "euler_zxz = [0.0, 0.0, 1.5]\n")
    assert isinstance(case.scene, Mechanism)
    base = case.scene.joints[0]
    assert (base.name, base.type, base.parent, case.scene.bodies[0].name) == ("base", "free", WORLD, "palm")
    root = frames(case.scene)[0]
    assert root.origin.astype(float).tolist() == [1.0, 2.0, 3.0]
    assert root.velocity.astype(float).tolist() == [0.1, 0.2, 0.3]
    assert root.spin.astype(float).tolist() == [0.0, 0.0, 2.0]
    assert root.turn[:, 0].astype(float) == pytest.approx([math.cos(1.5), math.sin(1.5), 0.0], abs=1e-15)


def test_the_free_joint_of_a_file_is_a_free_base(tmp_path: Path) -> None:
    case = load(case_file(tmp_path, MJCF, BASE))
    assert isinstance(case.scene, Mechanism)
    satellite = next(index for index, body in enumerate(case.scene.bodies) if body.name == "satellite")
    assert frames(case.scene)[satellite].origin.astype(float).tolist() == [1.0, 2.0, 3.0]


def test_the_joint_of_the_base_has_a_name_of_its_own(tmp_path: Path) -> None:
    renamed = GRIPPER.replace('name="a"', 'name="base"').replace('joint="a"', 'joint="base"').replace('"palm"', '"world"')
    case = load(case_file(tmp_path, renamed, 'base = "free"\n', "robot.urdf"))
    assert isinstance(case.scene, Mechanism)
    assert [joint.name for joint in case.scene.joints] == ["base-2", "base", "b", "c"]
    assert case.scene.bodies[0].name == "world:link"


@pytest.mark.parametrize(
    ("keys", "faults"),
    [
        ('base = "fre"\n', [("model.base", "should be 'fixed' or 'free'; did you mean 'free'?")]),
        ('ignore = ["tendon"]\n', [("model.ignore[1]", "did you mean 'tendons'?")]),
        ('ignore = "tendons"\n', [("model.ignore", "should be an array")]),
        ("keyframe = 0\n", [("model.file", "has no keyframes, as it is a URDF")]),
        ("keyframe = -1\n", [("model.keyframe", "greater than or equal to 0")]),
        ("keyframe = 1.5\n", [("model.keyframe", "should be a valid integer")]),
        (
            "bse = 1\n",
            [("model.bse", "unknown key; allowed: file, base, ignore, use, keyframe, upright, stored; did you mean 'base'?")],
        ),
        ("[initial.base]\n", [("initial.base", 'the base of the model is fixed; base = "free" in [model] lets it float')]),
        (
            'base = "free"\n[initial.base]\nposition = [1.0]\nspeed = 1.0\neuler_zxz = [0.0, 0.0, 0.0]\n'
            "quaternion = [2.0, 0.0, 0.0, 0.0]\n",
            [
                ("initial.base.position[2]", "is missing"),
                ("initial.base.position[3]", "is missing"),
                ("initial.base.speed", "unknown key; allowed: position, velocity, euler_zxz, quaternion, angular_velocity"),
                ("initial.base.quaternion", "euler_zxz is given too; give only one"),
                ("initial.base.quaternion", "its length is 2; must be 1 within 0.1 %"),
            ],
        ),
        (
            'base = "free"\n[initial.base]\n[initial.joints.base]\n',
            [("initial.base", "[initial.joints.base] is given too, which is the joint of the base; give only one")],
        ),
    ],
)
def test_faults_of_the_table_name_its_keys(tmp_path: Path, keys: str, faults: list[tuple[str, str]]) -> None:
    with pytest.raises(CaseFaults) as caught:
        gripper(tmp_path, keys)
    shown = [(fault.key, fault.message) for fault in caught.value.faults]
    assert len(shown) == len(faults), str(caught.value)
    for key, words in faults:
        assert any(each == key and words in message for each, message in shown), str(caught.value)
    assert all(fault.position is not None and fault.position.line > 6 for fault in caught.value.faults)


def test_all_features_that_act_are_named_at_once(tmp_path: Path) -> None:
    acting = MJCF.replace(
        "</worldbody>",
        '</worldbody><equality><weld body1="tip"/>\n<weld body1="swing" body2="drawer"/></equality><actuator>'
        '<position joint="hinge" kp="1"/></actuator>',
    ).replace('<body name="tip"', '<body name="tip" gravcomp="1"')
    with pytest.raises(CaseFaults) as caught:
        load(case_file(tmp_path, acting, ""))
    messages = [fault.message for fault in caught.value.faults]
    assert len(messages) == 3, messages
    assert all(message.endswith("out") for message in messages)
    (welds,) = (message for message in messages if "<weld>" in message)
    assert "(robot.xml, lines 26 and 27)" in welds
    assert welds.endswith('ignore = ["equalities"] leaves them out')
    case = load(case_file(tmp_path, acting, 'ignore = ["equalities", "actuators", "gravity_compensation"]\n'))
    assert case.robot is not None
    assert case.robot.without == ("actuators", "equalities", "gravity_compensation")


@pytest.mark.parametrize("keys", ["", 'base = "free"\n' + BASE, 'ignore = ["mimic", "limits"]\n'])
def test_what_is_stored_reads_back_without_files(tmp_path: Path, keys: str) -> None:
    case = gripper(tmp_path, keys)
    (tmp_path / "robot.urdf").unlink()
    assert parse_stored(case.text, "stored") == case
    assert load(_written(tmp_path, case.text)) == case
    document = tomllib.loads(case.text)
    assert document["model"]["stored"]["files"][0]["name"] == "robot.urdf"
    assert document["model"]["stored"]["texts"] == [["robot.urdf", GRIPPER]]
    assert str(tmp_path) not in case.text


def _written(folder: Path, text: str) -> Path:
    path = folder / "robot.case.toml"
    path.write_text(text)
    return path


def test_what_earlier_versions_stored_is_read(tmp_path: Path) -> None:
    case = load(case_file(tmp_path, URDF, start("shoulder", position=0.4), "robot.urdf"))
    earlier = parse_stored(file_text(case) + EARLIER_MARK + json.dumps(URDF) + "\n", "earlier")
    assert (earlier.scene, earlier.robot, identity(earlier)) == (case.scene, case.robot, identity(case))


def test_the_identity_is_that_of_the_numbers(tmp_path: Path) -> None:
    """Neither the folder nor comments of the model change it; each number that is read does."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    case = gripper(tmp_path / "a")
    assert identity(load(case_file(tmp_path / "b", GRIPPER + "<!-- -->", "", "other.urdf"))) == identity(case)
    for old, new in (('mass value="1"', 'mass value="1.1"'), ('ixx="0.1"', 'ixx="0.11"'), ('offset="0.25"', 'offset="0.26"')):
        assert identity(load(case_file(tmp_path / "b", GRIPPER.replace(old, new), "", "robot.urdf"))) != identity(case)
    assert identity(gripper(tmp_path / "b", 'base = "free"\n')) != identity(case)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mass = 1.0", "mass = -1.0", "body 'left': mass: "),
        ('type = "revolute"', 'type = "revolut"', "joint 'a': type: "),
        ("bodies = [", "bodies = 3\nother = [", "model.stored"),
        ("touching = true", "touching = 1", "model.stored.touching"),
        ("joints = [", "joints = [\n  3,", "model.stored.joints"),
        ('name = "a", ', "", "joint '1': name: is missing"),
        ('sha256 = "', 'sha256 = "z', "model.stored.files[1].sha256"),
        ('joint = "a", lower', 'joint = "", lower', "model.stored.ranges[1].joint"),
    ],
)
def test_what_a_stranger_stores_is_checked_as_any_case(tmp_path: Path, old: str, new: str, words: str) -> None:
    text = gripper(tmp_path).text
    assert old in text
    with pytest.raises(CaseFaults) as caught:
        parse_stored(text.replace(old, new, 1), "stored")
    assert any(words in str(fault) for fault in caught.value.faults), str(caught.value)


INCLUDING = '<mujoco><include file="{name}"/></mujoco>'


def test_files_are_read_only_inside_the_folders_that_the_user_named(tmp_path: Path) -> None:
    home, outside = tmp_path / "home", tmp_path / "outside"
    (home / "parts").mkdir(parents=True)
    outside.mkdir()
    (home / "parts" / "arm.xml").write_text(MJCF)
    (outside / "arm.xml").write_text(MJCF)
    (home / "link.xml").symlink_to(outside / "arm.xml")
    (home / "folder.xml").mkdir()
    case = load(case_file(home, INCLUDING.format(name="parts/arm.xml"), ""))
    document = tomllib.loads(case.text)["model"]["stored"]
    assert [file["name"] for file in document["files"]] == ["robot.xml", "parts/arm.xml"]
    assert parse_stored(case.text, "stored") == case
    for name in ("../outside/arm.xml", str(outside / "arm.xml"), "link.xml", "package://outside/arm.xml", "/etc/passwd"):
        with pytest.raises(CaseFaults, match="is outside the folder of the model and those of --package-path"):
            load(case_file(home, INCLUDING.format(name=name), ""))
    for name in ("folder.xml", "none.xml", "parts/" + "x" * 300):
        with pytest.raises(CaseFaults, match="is not there"):
            load(case_file(home, INCLUDING.format(name=name), ""))
    path = case_file(home, INCLUDING.format(name="package://outside/arm.xml"), "")
    case = load(path, packages=[outside])
    assert "package://outside/arm.xml" in case.text
    assert str(tmp_path) not in case.text.replace(MARK, "")
    assert parse_stored(case.text, "stored") == case


def test_the_sizes_of_files_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arm.xml").write_text(MJCF)
    path = case_file(tmp_path, INCLUDING.format(name="arm.xml"), "")
    monkeypatch.setitem(model_files.LIMITS, "texts", (len(MJCF), len(MJCF)))
    with pytest.raises(CaseFaults, match=r"arm\.xml: the texts of the model are larger than \d+ bytes in all"):
        load(path)
    monkeypatch.setitem(model_files.LIMITS, "texts", (len(MJCF) - 1, 2 * len(MJCF)))
    with pytest.raises(CaseFaults, match=r"arm\.xml: larger than \d+ bytes"):
        load(path)


def test_meshes_are_read_with_their_digests_but_not_stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "robot.urdf").write_text(GRIPPER)
    (tmp_path / "a.stl").write_bytes(b"solid")
    files = model_files.ModelFiles(tmp_path / "robot.urdf")
    assert files.content("a.stl") == b"solid"
    assert list(files.digests) == ["robot.urdf", "a.stl"]
    assert list(files.texts) == ["robot.urdf"]
    monkeypatch.setitem(model_files.LIMITS, "meshes", (5, 8))
    with pytest.raises(model_files.BadInput, match="the meshes of the model are larger than 8 bytes in all"):
        files.content("a.stl")


def test_inertia_without_mass_counts_on_the_link_that_carries_it(tmp_path: Path) -> None:
    foot = (
        '<link name="sole"><inertial><mass value="0"/><inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/>'
        '</inertial></link><joint name="d" type="fixed"><parent link="foot"/><child link="sole"/><origin rpy="0 0 1"/></joint>'
    )
    case = load(case_file(tmp_path, GRIPPER.replace("<transmission", foot + "<transmission"), "", "robot.urdf"))
    plain = gripper(tmp_path)
    assert isinstance(case.scene, Mechanism)
    assert isinstance(plain.scene, Mechanism)
    with_sole, without = (nearest_inertia(scene.bodies[2]).tensor for scene in (case.scene, plain.scene))
    xx, yy, zz, xy, xz, yz = np.array(with_sole) - np.array(without)
    moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    assert moments == pytest.approx([0.01, 0.02, 0.03])
    across = 0.01 * math.sin(1.0) ** 2 + 0.02 * math.cos(1.0) ** 2
    assert (yy, zz) == pytest.approx((0.03, across)), "the axis z of the foot's body is y of the foot"
    assert case.robot is not None
    assert "1 link (line 6) has inertia without mass, which is added to what carries it." in case.robot.notices


@pytest.mark.parametrize("name", ["8", "left knee", "knee.1", "größe", 'say "no"', "a/b", "<i>", "[x]", "🦿"])
def test_names_are_any_text(tmp_path: Path, name: str) -> None:
    text = GRIPPER.replace('name="a"', f'name="{_escaped(name)}"').replace('joint="a"', f'joint="{_escaped(name)}"')
    text = text.replace('"left"', f'"{_escaped(name)}"')
    case = load(
        case_file(tmp_path, text, f"[initial.joints.{json.dumps(name, ensure_ascii=False)}]\nposition = 0.5\n", "robot.urdf")
    )
    assert isinstance(case.scene, Mechanism)
    assert (case.scene.joints[0].name, case.scene.joints[0].start, case.scene.bodies[0].name) == (name, (0.5,), name)
    assert parse_stored(case.text, "stored") == case


def _escaped(name: str) -> str:
    return name.replace("<", "&lt;").replace('"', "&quot;")


def test_a_name_that_is_too_long_is_a_fault(tmp_path: Path) -> None:
    with pytest.raises(CaseFaults, match="at most 100 characters"):
        load(case_file(tmp_path, GRIPPER.replace('"left"', f'"{"x" * 101}"'), "", "robot.urdf"))


def test_the_friction_of_joints_is_left_out_and_not_the_joints(tmp_path: Path) -> None:
    joints = "".join(f'<joint name="j{n}" axis="{n} 1 0" frictionloss="0.1"/>\n' for n in (1, 2))
    text = f'<mujoco>\n<worldbody>\n<body gravcomp="1">\n{joints}<geom size="0.1"/></body>\n</worldbody>\n</mujoco>'
    case = load(case_file(tmp_path, text, 'ignore = ["friction", "gravity_compensation"]'))
    assert case.robot is not None
    assert case.robot.notices[1:] == (
        "The gravity compensation of 1 body (line 3) is left out, as the case ignores it.",
        "The friction of 2 joints (lines 4 and 5) is left out, as the case ignores it.",
    )
