"""The parts of an MJCF file that a case does not have: each kind once, with its lines, and whether it acts."""

import re
from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.robot_notes import TendonRange
from bodycheck.casefile.robots.mjcf import schema
from bodycheck.casefile.robots.reading import Read
from bodycheck.errors import BadInput

mujoco: Any = pytest.importorskip("mujoco")

from tests.support.mjcf_readers import NoFiles, read_text  # noqa: E402  (needs MuJoCo)

BODY = '<body name="a"><joint name="j" type="slide"/><joint name="k"/><geom size="0.1" pos="1 0 0"/><site name="s"/></body>'


def text(sections: str, body: str = BODY) -> str:
    return f"<mujoco>\n{sections}\n<worldbody>\n{body}\n</worldbody></mujoco>"


def acting(read: Read) -> set[str | None]:
    return {feature.word for feature in read.features if feature.acts}


#: Actuators that exert nothing while their control is zero, and those that do.
IDLE = (
    '<motor joint="j"/>',
    '<motor joint="j" ctrlrange="-1 1"/>',
    '<general joint="j"/>',
    '<damper joint="j" kv="3" ctrlrange="0 1"/>',
    '<general joint="j" dyntype="integrator"/>',
    '<position joint="j" kp="0"/>',
    '<velocity joint="j" kv="0"/>',
    '<cylinder joint="j"/>',
    '<adhesion body="a" ctrlrange="0 1"/>',
    '<general joint="j" biastype="affine"/>',
    '<general joint="j" biasprm="1 2 3"/>',
    '<general joint="j" dyntype="filter" gainprm="3"/>',
)

ACTING = (
    '<position joint="j"/>',
    '<velocity joint="j"/>',
    '<intvelocity joint="j"/>',
    '<motor joint="j" ctrlrange="0.5 1"/>',
    '<motor joint="j" damping="2"/>',
    '<general joint="j" biastype="affine" biasprm="1 2 3"/>',
    '<position joint="j" kp="0" kv="2"/>',
    '<cylinder joint="j" bias="1 2 3"/>',
    '<pid joint="j" kp="1"/>',
    '<dcmotor joint="j" motorconst="1" resistance="1"/>',
    '<muscle joint="j" lengthrange="0.2 0.5" force="1"/>',
)


@pytest.mark.parametrize("actuator", IDLE + ACTING)
def test_an_actuator_acts_without_control_if_it_does_so_in_mujoco(actuator: str) -> None:
    model = text(f"<actuator>{actuator}</actuator>")
    compiled = mujoco.MjModel.from_xml_string(model)
    data = mujoco.MjData(compiled)
    data.qpos[:], data.qvel[:] = 0.7, 0.3
    mujoco.mj_forward(compiled, data)
    acts = bool(np.any(data.qfrc_actuator) or np.any(data.qfrc_passive))
    assert acts is (actuator in ACTING)
    assert acting(read_text(model)) == ({"actuators"} if acts else set())


TENDONS = {
    **dict.fromkeys(("", 'springlength="1"', 'range="0 1"', 'range="0 1" limited="false"'), False),
    **dict.fromkeys(('stiffness="3"', 'damping="1"', 'frictionloss="1"', 'armature="1"'), True),
}


@pytest.mark.parametrize("attributes", TENDONS)
def test_a_tendon_acts_if_it_exerts_forces(attributes: str) -> None:
    for sections in (
        f'<tendon><fixed {attributes}><joint joint="j" coef="1"/></fixed></tendon>',
        f'<default><tendon {attributes}/></default><tendon><fixed><joint joint="j" coef="1"/></fixed></tendon>',
    ):
        mujoco.MjModel.from_xml_string(text(sections))
        assert acting(read_text(text(sections))) == ({"tendons"} if TENDONS[attributes] else set())


