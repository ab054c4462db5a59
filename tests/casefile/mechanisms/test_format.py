"""Case files of format 2: what they make, and that every fault is told where it stands."""

import pytest

from bodycheck import CaseFaults
from bodycheck.casefile.case import parse
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.mechanisms.start import coordinates
from bodycheck.reference.scene import Brick, EulerAngles, EulerRates, Particle, Solid, Sphere, Tensor
from tests.support.mechanism_texts import ALL_JOINTS, CART_POLE, FOUR_BAR


def faults(text: str) -> dict[str, str]:
    with pytest.raises(CaseFaults) as caught:
        parse(text, "f")
    return {f"{fault.position.line if fault.position else 0} {fault.key}": fault.message for fault in caught.value.faults}


def mechanism(text: str) -> Mechanism:
    scene = parse(text, "f").scene
    assert isinstance(scene, Mechanism)
    return scene


def test_a_cart_and_a_pole() -> None:
    """The numbers of the file are those of the mechanism, to the last bit."""
    cart = JointedBody("cart", Tensor(2.3, ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1))))
    rod = Tensor(0.4, ((0.016, 0.0, 0.0), (0.0, 0.017, 0.0), (0.0, 0.0, 0.001)))
    rail = Joint("rail", "prismatic", WORLD, 0, axis=(1.0, 0.0, 0.0), start=(0.0,), start_velocity=(0.5,))
    pin = Joint("pin", "revolute", 0, 1, (0.0, 0.0, 0.1), axis=(0.0, 1.0, 0.0), start=(0.3,), start_velocity=(0.0,))
    assert mechanism(CART_POLE) == Mechanism((cart, JointedBody("pole", rod, (0.0, 0.0, 0.35))), (rail, pin), (), 9.81)


def test_every_joint_and_every_inertia() -> None:
    made = mechanism(ALL_JOINTS)
    bodies, joints = {body.name: body for body in made.bodies}, {joint.name: joint for joint in made.joints}
    assert bodies["brick"].inertia == Solid(Brick((0.1, 0.2, 0.3)), 1.0, (0.0, 0.0, -0.3))
    assert bodies["particles"].inertia == (Particle(1.0, (0.0, 0.0, 1.0)), Particle(1.0, (0.0, 1.0, 0.0)))
    assert nearest_inertia(bodies["parts"]).mass == 3.0
    assert nearest_inertia(bodies["parts"]).centre == (0.5 / 3, 0.0, 0.0)
    assert bodies["hub"].inertia == Solid(Sphere(0.2), 3.0)
    start = BodyStart((5.0, 0.0, 1.0), EulerAngles(0.1, 0.2, 0.3), (0.0, 1.0, 0.0), EulerRates(0.0, 0.1, 1.0))
    assert bodies["satellite"].start == start
    assert [body.start for body in made.bodies if body.name != "satellite"] == [None] * 7
    assert (joints["universal"].start, joints["universal"].start_velocity) == ((0.2, -0.4), (1.0, 2.0))
    assert (joints["ball"].start, joints["ball"].start_velocity) == ((0.6, 0.0, 0.8, 0.0), (0.1, 0.2, 0.3))
    assert joints["ball"].damping == 0.01
    assert (joints["sheet"].start, joints["sheet"].attitude) == ((0.1, 0.2, 0.3), EulerAngles(0.0, 0.5, 0.0))
    assert joints["float"].start == (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    assert joints["float"].start_velocity == (0.5, 0.0, 0.0, 0.0, 0.0, 1.0)
    assert (joints["weld"].start, joints["weld"].parent) == ((), 3)
    slide = joints["slide"]
    assert (slide.armature, slide.damping, slide.stiffness, slide.rest, slide.effort) == (0.2, 0.5, 10.0, 0.1, -0.3)


CENTRE = "center_of_mass = [0.0, 0.0, 0.35]"


def test_what_a_file_leaves_out_is_zero() -> None:
    text = CART_POLE.replace("initial = {position = 0.0, velocity = 0.5}\n", "").replace("[scene]\ngravity = 9.81\n", "")
    made = mechanism(text)
    assert (made.joints[0].start, made.joints[0].start_velocity, made.gravity) == ((0.0,), (0.0,), 0.0)
    free = text[: text.index("[[joints]]")] + text[text.index("[run]") :]
    assert [body.start for body in mechanism(free).bodies] == [BodyStart()] * 2


#: A case with a fault in nearly every line.
FAULTY = """\
format = 2
name = "faulty"
title = "Much is wrong"
body = 1
[[bodies]]
name = "a"
mass = -1.0
inertia = [1.0, 1.0, 5.0]
[bodies.initial]
velocity = [1.0, 0.0, 0.0]
[[bodies]]
name = "a"
shape = "spher"
[[bodies]]
name = "b"
particles = [{mass = 1.0, position = [0, 0, 1]}]
center_of_mass = [0, 0, 1]
[[bodies]]
name = "world"
mass = 1.0
inertia = [1, 1, 1]
[[joints]]
name = "one"
type = "revolute"
parent = "c"
child = "a"
axis = [0, 0, 0]
[[joints]]
name = "two"
type = "spherical"
child = "a"
armature = 1.0
initial = {position = 1.0}
[[joints]]
name = "two"
type = "hinge"
child = "bb"
[[joints]]
name = "four"
type = "fixed"
child = "world"
quaternion = [2, 0, 0, 0]
euler_zxz = [0, 0, 0]
[[joints]]
name = "five"
type = "prismatic"
parent = "b"
child = "b"
damping = -1.0
[[loops]]
bodies = ["a", "x"]
points = [[0, 0, 0], [0, 0]]
[[loops]]
bodies = ["b", "b"]
points = [[0, 0, 0], [0, 0, 0]]
[scene.plane]
friction = 0.5
[run]
duration = 4.0
"""


def test_all_faults_at_once_each_with_its_line() -> None:
    assert set(faults(FAULTY)) == {
        *("4 body", "7 bodies[1].mass", "8 bodies[1].inertia", "9 bodies[1].initial", "12 bodies[2].name"),
        *("13 bodies[2].shape", "17 bodies[3].center_of_mass", "19 bodies[4].name"),
        *("25 joints[1].parent", "27 joints[1].axis", "31 joints[2].child", "32 joints[2].armature"),
        *("33 joints[2].initial.position", "35 joints[3].name", "36 joints[3].type", "37 joints[3].child"),
        *("41 joints[4].child", "42 joints[4].quaternion", "47 joints[5].parent"),
        *("44 joints[5].axis", "49 joints[5].damping", "51 loops[1].bodies[2]", "52 loops[1].points[2][3]"),
        *("54 loops[2].bodies", "56 scene.plane", "58 run.samples"),
    }


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("format = 2", "format = 3", "1 format", "allowed: 1 for one body, 2 for a mechanism"),
        ('child = "pole"', 'child = "pol"', "27 joints[2].child", "allowed: cart, pole; did you mean 'pole'?"),
        ('child = "pole"', 'child = "cart"', "27 joints[2].child", "is the child of joint 1, rail, too"),
        ('child = "cart"', 'child = "cart"\nparent = "pole"', "20 joints[1].parent", "circle: cart <- pole <- cart"),
        ('child = "pole"', 'child = "pole"\nstiffnes = 1.0', "28 joints[2].stiffnes", "did you mean 'stiffness'?"),
        ('name = "pin"', 'name = ""', "24 joints[2].name", "should have at least 1 character"),
        ('name = "pin"', 'name = "p\\nin"', "24 joints[2].name", "should be printable, on one line"),
        ("axis = [0.0, 1.0, 0.0]\n", "", "23 joints[2].axis", "is missing"),
        ("mass = 0.4\n", "", "10 bodies[2].mass", "is missing"),
        ("mass = 0.4\n", "mass = 1e200\n", "12 bodies[2].mass", "less than or equal to 1e100"),
        ("inertia = [0.016, 0.017, 0.001]", "inertia = [0.016, 0.017, -0.001]", "14 bodies[2].inertia[3]", "greater than"),
        ("inertia = [0.016, 0.017, 0.001]", "inertia = [0, 0, 0.001]", "14 bodies[2].inertia", "no body has these moments"),
        (f"{CENTRE}\ninertia = [0.016, 0.017, 0.001]", "inertia = [0, 0, 0]", "22 joints[2]", "mass matrix"),
        ('type = "revolute"', 'type = "spherical"', "29 joints[2].axis", "unknown key; allowed: name, parent"),
        ("position = [0.0, 0.0, 0.1]", "position = [0.0, 0.0, 1e40]", "23 joints[2]", "their ratio may be at most 1e+60"),
        ("velocity = 0.5", "velocity = 1e99", "5 bodies", "its kinetic energy at the start is 1.35e+198 J"),
    ],
)  # fmt: skip
def test_a_fault_tells_what_is_allowed(old: str, new: str, place: str, words: str) -> None:
    assert old in CART_POLE
    told = faults(CART_POLE.replace(old, new))
    assert words in told.get(place, ""), told


