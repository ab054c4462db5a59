"""Engines get a copy of a robot model in which nothing leads to another file, whatever a stranger has written."""

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bodycheck.errors import BadInput
from bodycheck.robots import elements, mjcf_assembly, mjcf_meshes, urdf
from bodycheck.robots.checked import UNWANTED, Checked, checked
from bodycheck.robots.elements import Element
from bodycheck.robots.named_files import PATHS, local

URDF = """\
<?xml version="1.0"?>
<!-- a comment --><?a processing instruction?>
<robot name="r &amp; s" xmlns:drake="http://drake.mit.edu">
  <mujoco><compiler meshdir="/etc" balanceinertia="true"/><option timestep="0.01"/><size memory="1000G"/></mujoco>
  <material name="red"><texture filename="/etc/passwd"/></material>
  <link name="a&#10;b">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="1 1 1"/></geometry></visual>
    <collision><geometry><mesh filename="package://x/../../etc/passwd"/></geometry></collision>
    <collision><geometry><sphere radius="2"/></geometry></collision>
  </link>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type><actuator name="m"/></transmission>
  <gazebo><plugin filename="libevil.so"/><mu1>0.5 &lt; 1</mu1></gazebo>
  <deformable name="d"><visual filename="x.vtk"/></deformable>
  <drake:joint name="n" drake:url="http://example.org"/>
</robot>
"""

BODY = '<body name="b"><freejoint/>{}</body>'
INERTIAL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'

#: A pyramid.
STL = b"solid s\nendsolid s\n"
SHAPE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"
OBJ = b"mtllib ../../etc/passwd\n" + SHAPE + b"usemtl x\ncall x\nmtllib \\\n/etc/passwd\n"


def mjcf(inside: str, top: str = "") -> str:
    return f'<mujoco model="m">{top}<worldbody>{inside}</worldbody></mujoco>'


def copied(folder: Path, content: str, packages: tuple[Path, ...] = (), name: str = "robot.xml") -> Checked:
    (folder / name).write_text(content)
    into = folder / "copies" / str(len(list(folder.glob("copies/*"))))
    into.mkdir(parents=True)
    return checked(folder / name, packages, into)


def copy_of(made: Checked) -> Element:
    return elements.read(Path(made.file.path))


def tags(root: Element) -> list[str]:
    return [element.tag for element in root.everything()]


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The paths of all files that are opened for reading."""
    paths: list[Path] = []
    really = os.open

    def watched(path: Any, flags: int, *rest: Any, **more: Any) -> int:
        if not flags & os.O_CREAT:
            paths.append(Path(path))
        return really(path, flags, *rest, **more)

    monkeypatch.setattr(os, "open", watched)
    return paths


def test_a_urdf_loses_what_leads_to_files_and_nothing_else(tmp_path: Path, opened: list[Path]) -> None:
    made = copied(tmp_path, URDF)
    assert opened == [tmp_path / "robot.xml"]
    assert (made.file.format, made.file.packages) == ("urdf", {})
    root = copy_of(made)
    assert tags(root) == [
        *("robot", "mujoco", "compiler", "option", "link", "inertial", "mass", "inertia", "collision", "geometry", "sphere"),
        *("transmission", "type", "actuator", "gazebo", "mu1", "drake:joint"),
    ]  # fmt: skip
    by_tag = {element.tag: element for element in root.everything()}
    assert by_tag["robot"].attributes["name"] == "r & s"
    assert by_tag["link"].attributes["name"] == "a\nb"
    assert by_tag["compiler"].attributes == {"balanceinertia": "true"}
    assert by_tag["drake:joint"].attributes == {"name": "n"}
    assert by_tag["type"].text == ["transmission_interface/SimpleTransmission"]
    assert by_tag["mu1"].text == ["0.5 < 1"]
    assert made.removed == (
        *("<collision> (1)", "<deformable> (1)", "<material> (1)", "<plugin> (1)", "<size> (1)", "<visual> (1)"),
        *("drake:url of <drake:joint> (1)", "meshdir of <compiler> (1)"),
    )


def test_the_copy_means_the_same(tmp_path: Path) -> None:
    """Faults and numbers of a URDF are those of its copy."""
    text = URDF.replace('value="1"', 'value="0.1000000000000000055511151231257827"').replace('iyz="0"', 'iyz="${x}"')
    made = copied(tmp_path, text)
    first, second = (urdf.read(content, "r") for content in (text.encode(), Path(made.file.path).read_bytes()))
    assert first.model is not None
    assert second.model is not None
    assert first.model.links[0].mass == second.model.links[0].mass == 0.1
    assert [fault.text.partition("<")[2] for fault in first.faults] == [fault.text.partition("<")[2] for fault in second.faults]
    assert first.faults


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ('<!DOCTYPE r [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]><robot name="&b;"/>', "a document type definition"),
        ('<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot name="r"/>', "a document type definition"),
        ('<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="&x;"/>', "a document type definition"),
        ("<sdf/>", "<sdf>: is no robot model; allowed: <robot> (URDF) or <mujoco> (MJCF)"),
        ("<MuJoCo/>", "is no robot model"),
        ("<robot>" + "<a>" * 300, "nested more than 200 deep"),
        ("not xml", "is not XML"),
        ("<robot name='\x01'/>", "is not XML"),
    ],
)
def test_what_is_refused_as_a_whole(tmp_path: Path, content: str, words: str) -> None:
    with pytest.raises(BadInput) as caught:
        copied(tmp_path, content)
    assert words in str(caught.value)
    assert list((tmp_path / "copies/0").iterdir()) == []


def test_only_a_regular_file_up_to_a_size_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for path, words in ((tmp_path, "is not a regular file"), (tmp_path / "none", "cannot be read"), (Path("a\0b"), "null")):
        with pytest.raises(BadInput, match=words):
            checked(path, (), tmp_path)
    monkeypatch.setattr(elements, "MAX_BYTES", 100)
    with pytest.raises(BadInput, match="larger than 100 bytes"):
        copied(tmp_path, URDF)


def test_the_user_may_name_a_link_to_a_model(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "real/robot.urdf").write_text(URDF)
    (tmp_path / "robot.urdf").symlink_to("real/robot.urdf")
    (tmp_path / "into").mkdir()
    assert checked(tmp_path / "robot.urdf", (), tmp_path / "into").file.format == "urdf"


def test_an_mjcf_loses_what_leads_to_files(tmp_path: Path, opened: list[Path]) -> None:
    top = """\