@pytest.mark.parametrize(
    ("tendon", "limits"),
    [
        ('<fixed name="t" range="-0.1 0.3"><joint joint="j" coef="-2"/><joint joint="k" coef="0.5"/></fixed>', (-0.1, 0.3)),
        ('<fixed limited="false" range="-0.1 0.3"><joint joint="j" coef="-2"/></fixed>', None),
        ('<fixed range="-0.1 0.3" stiffness="1"><joint joint="j" coef="-2"/></fixed>', None),
        ('<spatial range="0 0.3"><site site="s"/><site site="r"/></spatial>', None),
    ],
)
def test_the_limits_of_fixed_tendons_are_those_of_mujoco(tendon: str, limits: tuple[float, float] | None) -> None:
    """So is the length: the linear form of the coordinates with which it is limited."""
    model = text(f"<tendon>{tendon}</tendon>", BODY + '<site name="r"/>')
    compiled = mujoco.MjModel.from_xml_string(model)
    ranges = [each for each in read_text(model).ranges if isinstance(each, TendonRange)]
    assert [(each.lower, each.upper) for each in ranges] == ([] if limits is None else [limits])
    for each in ranges:
        assert (each.lower, each.upper) == tuple(compiled.tendon_range[0])
        data = mujoco.MjData(compiled)
        data.qpos[:] = np.arange(1.0, 1.0 + compiled.nq)
        mujoco.mj_fwdPosition(compiled, data)
        form = sum(factor * data.qpos[compiled.joint(joint).qposadr[0]] for joint, factor in each.terms)
        assert data.ten_length[0] == form
    assert not any(isinstance(each, TendonRange) for each in read_text(model, ignore=frozenset({"tendons"})).ranges)


ACTS = {
    "medium": text('<option density="1.2"/>'),
    "gravity_compensation": text("", BODY.replace('name="a"', 'name="a" gravcomp="1"')),
    "equalities": text('<equality><weld body1="a"/></equality>'),
    "damping": text("", BODY.replace('type="slide"', 'type="free" damping="1"').replace('<joint name="k"/>', "")),
    "friction": text("", BODY.replace('type="slide"', 'type="ball" frictionloss="1"').replace('<joint name="k"/>', "")),
}


@pytest.mark.parametrize("word", ACTS)
def test_what_acts_is_left_out_by_its_word(word: Any) -> None:
    assert acting(read_text(ACTS[word])) == {word}
    assert {feature.word for feature in read_text(ACTS[word], ignore=frozenset({word})).features if feature.acts} == {word}


WORDLESS = (
    BODY.replace('type="slide"', 'type="ball" stiffness="1"').replace('<joint name="k"/>', ""),
    BODY.replace('type="slide"', 'type="ball" armature="1"').replace('<joint name="k"/>', ""),
    BODY.replace('type="slide"', 'type="slide" stiffness="1 2"'),
    BODY.replace("<site", '<composite type="cable" count="3 1 1" size="1"/><site'),
)


@pytest.mark.parametrize("body", WORDLESS)
def test_what_no_word_leaves_out_acts(body: str) -> None:
    assert acting(read_text(text("", body))) == {None}


def test_friction_and_damping_that_a_case_ignores_are_zero() -> None:
    body = BODY.replace('type="slide"', 'type="slide" frictionloss="1" damping="2"')
    read = read_text(text("", body), ignore=frozenset({"friction", "damping"}))
    assert acting(read) == {"friction", "damping"}
    assert not {"friction", "damping"} & set(read.tables["joints"][0])


def test_flags_switch_off_what_would_act() -> None:
    off = '<option density="0" gravity="0 0 -3"><flag {}="disable"/></option>'
    for flag, model in (
        ("actuation", text(off.format("actuation") + '<actuator><position joint="j"/></actuator>')),
        ("gravity", ACTS["gravity_compensation"].replace("<worldbody>", off.format("gravity") + "<worldbody>")),
        ("equality", ACTS["equalities"].replace("<equality>", off.format("equality") + "<equality>")),
        ("constraint", ACTS["friction"].replace("<worldbody>", off.format("constraint") + "<worldbody>")),
        ("damper", ACTS["damping"].replace("<worldbody>", off.format("damper") + "<worldbody>")),
    ):
        read = read_text(model)
        assert not acting(read), flag
        assert read.gravity == ((0, 0, 0) if flag == "gravity" else (0, 0, -3))


