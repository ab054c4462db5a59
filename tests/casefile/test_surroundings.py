"""Planes, contacts between pairs, and pushes, in files of both formats."""

import math

import numpy as np
import pytest

from bodycheck.casefile.case import Case, CaseFaults, parse
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.planar import planar_state
from bodycheck.reference.scene import Push, Scene
from bodycheck.running.simulation import simulate
from bodycheck.running.truths import truth

HEAD = 'name = "ramp"\ntitle = "A ramp"\n[run]\nduration = 1.0\nsamples = 3\n'
BLOCK = f'format = 1\n{HEAD}[body]\nshape = "brick"\nmass = 2.0\nsemi_axes = [0.1, 0.2, 0.3]\n'
PAIR = "".join(
    f'[[bodies]]\nname = "{name}"\nshape = "sphere"\nradius = 0.5\nmass = 1.0\n' for name in ("ball-1", "ball-2", "box")
)
BALLS = f"format = 2\n{HEAD}{PAIR}"


NO_COEFFICIENT = "says nothing without a coefficient; give rolling_friction or torsional_friction"


def read(text: str) -> Case:
    return parse(text, "ramp.case.toml")


def body(text: str) -> Scene:
    scene = read(BLOCK + text).scene
    assert isinstance(scene, Scene)
    return scene


def bodies(text: str) -> Mechanism:
    scene = read(BALLS + text).scene
    assert isinstance(scene, Mechanism)
    return scene


def faults(text: str) -> list[str]:
    with pytest.raises(CaseFaults) as refused:
        read(text)
    return [f"{fault.key}: {fault.message}" for fault in refused.value.faults]


def test_a_body_lies_on_an_inclined_plane_at_the_origin_by_default() -> None:
    scene = body("[scene.plane]\nincline = 0.3\nfriction = 0.5\n")
    normal = math.sin(0.3), 0.0, math.cos(0.3)
    assert scene.plane is not None
    assert scene.plane.normal == normal
    assert scene.initial.position == pytest.approx([0.3 * part for part in normal], abs=1e-16)
    # The axis K is along the normal, and I points downhill.
    downhill, _, up = rotate(np.array(scene.initial.quaternion), np.eye(3))
    assert up == pytest.approx(normal, abs=1e-15)
    assert downhill == pytest.approx([math.cos(0.3), 0, -math.sin(0.3)], abs=1e-15)
    assert planar_state(scene) == pytest.approx([0.0] * 6, abs=1e-16)


@pytest.mark.parametrize(
    ("shape", "height"),
    [
        ('shape = "sphere"\nradius = 0.5', 0.5),
        ('shape = "ellipsoid"\nsemi_axes = [0.1, 0.2, 0.3]', 0.3),
        ('shape = "cylinder"\nradius = 0.5\nhalf_length = 0.2', 0.2),
    ],
)
def test_any_shape_lies_on_the_plane_by_default(shape: str, height: float) -> None:
    scene = read(f"format = 1\n{HEAD}[scene.plane]\n[body]\nmass = 1.0\n{shape}\n").scene
    assert isinstance(scene, Scene)
    assert scene.initial.position == (0.0, 0.0, height)


def test_a_tilted_body_touches_the_plane_by_default() -> None:
    scene = body("[scene.plane]\n[initial]\neuler_zxz = [0.0, 0.5, 0.0]\n")
    assert scene.initial.position == pytest.approx([0.0, 0.0, 0.2 * math.sin(0.5) + 0.3 * math.cos(0.5)], abs=1e-15)