<compiler meshdir="/etc" texturedir="/" assetdir="/" angle="radian"/><size memory="9999G"/>
<extension><plugin plugin="a.b"/></extension><visual/>
<asset><texture name="t" file="/etc/passwd"/><material name="m" texture="t"><layer texture="t"/></material>
<hfield name="h" file="/etc/passwd" size="1 1 1 1"/><skin file="/etc/passwd"/><mesh file="../a.b.stl" scale="9 9 9"/></asset>"""
    inside = BODY.format(f'{INERTIAL}<geom type="mesh" mesh="a.b"/><plugin plugin="x"/>') + '<geom type="mesh" mesh="a.b"/>'
    made = copied(tmp_path, mjcf(inside, top))
    assert opened == [tmp_path / "robot.xml"]
    root = copy_of(made)
    assert made.file.format == "mjcf"
    assert not {"texture", "skin", "plugin", "extension", "size", "layer"} & set(tags(root))
    by_tag = {element.tag: element for element in root.everything()}
    assert by_tag["compiler"].attributes == {"angle": "radian"}
    assert by_tag["material"].attributes == {"name": "m"}
    assert by_tag["hfield"].attributes == {"name": "h", "size": "1 1 1 1", "nrow": "2", "ncol": "2"}
    assert by_tag["mesh"].attributes == {"name": "a.b", **mjcf_meshes.SMALL}
    assert "file of <mesh> (1)" in made.removed


@pytest.mark.parametrize("where", ["meshdir", "assetdir", "strippath", "packages", "absolute", "default", "compiler"])
def test_a_mesh_that_carries_inertia_is_copied(tmp_path: Path, where: str) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in/wing.STL").write_bytes(STL)
    compiler, file, geom, packages = "", "in/wing.STL", '<geom type="mesh" mesh="wing"/>', ()
    match where:
        case "meshdir":
            compiler, file = '<compiler assetdir="no" meshdir="in"/>', "wing.STL"
        case "assetdir":
            compiler, file = '<compiler assetdir="no"/><compiler assetdir="in"/>', "wing.STL"
        case "strippath":
            compiler, file = '<compiler strippath="true" meshdir="in"/>', "C:\\x/y/wing.STL"
        case "packages":
            file, packages = "package://in/wing.STL", (tmp_path / "in",)
        case "absolute":
            file = str(tmp_path / "in/wing.STL")
        case "default":
            compiler, geom = '<default><geom type="mesh" mesh="wing"/></default>', "<geom/>"
        case "compiler":
            compiler, geom = '<compiler inertiafromgeom="true"/>', geom + INERTIAL
    made = copied(tmp_path, mjcf(BODY.format(geom), f'{compiler}<asset><mesh file="{file}"/></asset>'), packages)
    mesh = next(element for element in copy_of(made).everything() if element.tag == "mesh")
    assert mesh.attributes == {"name": "wing", "file": "mesh-0.stl"}
    assert (Path(made.file.path).parent / "mesh-0.stl").read_bytes() == STL


def test_an_obj_file_is_copied_without_the_names_of_other_files(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_bytes(OBJ)
    made = copied(tmp_path, mjcf(BODY.format('<geom type="mesh" mesh="a"/>'), '<asset><mesh file="a.obj"/></asset>'))
    assert (Path(made.file.path).parent / "mesh-0.obj").read_bytes() == SHAPE


OUTSIDE = ["../out.stl", "/etc/passwd", "link.stl", "folder/out.stl", "file:///etc/passwd", "http://example.org/a.stl"]
OUTSIDE += ["package://out/out.stl", "package://pack/../out.stl", "package:///out.stl", "a" * 9000, "a/" * 9000]


@pytest.mark.parametrize("name", OUTSIDE)
@pytest.mark.parametrize("kind", ["mesh", "include"])
def test_no_file_outside_the_folders_is_opened(tmp_path: Path, opened: list[Path], name: str, kind: str) -> None:
    (tmp_path / "out.stl").write_bytes(STL)
    home, package = tmp_path / "home", tmp_path / "pack"
    home.mkdir()
    package.mkdir()
    (home / "link.stl").symlink_to("../out.stl")
    (home / "folder").symlink_to("..")
    carrier = BODY.format('<geom type="mesh" mesh="m"/>')
    text = mjcf(carrier, f'<asset><mesh name="m" file="{name}"/></asset>')
    if kind == "include":
        text = mjcf("", f'<Include file="{name}"/>')
    with pytest.raises(BadInput) as caught:
        copied(home, text, (package,))
    told = str(caught.value)
    assert re.search(r"(is outside the folder of the model and those of --package-path|is not there)", told), told
    assert told.isprintable()
    assert len(told) < 300
    assert opened == [home / "robot.xml"]


def test_what_is_missing_or_of_another_kind_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def told(file: str) -> str:
        with pytest.raises(BadInput) as caught:
            copied(tmp_path, mjcf(BODY.format('<geom mesh="m"/>'), f'<asset><mesh name="m" file="{file}"/></asset>'))
        return str(caught.value)

    (tmp_path / "a.dae").write_text("<x/>")
    (tmp_path / "a.stl").write_bytes(STL)
    assert "'none.stl' is not there, and its shape carries inertia" in told("none.stl")
    assert "read 'a.dae'; allowed where a shape carries inertia: .stl, .obj, .msh" in told("a.dae")
    monkeypatch.setattr(mjcf_meshes, "MAX_BYTES", 10)
    assert "'a.stl': larger than 10 bytes" in told("a.stl")


def test_included_files_are_put_in_their_places(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/arm.xml").write_text('<a><body name="arm"><include file="hand.xml"/></body><body name="leg"/></a>')
    (tmp_path / "parts/hand.xml").write_text('<b><geom name="hand" type="mesh" mesh="m"/></b>')
    (tmp_path / "assets.xml").write_text('<c><asset><mesh name="m" file="parts/m.stl"/></asset></c>')
    (tmp_path / "parts/m.stl").write_bytes(STL)
    made = copied(tmp_path, mjcf('<include file="parts/arm.xml"/><body name="last"/>', '<include file="assets.xml"/>'))
    root = copy_of(made)
    assert tags(root) == ["mujoco", "asset", "mesh", "worldbody", "body", "geom", "body", "body"]
    assert [body.attributes["name"] for body in root.everything() if body.tag == "body"] == ["arm", "leg", "last"]
    assert (Path(made.file.path).parent / "mesh-0.stl").exists()


INCLUDED = {
    "itself": ('<include file="robot.xml"/>', "", "is included twice"),
    "twice": ('<include file="a.xml"/><include file="./a.xml"/>', "<a><b/></a>", "'./a.xml' is included twice"),
    "circle": ('<include file="a.xml"/>', '<a><include file="a.xml"/></a>', "is included twice"),
    "entity": ('<include file="a.xml"/>', '<!DOCTYPE a [<!ENTITY e "x">]><a/>', "<include file>: a.xml:1: read a document"),
    "no XML": ('<include file="a.xml"/>', "x", "<include file>: a.xml:1: is not XML"),
    "nothing": ("<include/>", "", "<include file>: '' is not there"),
    "folder": ('<include file="."/>', "", "<include file>: '.' is not there"),
    "a model": ('<asset><model name="x" file="a.xml"/></asset>', "<mujoco/>", "<model>: brings another model"),
    "attached": ('<attach model="x"/>', "", "<attach>: brings another model"),
    "deformable": ('<flexcomp file="a.xml"/>', "", "<flexcomp file>: brings a deformable body"),
}  # fmt: skip


@pytest.mark.parametrize("what", INCLUDED)
def test_what_an_mjcf_may_not_bring(tmp_path: Path, what: str) -> None:
    top, other, words = INCLUDED[what]
    (tmp_path / "a.xml").write_text(other)
    with pytest.raises(BadInput) as caught:
        copied(tmp_path, mjcf("", top))
    assert words in str(caught.value).replace(str(tmp_path) + "/", "")


def test_included_files_have_limits_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for number in range(6):
        inner = "<x>" * 50 + f'<include file="{number + 1}.xml"/>' + "</x>" * 50
        (tmp_path / f"{number}.xml").write_text(f"<a>{inner if number < 5 else '<b/>'}</a>")
    text = mjcf("", '<include file="0.xml"/>')
    with pytest.raises(BadInput, match="nested more than 200 deep"):
        copied(tmp_path, text)
    monkeypatch.setattr(mjcf_assembly, "MAX_ELEMENTS", 150)
    with pytest.raises(BadInput, match="more than 150 elements with those that it includes"):
        copied(tmp_path, text)
    monkeypatch.setattr(mjcf_assembly, "MAX_INCLUDES", 2)
    with pytest.raises(BadInput, match="more than 2 files are included"):
        copied(tmp_path, text)


def test_bodies_and_joints_of_an_mjcf_get_names(tmp_path: Path) -> None:
    """Not those that stand for others, as in defaults and composites, where a name is not allowed."""
    rest = '<default><joint/></default><asset/><worldbody><body name="joint0"><joint/><frame><freejoint name=""/></frame>'
    rest += '<body><joint name="b"/><composite><joint kind="main"/></composite></body></body>'
    rest += '<body name="arm"><joint/></body><body name="b"><joint/></body></worldbody>'
    root = copy_of(copied(tmp_path, f"<mujoco>{rest}</mujoco>"))
    named = [(element.tag, element.attributes["name"]) for element in root.everything() if "name" in element.attributes]
    assert named == [
        *(("body", "joint0"), ("joint", "joint1"), ("freejoint", "joint2"), ("body", "body0"), ("joint", "b")),
        *(("body", "arm"), ("joint", "arm"), ("body", "b"), ("joint", "joint3")),
    ]


NAMES = st.sampled_from(
    [*sorted(UNWANTED), "Mesh", "INCLUDE", "x:include", "robot", "link", "collision", "geometry", "default"]
)
ATTRIBUTES = st.dictionaries(
    st.sampled_from([*sorted(PATHS), "FileName", "x:href", "name", "Texture"]),
    st.text('a/.\n<"&é\u202e', max_size=5),
    max_size=3,
)


@st.composite
def trees(draw: st.DrawFn, depth: int = 3) -> str:
    tag = draw(NAMES)
    attributes = "".join(f" {name}={quoteattr(value)}" for name, value in draw(ATTRIBUTES).items())
    inner = "".join(draw(st.lists(trees(depth - 1), max_size=3))) if depth else draw(st.sampled_from(["", "text"]))
    return f"<{tag}{attributes}>{inner}</{tag}>"


def forbidden(root: Element, unwanted: set[str]) -> Iterator[str]:
    for element in root.everything():
        if local(element.tag) in unwanted:
            yield element.tag
        yield from (name for name in element.attributes if local(name) in PATHS)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(trees(), max_size=4))
def test_nothing_in_any_copy_of_a_urdf_names_a_file(tmp_path: Path, inside: list[str]) -> None:
    made = copied(tmp_path, f"<robot name='r'>{''.join(inside)}</robot>")
    assert list(forbidden(copy_of(made), UNWANTED)) == []
