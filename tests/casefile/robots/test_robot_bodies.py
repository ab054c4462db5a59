"""A body of a robot model has the mass properties that MuJoCo's compiler and Pinocchio's reader find in the same file."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bodycheck.casefile import body_template as robots
from bodycheck.casefile.authoring import template
from bodycheck.casefile.case import parse
from bodycheck.errors import BadInput
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Sphere
from bodycheck.reference.trajectory import Array

#: Relative to the largest element. MuJoCo stops its eigenvalues at 1e-12, of which a tensor is made again here.
TOLERANCE = 1e-10

#: Relative to the largest element, for the rounding of a few rotations in double precision.
ROUNDING = 1e-13

Made = Callable[[str, str], tuple[Body, Array]]


@pytest.fixture
def made(tmp_path: Path) -> Made:
    """Returns the body that a case has which is made of the body of a model, and its centre of mass in the model."""

    def made(model: str, name: str) -> tuple[Body, Array]:
        path = tmp_path / "robot.xml"
        path.write_text(model)
        link = robots.read(path, name)
        case = parse(robots.text(template(), link, path), "robot")
        return case.scene.body, np.array([float(part) for part in link.mass_properties.centre])

    return made


def compiled(model: str, name: str) -> tuple[float, Array, Array]:
    """Mass, centre of mass and tensor about it, in the frame of the body, by MuJoCo's compiler."""
    mujoco = pytest.importorskip("mujoco")
    there = mujoco.MjModel.from_xml_string(model)
    body = there.body(name)
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, body.iquat)
    turn = axes.reshape(3, 3)
    return float(body.mass[0]), body.ipos.copy(), turn @ np.diag(body.inertia) @ turn.T


def read_by_pinocchio(model: str) -> tuple[float, Array, Array]:
    """The same of the link on the only joint, by Pinocchio's reader of URDF."""
    pin: Any = pytest.importorskip("pinocchio")
    inertia = pin.buildModelFromXML(model).inertias[1]
    return float(inertia.mass), inertia.lever.copy(), inertia.inertia.copy()


def assert_same(found: tuple[Body, Array], expected: tuple[float, Array, Array], tolerance: float) -> None:
    (body, centre), (mass, place, tensor) = found, expected
    np.testing.assert_allclose(body.mass, mass, rtol=tolerance)
    np.testing.assert_allclose(centre, place, rtol=0, atol=tolerance * max(1.0, np.abs(place).max()))
    np.testing.assert_allclose(inertia_tensor(body), tensor, rtol=0, atol=tolerance * np.abs(tensor).max())


def numbers(*values: float) -> str:
    return " ".join(map(repr, values))


lengths, places, angles = st.floats(0.05, 2.0), st.floats(-2.0, 2.0), st.floats(-180.0, 180.0)


@st.composite
def attitudes(draw: st.DrawFn) -> str:
    """An attitude in one of the ways of MJCF, none at times."""
    kind = draw(st.sampled_from(["", "quat", "axisangle", "euler", "xyaxes", "zaxis"]))
    # Vectors that are neither short nor nearly parallel: the direction of those is only rounding.
    first, second = draw(st.sampled_from([(1.0, 0.3), (-0.6, 1.0)])), draw(st.floats(-1.0, 1.0))
    match kind:
        case "quat":
            return f'quat="{numbers(*first, second, draw(places))}"'
        case "axisangle":
            return f'axisangle="{numbers(*first, second, draw(angles))}"'
        case "euler":
            return f'euler="{numbers(draw(angles), draw(angles), draw(angles))}"'
        case "xyaxes":
            return f'xyaxes="{numbers(*first, second)} {numbers(-first[1], first[0], draw(places))}"'
        case "zaxis":
            return f'zaxis="{numbers(*first, second)}"'
        case _:
            return ""


@st.composite
def geoms(draw: st.DrawFn) -> str:
    kind = draw(st.sampled_from(["sphere", "capsule", "cylinder", "ellipsoid", "box"]))
    weight = draw(st.sampled_from(["", 'mass="{:.3f}"', 'density="{:.3f}"'])).format(draw(lengths))
    more = draw(st.sampled_from(["", 'class="heavy"', 'class="other"', 'group="4"', 'mass="0"' if not weight else ""]))
    if kind in ("capsule", "cylinder", "box", "ellipsoid") and draw(st.booleans()):
        x, y, z = draw(places), draw(places), draw(places)
        ends = numbers(x, y, z, x + draw(lengths), y - draw(lengths), z + draw(places))
        return f'<geom type="{kind}" size="{numbers(draw(lengths))}" fromto="{ends}" {weight} {more}/>'
    count = {"sphere": 1, "capsule": 2, "cylinder": 2}.get(kind, 3)
    size = numbers(*(draw(lengths) for _ in range(count)))
    place = f'pos="{numbers(draw(places), draw(places), draw(places))}"'
    return f'<geom type="{kind}" size="{size}" {place} {draw(attitudes())} {weight} {more}/>'


@st.composite
def inertials(draw: st.DrawFn) -> str:
    """An <inertial> with the moments of a brick."""
    a, b, c = (draw(lengths) ** 2 for _ in range(3))
    place = f'pos="{numbers(draw(places), draw(places), draw(places))}" mass="{draw(lengths)!r}"'
    if draw(st.booleans()):
        return f'<inertial {place} {draw(attitudes())} diaginertia="{numbers(b + c, a + c, a + b)}"/>'
    # A tensor of particles at (d, d, 0) and so on, whose products are within those of the brick.
    d = min(a, b, c) / 2
    return f'<inertial {place} fullinertia="{numbers(b + c + d, a + c + d, a + b + 2 * d, -d, d / 3, 0.0)}"/>'