@pytest.mark.parametrize("incline", [0.0, 0.1, 0.3, 0.7853981633974483, 1.1, 1.5])
@pytest.mark.parametrize("head", ["format = 1\n[body]\n", 'format = 2\n[[bodies]]\nname = "plate"\n'])
def test_the_default_pose_is_rounded_once(head: str, incline: float) -> None:
    """A flat plate has a height that the rounding of its attitude, times its width, exceeds."""
    shape = 'shape = "brick"\nmass = 1.0\nsemi_axes = [1.0, 1.0, 0.01]\n'
    plane = f"[scene]\ngravity = 9.81\n[scene.plane]\nincline = {incline!r}\nfriction = 0.5\n"
    format_line, heading = head.split("\n", 1)
    scene = read(f"{format_line}\n{HEAD}{heading}{shape}{plane}").scene
    start = scene.bodies[0].start if isinstance(scene, Mechanism) else scene.initial
    assert start is not None
    cosine, sine = MP.cos_sin(MP.mpf(incline))
    height = MP.mpf(0.01)
    assert start.position == (float(height * sine), 0.0, float(height * cosine))
    (flat,) = problem(scene).bodies
    assert flat.quaternion.tolist() == [1, 0, 0, 0]
    # The position is the one number of the pose that is rounded to doubles, each component by at most half an ulp.
    assert abs(flat.position[2] - np.longdouble(0.01)) <= 0.01 * np.finfo(float).eps


def test_the_default_height_follows_from_euler_angles_to_all_digits() -> None:
    """Half a turn of pi / 2, as rounded to a double, tilts the plate by 6e-17 rad."""
    plane = "[scene.plane]\nincline = 0.3\nfriction = 0.5\n[initial]\neuler_zxz = [0.4, 1.5707963267948966, 0.2]\n"
    scene = body(plane)
    theta, phi, psi = MP.mpf(1.5707963267948966), MP.mpf(0.4), MP.mpf(0.2)
    cosine, sine = MP.cos_sin(MP.mpf(0.3))
    across = sine * MP.cos(phi), -sine * MP.sin(phi)
    tilted = across[1] * MP.cos(theta) + cosine * MP.sin(theta), -across[1] * MP.sin(theta) + cosine * MP.cos(theta)
    along = across[0] * MP.cos(psi) + tilted[0] * MP.sin(psi), -across[0] * MP.sin(psi) + tilted[0] * MP.cos(psi)
    height = sum(abs(part) * MP.mpf(half) for part, half in zip((*along, tilted[1]), (0.1, 0.2, 0.3), strict=True))
    assert scene.initial.position == (float(height * sine), 0.0, float(height * cosine))


def test_what_a_pair_says_counts_for_the_only_body() -> None:
    scene = body('[scene.plane]\nfriction = "no-slip"\n[[scene.contacts]]\nbodies = ["plane", "body"]\nrestitution = 0.5\n')
    assert scene.plane is not None
    assert (scene.plane.friction, scene.plane.restitution) == (math.inf, 0.5)


def test_pairs_are_named_by_patterns_and_the_last_counts() -> None:
    text = """[scene.plane]
friction = 0.4
[[scene.contacts]]
bodies = ["ball-*", "*"]
friction = 0.8
[[scene.contacts]]
bodies = ["ball-2", "box"]
restitution = 1.0
[[scene.contacts]]
bodies = ["box", "plane"]
friction = 0.4
"""
    assert bodies(text).contacts == (
        PairContact((0, 1), 0.8, 0.0),
        PairContact((0, 2), 0.8, 0.0),
        PairContact((1, 2), 0.4, 1.0),
    )
    assert bodies(
        text.replace('bodies = ["box", "plane"]\nfriction = 0.4', 'bodies = ["box", "plane"]\nfriction = 0.1')
    ).contacts[0] == PairContact((WORLD, 2), 0.1, 0.0)


def test_a_pair_takes_over_what_it_does_not_state() -> None:
    text = """[scene.plane]
friction = 0.4
rolling_friction = 0.01
[[scene.contacts]]
bodies = ["box", "plane"]
torsional_friction = 0.02
cone = "one"
"""
    assert bodies(text).contacts == (PairContact((WORLD, 2), 0.4, 0.0, 0.01, 0.02, "one"),)