def test_each_kind_of_part_is_told_once_with_its_lines() -> None:
    read = read_text(
        text(
            '<sensor>\n<touch site="s"/>\n<jointpos joint="j"/>\n</sensor>'
            '<actuator>\n<motor joint="j"/>\n<motor joint="k"/></actuator>'
            "<visual/><statistic/><asset>\n<texture/><material/></asset><contact>\n<exclude/></contact>",
            BODY.replace("<site", "<camera/><light/><site"),
        )
    )
    told = {feature.noun[1]: feature.lines for feature in read.features}
    assert told["sensors"] == (("robot.xml", 3), ("robot.xml", 4))
    assert told["motors"] == (("robot.xml", 6), ("robot.xml", 7))
    assert set(told) == {
        *(
            "sensors",
            "motors",
            "elements <visual>",
            "elements <statistic>",
            "textures",
            "materials",
            "excluded pairs of bodies",
        ),
        *("cameras", "lights", "sites"),
    }
    assert not acting(read)


def test_bodies_may_touch_if_masks_of_two_bodies_have_a_bit_in_common() -> None:
    floor = '<geom type="plane" size="1 1 1" {}/>'
    for world, own, touching in (
        ("", "", True),
        ('contype="0" conaffinity="0"', "", False),
        ('contype="2" conaffinity="0"', 'contype="1" conaffinity="1"', False),
        ('contype="2" conaffinity="0"', 'contype="0" conaffinity="2"', True),
    ):
        body = floor.format(world) + BODY.replace("<geom", f"<geom {own}")
        assert read_text(text("", body)).touching is touching
    assert not read_text(text("", BODY)).touching, "one body alone"
    assert not read_text(text('<option><flag contact="disable"/></option>', floor.format("") + BODY)).touching


def test_a_base_that_floats_in_the_case_alone() -> None:
    body = (
        '<geom type="plane" size="1 1 1"/><body name="a" pos="1 2 3"><geom size="0.1"/>'
        '<body name="b"><joint name="base"/><geom size="0.1"/></body></body>'
    )
    fixed, free = read_text(text("", body)), read_text(text("", body), base="free")
    assert (fixed.welded, fixed.base) == (True, None)
    assert (free.welded, free.base) == (False, "base-2")
    assert free.tables["joints"][0]["initial"]["position"] == [1, 2, 3]
    floating = read_text(text("", body.replace('pos="1 2 3">', '><freejoint name="root"/>')), base="free")
    assert floating.base == "root"
    for wrong, words in (
        (
            body + '<body name="c"><geom size="1"/></body>',
            "has 2 bodies in the world, 'a', 'c'; one that is alone there can float",
        ),
        (body.replace('pos="1 2 3">', '><joint name="j"/>'), "<joint>: moves 'a', so that it cannot float as a base"),
    ):
        with pytest.raises(BadInput, match=re.escape(words)):
            read_text(text("", wrong), base="free")


FAULTS = {
    "<compiler angles='degree'/>": "<compiler angles>: there is no such attribute; did you mean 'angle'?",
    "<default><default/></default>": "<default class>: is missing",
    "<option timestep='0'/>": "<option timestep>: read 0.0; allowed: a positive number",
    "<option><flag gravity='off'/></option>": "<flag gravity>: read 'off'; allowed: enable, disable",
    "<equality><joint joint1='x'/></equality>": "<joint joint1>: there is no hinge or slide 'x'",
    "<equality><connect body1='a' anchor='0 0 0' body2='b'/></equality>": "<connect body2>: there is no body 'b'",
    "<equality><connect site1='s' site2='t'/></equality>": "<connect site2>: there is no site 't'",
    "<include file='other.xml'/>": "<include file>: 'other.xml' is not there",
}


