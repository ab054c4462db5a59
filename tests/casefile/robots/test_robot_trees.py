"""Whole robot models as mechanisms of case files, against the engine that reads them itself."""

import math
import random
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bodycheck import CaseFaults, load
from bodycheck.casefile.case import parse_stored
from bodycheck.casefile.drawn import member_document, wholes
from bodycheck.casefile.identity import identity, keys
from bodycheck.casefile.mechanisms import model_files
from bodycheck.casefile.mechanisms.stored import file_text
from bodycheck.casefile.toml_text import written
from bodycheck.reference.mechanisms.coordinates import places
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.start import centre, coordinates, frames
from tests.support.mutants import mutant, wrong
from tests.support.robot_cases import HEAD, MJCF, URDF, case_file, start


def mechanism(path: Path) -> Mechanism:
    scene = load(path).scene
    assert isinstance(scene, Mechanism)
    return scene


def assert_read_alike(made: Mechanism, model: str) -> None:
    """The centres of mass, their velocities and the determinant of the mass matrix are those of MuJoCo, which reads the model.

    Roundings of doubles of MuJoCo's own arithmetic are allowed.
    """
    mujoco: Any = pytest.importorskip("mujoco")
    compiled = mujoco.MjModel.from_xml_string(model)
    data = mujoco.MjData(compiled)
    for joint, (held, moving) in zip(made.joints, places(made), strict=True):
        there = compiled.joint(joint.name) if joint.type != "fixed" else None
        if there is not None:
            data.qpos[there.qposadr[0] :][: held.stop - held.start] = joint.start
            data.qvel[there.dofadr[0] :][: moving.stop - moving.start] = joint.start_velocity
    mujoco.mj_fwdPosition(compiled, data)
    mujoco.mj_fwdVelocity(compiled, data)
    at, velocity = frames(made), np.zeros(6)
    for place, body in enumerate(made.bodies):
        there = compiled.body(body.name).id
        np.testing.assert_allclose(at[place].point(centre(body)).astype(float), data.xipos[there], atol=1e-14)
        mujoco.mj_objectVelocity(compiled, data, mujoco.mjtObj.mjOBJ_BODY, there, velocity, 0)
        np.testing.assert_allclose(at[place].spin.astype(float), velocity[:3], atol=1e-14)
        np.testing.assert_allclose(at[place].speed(centre(body)).astype(float), velocity[3:], atol=1e-14)
    full = np.zeros((compiled.nv, compiled.nv))
    mujoco.mj_fullM(compiled, data, full)
    pivots = [float(coordinate.loose) for coordinate in coordinates(made)]
    assert math.prod(pivots) == pytest.approx(np.linalg.det(full), rel=1e-12)


def test_a_urdf(tmp_path: Path) -> None:
    starts = (
        start("shoulder", position=0.4, velocity=1.0)
        + start("reach", position=0.1, velocity=-2.0)
        + start("wrist", velocity=5.0)
    )
    made = mechanism(case_file(tmp_path, URDF, starts, "robot.urdf"))
    assert [joint.name for joint in made.joints] == ["shoulder", "reach", "wrist"], "the frame has no mass"
    assert (made.joints[0].damping, made.joints[0].friction) == (0.1, 0.02)
    assert made.joints[1].axis == (1.0, 0.0, 0.0), "the default of URDF"
    assert_read_alike(
        made,
        URDF.replace(
            '<link name="base">', '<mujoco><compiler fusestatic="false" balanceinertia="false"/></mujoco><link name="base">'
        ),
    )


def test_moments_that_rounding_has_left_of_zero_are_zero(tmp_path: Path) -> None:
    """As a program for CAD writes them: the tool has its mass 0.1 m from its frame, and no moments."""
    tool = '<inertial><mass value="0.5"/><inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial>'
    rounded = tool.replace("<mass", '<origin xyz="0.1 0 0"/><mass').replace("0.01", "-1.4e-20").replace("0.02", "0")
    assert tool in URDF
    made = mechanism(case_file(tmp_path, URDF.replace(tool, rounded.replace("0.03", "1.4e-20")), "", "robot.urdf"))
    assert not any(nearest_inertia(made.bodies[-1]).tensor)
    with pytest.raises(CaseFaults, match="none may be negative"):
        load(case_file(tmp_path, URDF.replace(tool, rounded.replace("1.4e-20", "1.4e-10")), "", "robot.urdf"))