def test_pushes_have_times_and_bodies() -> None:
    text = "[[scene.push]]\nforce = [1.0, 0.0, 0.0]\n[[scene.push]]\nforce = [0.0, 2.0, 0.0]\npoint = [0.1, 0.0, 0.0]\n"
    timed = f"{text}from = 0.5\nuntil = 0.75\n"
    assert body(timed).pushes == (Push((1.0, 0.0, 0.0)), Push((0.0, 2.0, 0.0), (0.1, 0.0, 0.0), 0.5, 0.75))
    named = text.replace("force", 'body = "box"\nforce')
    assert [push.body for push in bodies(named).pushes] == [2, 2]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("[scene.plane]\nincline = 1.6", "scene.plane.incline: read 1.6; should be less than 1.5707963267948966"),
        ("[scene.plane]\nincline = -0.1", "scene.plane.incline: read -0.1; should be greater than or equal to 0"),
        ("[scene.plane]\nrestitution = 1.1", "scene.plane.restitution: read 1.1; should be less than or equal to 1"),
        ('[scene.plane]\nfriction = "rough"', "scene.plane.friction: read 'rough'; allowed: a number, or 'no-slip'"),
        ("[[scene.push]]\npoint = [0.0, 0.0, 0.0]", "scene.push[1].force: is missing"),
        (
            "[[scene.push]]\nforce = [1.0, 0.0, 0.0]\nfrom = 1.0\nuntil = 1.0",
            "scene.push[1].until: read 1.0; must be later than from",
        ),
        (
            '[[scene.contacts]]\nbodies = ["plane", "body"]\nfriction = 0.1',
            "scene.contacts[1]: nothing touches without a plane; give [scene.plane]",
        ),
        (
            '[scene.plane]\n[[scene.contacts]]\nbodies = ["plane", "boddy"]\nfriction = 0.1',
            "scene.contacts[1].bodies[2]: read 'boddy'; there is no such body; allowed: plane, body; did you mean 'body'?",
        ),
        (
            '[scene.plane]\n[[scene.contacts]]\nbodies = ["plane", "plane"]\nfriction = 0.1',
            "scene.contacts[1].bodies: read ['plane', 'plane']; a contact is of two different bodies",
        ),
        (
            '[scene.plane]\n[[scene.contacts]]\nbodies = ["plane", "body"]',
            "scene.contacts[1]: says nothing; give any of friction, restitution, rolling_friction, torsional_friction, cone",
        ),
        ('[scene.plane]\ncone = "one"', f"scene.plane.cone: read 'one'; {NO_COEFFICIENT}"),
        (
            '[scene.plane]\n[[scene.contacts]]\nbodies = ["plane", "body"]\ncone = "product"',
            f"scene.contacts[1].cone: read 'product'; {NO_COEFFICIENT}",
        ),
        (
            '[scene.plane]\nfriction = "no-slip"\nrolling_friction = 0.1\ncone = "one"',
            "scene.plane.cone: read 'one'; one limit for friction and moments needs a coefficient of friction; "
            "allowed with no-slip: product",
        ),
    ],
)
def test_a_fault_is_told(text: str, fault: str) -> None:
    assert faults(BLOCK + text) == [fault]


def test_bodies_on_joints_have_no_plane() -> None:
    text = '[scene.plane]\n[[joints]]\nname = "pin"\ntype = "spherical"\nchild = "box"\n'
    assert faults(BALLS + text) == ["scene.plane: bodies on joints touch no plane; allowed: a plane, or joints"]


def test_a_push_on_several_bodies_names_one() -> None:
    assert faults(f"{BALLS}[[scene.push]]\nforce = [1.0, 0.0, 0.0]\n") == [
        "scene.push[1].body: is missing; allowed: ball-1, ball-2, box"
    ]


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        (f"{BLOCK}[[scene.push]]\nforce = [1.0, 0.0, 0.0]\n", "pushes on what touches nothing"),
        (f'{BALLS}[[scene.push]]\nbody = "box"\nforce = [1.0, 0.0, 0.0]\n', "pushes on what touches nothing"),
        (
            f'format = 1\n{HEAD}[scene.plane]\n[body]\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\nshape = "none"\n',
            "without a shape",
        ),
    ],
)
def test_what_the_reference_does_not_model_is_unsupported(text: str, missing: str) -> None:
    outcome = simulate(read(text), "mujoco", "Euler").outcome
    assert missing in getattr(outcome, "reason", "")
    with pytest.raises(NotModelled, match=missing):
        truth(read(text))