@pytest.mark.parametrize("section", FAULTS)
def test_a_fault_has_its_place(section: str) -> None:
    with pytest.raises(BadInput, match=re.escape("robot.xml:2: " + FAULTS[section])):
        read_text(text(section))


FAULTS_OF_BODIES = {
    '<joint axis="0 0 0"/>': "<joint axis>: read zeros",
    '<joint range="1 0"/>': "<joint range>: read '1 0'; allowed: the smaller limit first",
    '<joint springdamper="1 -1"/>': "<joint springdamper>: read '1 -1'; allowed: positive numbers",
    '<body><freejoint/><geom size="1"/></body>': "<freejoint>: is not the only joint of a body in the world",
    '<geom type="mesh" mesh="m"/>': "<geom mesh>: there is no mesh 'm'",
    '<body name="a"/>': "<body name>: 'a' is the name of another body",
    '<inertial mass="0" pos="0 0 0" diaginertia="1 1 1"/>': "has moments of inertia without mass",
    '<replicate count="1e6"><geom/></replicate>': "<replicate count>: the model has more than 200000 elements",
    '<replicate count="1.5"><geom/></replicate>': "<replicate count>: read '1.5'; allowed: a whole number",
    '<geom size="1" class="x"/>': "<geom class>: there is no default class 'x'",
}


@pytest.mark.parametrize("inside", FAULTS_OF_BODIES)
def test_a_fault_of_a_body_has_its_place(inside: str) -> None:
    with pytest.raises(BadInput, match=r"robot\.xml:4: .*" + re.escape(FAULTS_OF_BODIES[inside])):
        read_text(text("", BODY.replace("<geom", inside + "<geom")))


class Included(NoFiles):
    """Two files that one may include."""

    def text(self, name: str, near: str) -> tuple[str, str]:
        texts = {
            "a.xml": '<mujocoinclude><body name="b"><include file="b.xml"/></body></mujocoinclude>',
            "b.xml": '<x><geom size="0.1"/><joint name="j"/></x>',
            "c.xml": '<x><include file="c.xml"/></x>',
        }
        return (name, texts[name]) if name in texts else super().text(name, near)


def test_included_files_take_the_place_of_their_elements() -> None:
    read = read_text('<mujoco><worldbody><include file="a.xml"/></worldbody></mujoco>', files=Included())
    assert [joint["name"] for joint in read.tables["joints"]] == ["j"]
    for again in ('<include file="b.xml"/>' * 2, '<include file="c.xml"/>'):
        with pytest.raises(BadInput, match="is included twice"):
            read_text(f'<mujoco><worldbody><body name="a">{again}</body></worldbody></mujoco>', files=Included())


def test_the_attributes_are_those_of_mujoco() -> None:
    """Releases add attributes, so that an older one may have fewer."""
    rows: dict[str, set[str]] = {}
    path: list[str] = []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        row = re.match(r"^( *)(\S+) \([!?*R]\) *(.*)$", line)
        if row is None:
            rows["/".join(path)] |= set(line.split())
            continue
        path[len(row[1]) // 3 :] = [row[2]]
        rows["/".join(path)] = set(row[3].split())
    for tag, attributes in schema.ATTRIBUTES.items():
        if tag in ("frame", "replicate"):
            continue
        where = {"body": "(world)body", "flag": "option/flag"}.get(
            tag, f"(world)body/{tag}" if tag not in ("compiler", "option") else tag
        )
        there = rows[f"mujoco/{where}"]
        assert there <= set(attributes.split()), tag
        if mujoco.__version__ == "4.0.0":
            assert there == set(attributes.split()), tag