def test_an_mjcf(tmp_path: Path) -> None:
    starts = start("hinge", position=0.3, velocity=1.0) + start(
        "ball", quaternion=[0.8, 0.0, 0.6, 0.0], velocity=[1.0, 2.0, -1.0]
    )
    starts += start("slide", position=-0.2, velocity=0.7) + start("free", velocity=[0.1, 0.2, 0.3], linear=[1.0, 0.0, 2.0])
    made = mechanism(case_file(tmp_path, MJCF, starts))
    joints = {joint.name: joint for joint in made.joints}
    assert (joints["hinge"].damping, joints["hinge"].armature, joints["hinge"].friction) == (0.2, 0.05, 0.1)
    assert joints["hinge"].rest == math.radians(20.0)
    assert joints["ball"].damping == 0.2
    assert joints["free"].start[:3] == (3.0, 0.0, 1.0)
    assert_read_alike(made, MJCF)


def test_the_model_is_part_of_the_case(tmp_path: Path) -> None:
    """What is stored of a case reads back alike without the model's file, and another model is another case."""
    path = case_file(tmp_path, URDF + "<!-- é \x7f -->", start("shoulder", position=0.4), "robot.urdf")
    case = load(path)
    assert file_text(case) == path.read_text()
    (tmp_path / "robot.urdf").unlink()
    assert parse_stored(case.text, "stored") == case
    other = load(case_file(tmp_path, URDF.replace("0.11", "0.111"), start("shoulder", position=0.4), "robot.urdf"))
    assert identity(other) != identity(case)
    changed = {key for key, value in keys(case).items() if keys(other)[key] != value}
    assert changed == {"bodies[1].inertia"}


