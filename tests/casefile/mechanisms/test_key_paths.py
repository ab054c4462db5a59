"""Numbers of mechanisms that are drawn for ensembles, and the axes along which mechanisms are varied."""

import json
import math
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck import Case, CaseFaults
from bodycheck.casefile.axes import AXES
from bodycheck.casefile.case import parse
from bodycheck.casefile.drawn import member_document, wholes
from bodycheck.casefile.key_paths import find, keys
from bodycheck.casefile.toml_text import written
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.start import frames
from bodycheck.reference.scene import Brick
from tests.support.mechanism_texts import ALL_JOINTS, CART_POLE, FOUR_BAR


def drawing(text: str, **variation: object) -> str:
    lines = "\n".join(f"{key} = {value}" for key, value in variation.items())
    return f"{text}\n[ensemble]\nmembers = 4\n[[ensemble.vary]]\n{lines}\n"


@pytest.mark.parametrize("key", ["joints.pin.damping", "joints.1.damping"])
def test_a_number_of_a_joint_is_drawn_by_name_or_number(key: str) -> None:
    case = parse(drawing(CART_POLE, key=f'"{key}"', distribution='"uniform"', low=0.0, high=0.1), "f")
    assert case.ensemble is not None
    (variation,) = case.ensemble.vary
    assert (variation.key.text, variation.key.whole) == ("joints.pin.damping", ("joints", 1, "damping"))


@pytest.mark.parametrize(
    ("key", "whole"),
    [
        ("controllers.pin.kp", ("controllers", 0, "kp")),
        ("controllers.0.rate", ("controllers", 0, "rate")),
        ("controllers.pin.target.amplitude", ("controllers", 0, "target", "amplitude")),
    ],
)
def test_a_number_of_a_controller_is_drawn_by_its_joint_or_number(key: str, whole: tuple[str | int, ...]) -> None:
    table = '[[controllers]]\njoint = "pin"\nlaw = "pd"\nkp = 2.0\nrate = 100.0\n'
    signal = "target = {amplitude = 0.5, angular_frequency = 3.0}\n"
    text = drawing(f"{CART_POLE}\n{table}{signal}", key=f'"{key}"', distribution='"uniform"', low=1.0, high=3.0)
    case = parse(text, "f")
    assert case.ensemble is not None
    (variation,) = case.ensemble.vary
    assert (variation.key.text, variation.key.whole) == (key.replace(".0.", ".pin."), whole)


@pytest.mark.parametrize(
    ("name", "paths"),
    [
        ("8", ["joints.'8'.damping", 'joints."8".damping', "joints.1.damping"]),
        ("left hip", ['joints."left hip".damping', "joints.'left hip'.damping"]),
        ("hüfte", ['joints."hüfte".damping', 'joints."h\\u00fcfte".damping']),
        ('say "a.b"', ["joints.'say \"a.b\"'.damping", 'joints."say \\"a.b\\"".damping']),
        ("a.b", ["joints.a.b.damping", 'joints."a.b".damping', "joints.'a.b'.damping"]),
        ("a.0", ["joints.a.0.damping"]),
    ],
)
def test_a_name_may_be_any_text_and_is_quoted_in_paths(name: str, paths: list[str]) -> None:
    text = CART_POLE.replace('name = "pin"', f"name = {json.dumps(name)}")
    for path in paths:
        case = parse(drawing(text, key=json.dumps(path), distribution='"uniform"', low=0.0, high=0.1), "f")
        assert case.ensemble is not None
        (variation,) = case.ensemble.vary
        assert variation.key.whole == ("joints", 1, "damping"), path
    document = tomllib.loads(text)
    assert parse(written(document), "written").scene == parse(text, "f").scene
    assert all(find(key, document) is not None for key, value in keys(document).items() if len(value.shape) < 2)


@settings(max_examples=40)
@given(st.text(min_size=1, max_size=100).filter(str.isprintable))
def test_any_printable_name_leads_back_to_its_joint(name: str) -> None:
    document = tomllib.loads(CART_POLE)
    document["joints"][1]["name"] = name if name != document["joints"][0]["name"] else f"{name}2"[:100]
    assert tomllib.loads(written(document)) == document
    known = keys(document)
    for key in (key for key in known.values() if key.whole[:2] == ("joints", 1) and not key.shape):
        assert find(key.text, document, known) is key


def test_a_number_that_is_not_quoted_counts() -> None:
    text = CART_POLE.replace('name = "pin"', 'name = "0"')
    case = parse(drawing(text, key='"joints.0.damping"', distribution='"uniform"', low=0.0, high=0.1), "f")
    assert case.ensemble is not None
    assert case.ensemble.vary[0].key.whole == ("joints", 0, "damping")


def test_every_number_of_a_mechanism_can_be_drawn() -> None:
    """Each key leads back to itself; a member has the drawn number where the key says, and is a case."""
    document = tomllib.loads(ALL_JOINTS)
    known = keys(document)
    assert {"bodies.brick.semi_axes", "joints.float.initial.linear", "bodies.parts.parts.0.mass", "scene.gravity"} <= set(known)
    assert "bodies.parts.center_of_mass" not in known, "it follows from the parts"
    assert all(find(text, document, known) is key for text, key in known.items() if len(key.shape) < 2)
    values = {
        "joints.hinge.friction": np.array([0.5]),
        "joints.slide.initial.velocity": np.array([2.0]),
        "joints.ball.initial.quaternion": np.array([[3.0, 0.0, 4.0, 0.0]]),
        "bodies.satellite.initial.angular_velocity": np.array([[1.0, 2.0, 3.0]]),
        "bodies.hub.center_of_mass.2": np.array([0.25]),
    }
    made = member_document(document, wholes(document, values), 0, 7)
    scene = parse(written(made), "member").scene
    assert isinstance(scene, Mechanism)
    bodies, joints = {body.name: body for body in scene.bodies}, {joint.name: joint for joint in scene.joints}
    assert (joints["hinge"].friction, joints["slide"].start_velocity, joints["ball"].start) == (
        0.5,
        (2.0,),
        (0.6, 0.0, 0.8, 0.0),
    )
    assert (start := bodies["satellite"].start) is not None
    assert start.rotation == (1.0, 2.0, 3.0), "instead of the rates of Euler angles"
    assert nearest_inertia(bodies["hub"]).centre == (0.0, 0.0, 0.25)