@pytest.mark.parametrize(
    ("first", "told"),
    [
        ("b\\u001b[31mox", "should be printable, on one line"),
        ("b[oa]x", "there is no such body; allowed: plane, ball-1, ball-2, box; did you mean 'box'?"),
        ("b?x", "there is no such body; allowed: plane, ball-1, ball-2, box; did you mean 'box'?"),
        ("a" * 10_000, "allowed: at most 100 characters"),
        ("bax", "there is no such body; allowed: plane, ball-1, ball-2, box; did you mean 'box'?"),
    ],
)
def test_a_name_that_no_body_has_is_one_fault(first: str, told: str) -> None:
    contact = f'[scene.plane]\n[[scene.contacts]]\nbodies = ["{first}", "plane"]\nfriction = 0.5\n'
    with pytest.raises(CaseFaults) as refused:
        read(BALLS + contact)
    (fault,) = refused.value.faults
    assert (fault.key, fault.message.partition("; ")[2] or fault.message) == ("scene.contacts[1].bodies[1]", told)


@pytest.mark.parametrize("contact", ["", '[scene.plane]\n[[scene.contacts]]\nbodies = ["ball-1", "plane"]\nfriction = 0.5\n'])
def test_no_body_has_the_name_of_the_plane(contact: str) -> None:
    with pytest.raises(CaseFaults) as refused:
        read(BALLS.replace('"box"', '"plane"') + contact)
    (fault,) = refused.value.faults
    assert (fault.key, fault.message) == ("bodies[3].name", "read 'plane'; is the name of the plane; give the body another one")


def test_pairs_touch_without_a_plane_and_then_say_all() -> None:
    pair = '[[scene.contacts]]\nbodies = ["ball-*", "box"]\nfriction = "no-slip"\nrestitution = 0.5\n'
    assert bodies(pair).contacts == (PairContact((0, 2), math.inf, 0.5), PairContact((1, 2), math.inf, 0.5))
    assert bodies(pair).plane is None
    assert faults(BALLS + '[[scene.contacts]]\nbodies = ["ball-1", "ball-2"]\nfriction = 0.5\n') == [
        "scene.contacts[1].restitution: is missing; without a plane it has no default"
    ]
    assert faults(BALLS + pair.replace('"box"', '"plane"')) == [
        "scene.contacts[1].bodies[2]: read 'plane'; there is no such body; allowed: ball-1, ball-2, box"
    ]


def joint(child: str, kind: str = "prismatic") -> str:
    axis = "axis = [1.0, 0.0, 0.0]\n" if kind == "prismatic" else ""
    return f'[[joints]]\nname = "of {child}"\ntype = "{kind}"\nchild = "{child}"\n{axis}'


def test_a_body_on_a_prismatic_joint_touches_a_free_one() -> None:
    pair = '[[scene.contacts]]\nbodies = ["ball-*", "box"]\nfriction = 0.5\nrestitution = 0.0\n'
    scene = bodies(pair + joint("ball-1") + joint("ball-2"))
    assert [contact.bodies for contact in scene.contacts] == [(0, 2), (1, 2)]


@pytest.mark.parametrize(
    ("pair", "joints", "fault"),
    [
        (
            '["ball-1", "box"]',
            joint("box", "spherical"),
            "box is on a joint of the type spherical; allowed: a free body and one on a prismatic joint",
        ),
        (
            '["ball-*", "ball-*"]',
            joint("ball-1") + joint("ball-2"),
            "ball-1 and ball-2 are both on joints; allowed: a free body and one on a prismatic joint",
        ),
    ],
)
def test_other_bodies_on_joints_touch_nothing(pair: str, joints: str, fault: str) -> None:
    contact = f"[[scene.contacts]]\nbodies = {pair}\nfriction = 0.5\nrestitution = 0.0\n"
    (told,) = faults(BALLS + contact + joints)
    assert told.startswith("scene.contacts[1].bodies: ")
    assert fault in told


def test_a_joint_whose_name_is_a_table_is_a_fault_of_its_name() -> None:
    joint = '[[joints]]\nname = {at_most = 1}\ntype = "revolute"\nchild = "box"\naxis = [0.0, 0.0, 1.0]\n'
    follower = (
        '[[joints]]\nname = "pin"\ntype = "revolute"\nchild = "ball-1"\naxis = [0.0, 0.0, 1.0]\nmimic = {joint = "other"}\n'
    )
    reported = faults(BALLS + joint + follower)
    assert any(fault.startswith("joints[1].name:") for fault in reported)
    assert "joints[2].mimic.joint" in "".join(reported)