def test_a_member_needs_no_model(tmp_path: Path) -> None:
    drawn = '[ensemble]\nmembers = 2\n[[ensemble.vary]]\nkey = "joints.shoulder.damping"\n'
    drawn += 'distribution = "choice"\nvalues = [0, 1]\n'
    case = load(case_file(tmp_path, URDF, start("shoulder", position=0.4) + drawn, "robot.urdf"))
    document = tomllib.loads(case.text)
    member = member_document(document, wholes(document, {"joints.shoulder.damping": np.array([0.7])}), 0, 1)
    made = parse_stored(written(member), "member").scene
    assert isinstance(made, Mechanism)
    assert isinstance(case.scene, Mechanism)
    assert made.joints[0].damping == 0.7
    assert (made.bodies, made.joints[1:]) == (case.scene.bodies, case.scene.joints[1:])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('type="continuous"', 'type="ball"', "<joint type>: read 'ball'; allowed: revolute"),
        ('<child link="tool"/>', '<child link="frame"/>', "the link 'frame' is the child of two joints"),
        ('<parent link="base"/>', '<parent link="tool"/>', "is in a circle of links"),
        ('<link name="frame"/>', "", "child: there is no link 'frame'"),
        ('<axis xyz="0 0 1"/>', '<mimic joint="reah"/>', "<mimic joint>: there is no joint 'reah'"),
        ('<parent link="slider"/><child link="tool"/>', '<parent link="slider"/><child link="tool"/><mimic joint="wrist"/>',
         "the joints follow one another in a circle"),
        ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "joint 'wrist': axis: its length is 0"),
        ('izz="0.03"', 'izz="0.3"', "body 'tool': inertia: no body has these moments"),
        ('<link name="tool">', '<link name="t ool">', "there is no link 'tool'"),
        ('name="wrist"', 'name="reach"', "stands twice"),
        ('<link name="tool">\n    <inertial><mass value="0.5"/>', '<link name="tool">\n    <inertial><mass value="0"/>',
         "a moment of inertia without mass"),
        (URDF[URDF.index("<link") : URDF.index("</robot>")], "", "has no <link>"),
        (URDF[URDF.index("<link") : URDF.index("</robot>")], '<link name="base"/>', "has no body with a mass besides the root"),
        ("<robot", "<robo", "is not XML"),
        ('<robot name="arm">', '<!DOCTYPE a [<!ENTITY b "c">]><robot name="arm">', "read a document type definition"),
    ],
)  # fmt: skip
def test_what_a_urdf_may_not_have(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in URDF
    with pytest.raises(CaseFaults) as caught:
        load(case_file(tmp_path, URDF.replace(old, new, 1), "", "robot.urdf"))
    told = [fault.message for fault in caught.value.faults if fault.key == "model.file"]
    assert any(words in message for message in told), str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('<freejoint name="free"/>', "<freejoint/><joint/>", "is not the only joint of a body in the world"),
        ('armature="0"', 'armature="0.1"', "1 ball joint (robot.xml, line 14) has an armature"),
        ("</worldbody>", '</worldbody><equality><weld body1="tip"/></equality>', "(robot.xml, line 26) holds its bodies"),
        ("<worldbody>", '<option density="1.2"/><worldbody>', "1 medium (robot.xml, line 7) acts"),
        ('<body name="tip"', '<body name="tip" gravcomp="1"', "The gravity compensation of 1 body (robot.xml, line 13) acts"),
        ("<worldbody>", '<include file="x"/><worldbody>', "<include file>: 'x' is not there"),
        ('stiffness="3"', 'stiff="3"', "<joint stiff>: there is no such attribute; did you mean 'stiffness'?"),
        ('<body name="weight"', '<body name="tip"', "'tip' is the name of another body"),
        ('<geom type="ellipsoid" size="0.1 0.2 0.3"/>', "", "mass matrix is not positive definite"),
    ],
)  # fmt: skip
def test_what_an_mjcf_may_not_have(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in MJCF
    with pytest.raises(CaseFaults) as caught:
        load(case_file(tmp_path, MJCF.replace(old, new, 1), ""))
    assert any(words in fault.message for fault in caught.value.faults), str(caught.value)


def test_only_a_regular_file_of_the_same_folder_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = case_file(tmp_path, URDF, "", "robot.urdf")
    (tmp_path / "folder.urdf").mkdir()
    (tmp_path / "link.urdf").symlink_to("robot.urdf")
    wrong = {
        "../robot.urdf": "must be the name of a file in the folder",
        "/etc/passwd": "must be the name of a file in the folder",
        ".hidden": "must be the name of a file in the folder",
        "folder.urdf": "not a regular file",
        "link.urdf": "link",
        "none.urdf": "No such file",
    }
    for name, words in wrong.items():
        path.write_text(f'{HEAD}file = "{name}"\n')
        with pytest.raises(CaseFaults, match=words):
            load(path)
    path.write_text(HEAD.replace("[model]\n", "") + 'model = {file = "robot.urdf"}\n')
    with pytest.raises(CaseFaults, match="is not in a table of its own"):
        load(path)
    path.write_text(f'{HEAD}file = "robot.urdf"\n')
    monkeypatch.setitem(model_files.LIMITS, "texts", (100, 100))
    with pytest.raises(CaseFaults, match="larger than 100 bytes"):
        load(path)
    (tmp_path / "robot.urdf").write_bytes(b"\xff")
    with pytest.raises(CaseFaults, match="not UTF-8"):
        load(path)


def test_faults_of_starts_stand_in_the_case_file(tmp_path: Path) -> None:
    starts = start("shouldr", position=1.0) + start("reach", position=[1.0]) + start("wrist", angle=1.0)
    with pytest.raises(CaseFaults) as caught:
        load(case_file(tmp_path, URDF, starts, "robot.urdf"))
    assert {(fault.position.line if fault.position else 0, fault.key) for fault in caught.value.faults} == {
        (8, "initial.joints.shouldr"),
        (11, "initial.joints.reach.position"),
        (13, "initial.joints.wrist.angle"),
    }
    with pytest.raises(CaseFaults, match=r"bodies: \[model\] is given too"):
        load(case_file(tmp_path, URDF, '[[bodies]]\nname = "a"\n', "robot.urdf"))


@pytest.mark.parametrize("model", [URDF, MJCF], ids=["urdf", "mjcf"])
def test_a_mutant_of_a_model_is_a_mechanism_or_has_faults_with_places(tmp_path: Path, model: str) -> None:
    """Each fault is one printable line of the case file, whatever a stranger writes into the model."""
    chance, path, ends = random.Random(5), case_file(tmp_path, model, ""), Counter[str]()
    for _ in range(150):
        name, content = mutant(chance, [model])
        (tmp_path / "robot.xml").write_bytes(content)
        problem, end = "", "case"
        try:
            load(path)
        except CaseFaults as error:
            problem, end = wrong(path, path.read_bytes(), error), "faults"
        assert not problem, f"{name}: {problem}"
        ends[end] += 1
    assert min(ends["case"], ends["faults"]) > 20, ends