def test_point_masses_are_allowed_where_joints_hold_them() -> None:
    """A point mass on a hinge away from it is determined; on a ball joint its turn about the rod is not."""
    rod = CART_POLE.replace("inertia = [0.016, 0.017, 0.001]", "inertia = [0, 0, 0]")
    pin = coordinates(mechanism(rod))[-1]
    assert float(pin.locked) == pytest.approx(0.4 * 0.35**2, rel=1e-15)
    assert pin.loose == pin.locked, "no joint is behind it"
    ball = rod.replace('type = "revolute"', 'type = "spherical"').replace("axis = [0.0, 1.0, 0.0]\narmature", "armature")
    for key in ("armature", "stiffness", "rest", "friction", "effort"):
        ball = ball.replace(f"{key} = 0.0\n", "")
    assert "mass matrix" in faults(ball.replace("initial = {position = 0.3, velocity = 0.0}\n", ""))["23 joints[2]"]
    free = "inertia = [0, 0, 0]\n\n[run]\nduration = 1.0\nsamples = 2\n"
    text = rod[: rod.index("inertia = [0, 0, 0]")] + free
    assert "has no moment of inertia" in faults(text)["10 bodies[2]"]


def test_a_loop_must_close_and_stay_closed() -> None:
    assert mechanism(FOUR_BAR).loops[0].bodies == (1, 2)
    (told,) = faults(FOUR_BAR.replace("[0, 0, 1]]}]", "[0, 0, 1.1]]}]")).values()
    assert told.startswith("does not close at the start: its points are 0.1 m apart, at [1.29552, 0, 0.955336] and [1.32507, ")
    (told,) = faults(FOUR_BAR.replace("{position = -0.3, velocity = -1.0}", "{position = -0.3}")).values()
    assert told.startswith("does not stay closed: its points part with 1 m/s at the start")