@st.composite
def models(draw: st.DrawFn) -> str:
    """An MJCF file with a body "torso" in a frame in a body, which has default classes handed down."""
    compiler = " ".join(
        draw(st.sampled_from(choices))
        for choices in (
            ["", 'angle="radian"', 'angle="degree"'],
            ["", 'eulerseq="zxz"', 'eulerseq="XYZ"', 'eulerseq="zYx"'],
            ["", 'inertiafromgeom="true"', 'inertiafromgeom="auto"'],
            ["", 'inertiagrouprange="0 3"'],
        )
    )
    inertial = draw(st.one_of(st.just(""), inertials()))
    solids = "".join(draw(st.lists(geoms(), min_size=0, max_size=3)))
    return f"""
    <mujoco>
      <compiler {compiler}/>
      <default><geom density="700"/>
        <default class="heavy"><geom density="3000"/><default class="other"><geom group="4" rgba="1 0 0 1"/></default></default>
      </default>
      <worldbody>
        <body name="base" childclass="{draw(st.sampled_from(["heavy", "other", "main"]))}" pos="1 2 3">
          <frame euler="10 20 30">
            <body name="torso" {draw(st.sampled_from(["", 'childclass="heavy"']))}>
              <joint type="ball"/>{inertial}<geom type="box" size="0.1 0.2 0.3" pos="0.3 0 0"/>{solids}
            </body>
          </frame>
          <geom size="0.1"/>
        </body>
      </worldbody>
    </mujoco>"""


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(model=models())
def test_a_body_of_mjcf_is_that_of_the_compiler(made: Made, model: str) -> None:
    try:
        expected = compiled(model, "torso")
    except ValueError:  # a body without geoms that have a mass
        with pytest.raises(BadInput, match="no geom with a mass"):
            made(model, "torso")
        return
    assert_same(made(model, "torso"), expected, TOLERANCE)


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(lengths, min_size=4, max_size=4), st.lists(places, min_size=6, max_size=6), st.booleans(), st.booleans())
def test_a_link_of_urdf_is_that_of_both_readers(
    made: Made, sizes: list[float], pose: list[float], placed: bool, turned: bool
) -> None:
    a, b, c = (size**2 for size in sizes[:3])
    d = min(a, b, c) / 2
    origin = " ".join(
        f'{key}="{numbers(*values)}"' for key, values, there in (("xyz", pose[:3], placed), ("rpy", pose[3:], turned)) if there
    )
    model = f"""
    <robot name="arm">
      <link name="base"/>
      <link name="torso">
        <inertial>{f"<origin {origin}/>" if origin else ""}<mass value="{sizes[3]!r}"/>
          <inertia ixx="{b + c + d!r}" iyy="{a + c + d!r}" izz="{a + b + 2 * d!r}" ixy="{-d!r}" ixz="{d / 3!r}" iyz="0"/>
        </inertial>
      </link>
      <joint name="turn" type="continuous"><parent link="base"/><child link="torso"/><axis xyz="0 0 1"/></joint>
    </robot>"""
    found = made(model, "torso")
    assert_same(found, read_by_pinocchio(model), ROUNDING)
    assert_same(found, compiled(model, "torso"), TOLERANCE)


SHAPES = {
    '<geom type="box" size="0.1 0.2 0.3"/>': Brick((0.1, 0.2, 0.3)),
    '<geom type="ellipsoid" size="0.1 0.2 0.3"/>': Ellipsoid((0.1, 0.2, 0.3)),
    '<geom type="cylinder" size="0.1 0.2"/>': Cylinder(0.1, 0.2),
    '<geom size="0.1" euler="10 20 30"/>': Sphere(0.1),
    '<geom type="capsule" size="0.1 0.2"/>': None,
    '<geom type="box" size="0.1 0.2 0.3" euler="0 0 5"/>': None,
    '<inertial pos="0 0 0.1" mass="1" diaginertia="1 1 1"/><geom type="box" size="0.1 0.2 0.3"/>': None,
    '<geom type="box" size="0.1 0.2 0.3"/><geom size="0.1"/>': None,
}


@pytest.mark.parametrize("inside", SHAPES)
def test_a_shape_is_one_about_the_centre_of_mass_and_along_the_axes(made: Made, inside: str) -> None:
    model = f'<mujoco><worldbody><body name="a">{inside}</body></worldbody></mujoco>'
    body, _ = made(model, "a")
    assert body.shape == SHAPES[inside]


@pytest.mark.parametrize(
    ("solid", "shape"),
    [
        ('<box size="0.2 0.4 0.6"/>', Brick((0.1, 0.2, 0.3))),
        ('<cylinder radius="0.1" length="0.4"/>', Cylinder(0.1, 0.2)),
        ('<sphere radius="0.1"/>', Sphere(0.1)),
        ('<mesh filename="package://robot/torso.stl"/>', None),
    ],
)
def test_the_shape_of_a_link_is_that_of_its_collision(made: Made, solid: str, shape: object) -> None:
    model = f"""<robot name="r"><link name="a">
      <inertial><origin xyz="0 0 1"/><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><origin xyz="0 0 1"/><geometry>{solid}</geometry></collision></link></robot>"""
    body, _ = made(model, "a")
    assert body.shape == shape