@pytest.mark.parametrize(
    ("variation", "words"),
    [
        (
            {"key": '"joints.pni.damping"', "distribution": '"uniform"', "low": 0, "high": 1},
            "did you mean 'joints.pin.damping'?",
        ),
        ({"key": '"joints.2.damping"', "distribution": '"uniform"', "low": 0, "high": 1}, "no number or vector of this path"),
        ({"key": '"joints.pin.damping"', "distribution": '"uniform"', "low": -1, "high": 1}, "draws negative numbers"),
        ({"key": '"joints.pin.type"', "distribution": '"uniform"', "low": 0, "high": 1}, "no number or vector of this path"),
        ({"distribution": '"attitude"'}, "draws the attitude of one body"),
    ],
)
def test_what_cannot_be_drawn(variation: dict[str, object], words: str) -> None:
    with pytest.raises(CaseFaults, match=words.replace("?", r"\?")):
        parse(drawing(CART_POLE, **variation), "f")


def varied(text: str, axis: str, value: float) -> Mechanism:
    made = AXES[axis].varied(parse(text, "f"), value).scene
    assert isinstance(made, Mechanism)
    return made


def gaps(mechanism: Mechanism) -> tuple[float, float]:
    """How far apart the points of the first loop are (m), and how fast they part (m/s)."""
    at, loop = frames(mechanism), mechanism.loops[0]
    (one, other), (here, there) = (at[body] for body in loop.bodies), (np.array(point) for point in loop.points)
    return (
        float(np.abs(one.point(here) - other.point(there)).max()),
        float(np.abs(one.speed(here) - other.speed(there)).max()),
    )


def test_a_mechanism_keeps_its_form_along_every_axis() -> None:
    at = frames(parse(FOUR_BAR, "f").scene)  # type: ignore[arg-type]
    for axis, value in (("size", 100.0), ("mass", 7.0), ("distance", 1e3), ("gravity", 1.0), ("spin", 50.0)):
        made = varied(FOUR_BAR, axis, value)
        # Roundings of lengths up to the distance, and of speeds up to the spin times the size.
        assert max(gaps(made)) < 1e-12, axis
        scale = value if axis == "size" else 1.0
        shift = value if axis == "distance" else 0.0
        want = at[1].origin * scale + [shift, 0, 0]
        np.testing.assert_allclose(frames(made)[1].origin.astype(float), want.astype(float), rtol=1e-15)


def test_sizes_masses_and_speeds_are_those_of_the_axes() -> None:
    heavy, large = varied(ALL_JOINTS, "mass", 7e3), varied(ALL_JOINTS, "size", 10.0)
    assert sum(nearest_inertia(body).mass for body in heavy.bodies) == pytest.approx(7e3, rel=1e-14)  # eight roundings
    was = parse(ALL_JOINTS, "f").scene
    assert isinstance(was, Mechanism)
    for before, after in zip(was.bodies, large.bodies, strict=True):
        small, grown = nearest_inertia(before), nearest_inertia(after)
        # Some roundings of the factors of lengths and masses.
        np.testing.assert_allclose(grown.tensor, np.array(small.tensor) * 1e5, rtol=1e-14, atol=1e-14)
        np.testing.assert_allclose(grown.centre, np.array(small.centre) * 10, rtol=1e-14)
    assert getattr(large.bodies[0].inertia, "shape", None) == Brick((1.0, 2.0, 3.0))
    fast = varied(ALL_JOINTS, "speed", 10.0)
    # The fastest is the planar joint, with sqrt(2) m/s; all others in proportion.
    assert math.hypot(*fast.joints[2].start_velocity[:2]) == pytest.approx(10.0, rel=1e-15)
    assert fast.joints[0].start_velocity[1] == pytest.approx(2.0 * 10 / math.sqrt(2), rel=1e-15)
    assert math.hypot(*varied(ALL_JOINTS, "spin", 3.0).joints[0].start_velocity) == pytest.approx(3.0, rel=1e-15)


@pytest.mark.parametrize(
    ("axis", "words"),
    [
        ("separatrix", "only of one body, not of a mechanism"),
        ("friction", "only of one body, not of a mechanism"),
        ("spin", "no joint or free body has an angular velocity"),
    ],
)
def test_axes_that_a_mechanism_has_not(axis: str, words: str) -> None:
    with pytest.raises(CaseFaults, match=words):
        parse(CART_POLE + f"[extremes]\n{axis} = [0.5]\n", "f")


def test_axes_of_the_run_leave_the_mechanism_as_it_is() -> None:
    case: Case = parse(CART_POLE + "[extremes]\nsteps = [10]\ntimestep = [0.01]\n", "f")
    longer = AXES["steps"].varied(case, 10.0)
    assert (longer.duration, longer.scene) == (0.02, case.scene)
