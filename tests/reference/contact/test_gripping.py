"""A body between two fingers: limits, closed forms, mechanisms with dry friction that move alike, and the second way."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import bodycheck
from bodycheck.reference.bounds import STATES
from bodycheck.reference.certificate import certify
from bodycheck.reference.contact.gripping import course, way
from bodycheck.reference.contact.gripping.grip import grip_of
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Brick, Solid, Tensor
from bodycheck.reference.sensors.sensor import Sensor
from bodycheck.reference.sensors.truth import sensor_truth
from bodycheck.reference.truth import computed, truth
from bodycheck.reference.truths import Truth
from bodycheck.reference.witness import END, as_way, contradictions, event_distances
from tests.judge import gripping_scenes
from tests.judge.verdicts import judged
from tests.support.grips import BALL, BLOCK, GRAVITY, PAD, POINT, START, grip, with_contacts

TIMES = np.linspace(0.0, 0.2, 9)

#: The seed of a scene that the judge knows, with one cone.
ONE_CONE = 1047

#: A few roundings of numbers of size 1.
ROUNDED = 4e-15


def height(scene: Mechanism, times: Any = TIMES) -> Any:
    """The heights (n,) of the body."""
    return truth(scene, np.asarray(times)).trajectory.position[0, :, 2]


@pytest.mark.parametrize(("body", "finger"), [(BLOCK, POINT), (BLOCK, PAD), (BALL, PAD)])
@pytest.mark.parametrize(("press", "friction"), [(8.0, 0.5), (30.0, 0.1), (30.0, 0.0), (0.0, 0.5)])
def test_a_body_falls_with_gravity_less_twice_the_friction(body: Any, finger: Any, press: float, friction: float) -> None:
    falls = GRAVITY - 2 * friction * press / 2.0
    expected = -falls * TIMES * TIMES / 2
    assert height(grip(press, friction, body=body, finger=finger, mass=2.0)) == pytest.approx(expected, abs=ROUNDED)


@pytest.mark.parametrize("press", [GRAVITY, math.nextafter(GRAVITY, 10), 20.0])
def test_a_body_is_held_up_to_the_limit(press: float) -> None:
    """2 mu N = m g holds; the double below does not."""
    motion = truth(grip(press, 0.5), np.array([0.0, 1e3]))
    assert motion.trajectory.velocity[0, -1].tolist() == [0.0, 0.0, 0.0]
    assert truth(grip(math.nextafter(GRAVITY, 0), 0.5), np.array([0.0, 1.0])).trajectory.velocity[0, -1, 2] < 0


def test_two_spheres_that_hold_a_sphere_hold_it_alone() -> None:
    assert not height(grip(20.0, 0.5, body=BALL, finger=POINT)).any()
    with pytest.raises(NotModelled, match="slips between two spheres"):
        truth(grip(8.0, 0.5, body=BALL, finger=POINT), TIMES)


def test_a_body_without_weight_slides_to_rest_between_its_fingers() -> None:
    scene = grip(10.0, 0.25, velocity=(0.0, 0.0, 0.5), gravity=0.0)
    (event,) = truth(scene, np.linspace(0.0, 0.5, 6)).events
    assert (event.kind, event.time) == ("rest", pytest.approx(0.5 / (2 * 0.25 * 10.0), rel=1e-15))
    assert height(scene, [0.0, 0.5])[-1] == pytest.approx(0.5**2 / (2 * 2 * 0.25 * 10.0), rel=1e-14)


@pytest.mark.parametrize("between", ["linear", "hold"])
def test_the_instant_of_slip_is_that_of_the_force(between: Any) -> None:
    """The force falls from 15 N along a line to the weight over twice the friction of 0.5, or jumps below it."""
    scene = grip(Samples((0.0, 1.0), (15.0, 6.0 if between == "linear" else 5.0), between), 0.5)
    last = 0.9 if between == "linear" else 1.1
    events = truth(scene, np.array([0.0, last])).events
    assert [event.kind for event in events] == ["slip"]
    assert events[0].time == pytest.approx((15.0 - GRAVITY) / 9.0 if between == "linear" else 1.0, rel=1e-15)
    later = last - events[0].time
    fallen = 9.0 * later**3 / 6 if between == "linear" else (GRAVITY - 5.0) * later**2 / 2
    assert height(scene, [0.0, last])[-1] == pytest.approx(-fallen, rel=1e-13)


@settings(max_examples=20, deadline=None)
@given(
    press=st.floats(1.0, 100.0),
    friction=st.floats(0.05, 2.0),
    torsional=st.floats(1e-4, 0.1),
    lever=st.floats(1e-3, 0.045),
    cone=st.sampled_from(["product", "one"]),
)
def test_limits_beside_the_centre_are_those_of_their_formulae(
    press: float, friction: float, torsional: float, lever: float, cone: Any
) -> None:
    whole = grip_of(grip(press, friction, torsional=torsional, cone=cone, aside=(lever, 0.0)))
    force, moment = GRAVITY / (2 * friction * press), GRAVITY * lever / (2 * torsional * press)
    used = math.hypot(force, moment) if cone == "one" else max(force, moment)
    assert float(GRAVITY / (whole.bearing * MP.mpf(press))) == pytest.approx(used, rel=1e-13)


@pytest.mark.parametrize(("cone", "torsional", "held"), [("product", 0.011, True), ("one", 0.011, False), ("one", 0.03, True)])
def test_one_cone_holds_less_than_separate_limits(cone: Any, torsional: float, held: bool) -> None:
    scene = grip(10.0, 0.6, torsional=torsional, cone=cone, aside=(0.02, 0.0))
    if held:
        assert not truth(scene, TIMES).trajectory.angular_velocity[0].any()
    else:
        with pytest.raises(NotModelled, match="slips and turns"):
            truth(scene, TIMES)


def as_mechanism(pivot: bool, friction: float, effort: Any = None, arm: tuple[float, float] = (0.0, 0.0)) -> Mechanism:
    """The body on a joint with dry friction in the place of its fingers: about their line, or along z on the carriage."""
    y, z = arm
    body = JointedBody("body", replace(Solid(BLOCK, 1.0), position=(0.0, -y, -z) if pivot else (0.0, 0.0, 0.0)))
    if pivot:
        pin = Joint("pin", "revolute", WORLD, 0, (0.0, y, z), axis=(1.0, 0.0, 0.0), friction=friction, **START)
        return Mechanism((body,), (pin,), gravity=GRAVITY)
    rows = ((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.01))
    carriage = JointedBody("carriage", Tensor(1.8, rows))
    joints = (
        Joint("lift", "prismatic", WORLD, 1, axis=(0.0, 0.0, 1.0), **START),
        Joint("slip", "prismatic", 1, 0, axis=(0.0, 0.0, 1.0), friction=friction, **START),
    )
    return Mechanism((body, carriage), joints, gravity=GRAVITY, controllers=(Controller(0, "effort", effort=effort),))


def same(one: Truth, other: Truth) -> None:
    """The states of the body agree within both bounds."""
    for name in ("position", "velocity", "angular_velocity"):
        apart = np.linalg.norm(getattr(one.trajectory, name)[0] - getattr(other.trajectory, name)[0], axis=-1)
        assert (apart <= getattr(one.bounds, f"{name}_error") + getattr(other.bounds, f"{name}_error")).all()


@pytest.mark.parametrize(
    "strength", [pytest.param(4.0, marks=pytest.mark.slow), 12.0, pytest.param(30.0, marks=pytest.mark.slow)]
)
def test_a_shaken_body_moves_like_one_on_a_joint_with_dry_friction(strength: float) -> None:
    effort = Sine(strength, 25.0, 0.3, 2.8 * GRAVITY)
    times = np.linspace(0.0, 0.3, 13)
    same(truth(grip(12.0, 0.5, lift=effort), times), truth(as_mechanism(False, 12.0, effort), times))


@pytest.mark.parametrize("torsional", [pytest.param(0.0, marks=pytest.mark.slow), 0.002])
def test_a_turning_body_moves_like_a_pendulum_with_dry_friction(torsional: float) -> None:
    times = np.linspace(0.0, 0.6, 13)
    scene = grip(40.0, 1.5, torsional=torsional, aside=(0.03, 0.02))
    same(truth(scene, times), truth(as_mechanism(True, 2 * torsional * 40.0, arm=(0.03, 0.02)), times))


@pytest.mark.parametrize(
    ("scene", "last", "expected"),
    [
        (grip(1.0, 0.0, body=Brick((0.03, 0.05, 0.05))), 0.2, math.sqrt(2 * 0.05 / GRAVITY)),
        (grip(1.0, 0.0, body=Brick((0.03, 0.05, 0.05)), aside=(0.0, 0.03)), 0.2, math.sqrt(2 * 0.02 / GRAVITY)),
        (grip(1.0, 0.0, body=BALL, finger=Brick((0.01, 0.03, 0.05))), 0.2, math.sqrt(2 * 0.05 / GRAVITY)),
        (grip(1.0, 0.0, body=Brick((0.03, 0.05, 0.05)), finger=Brick((0.01, 0.03, 0.04))), 0.2, math.sqrt(2 * 0.09 / GRAVITY)),
        (grip(Samples((0.0, 0.1), (20.0, -20.0), "linear"), 1.5), 0.1, 0.05),
        (grip(10.0, 0.5, torsional=1e-4, aside=(0.03, 0.0)), 1.0, None),
    ],
)
def test_a_motion_is_known_until_the_fingers_no_longer_grip(scene: Mechanism, last: float, expected: float | None) -> None:
    """The contacts leave a face, the fingers open, or a body turns and slips too; both ways say when."""
    times = np.linspace(0.0, last, 201)
    both = computed(scene, times)
    (own,), (other,) = ([each for each in way if each.kind == END] for way in (both.own_events, both.witnesses[0].events or ()))
    assert abs(own.time - other.time) <= own.error + other.error
    if expected is not None:
        assert own.time == pytest.approx(expected, rel=1e-14)
    assert np.array_equal(np.isnan(both.truth.trajectory.position[0, :, 2]), times > own.time)
    assert not certify(scene, times).faults


def moved(scene: Mechanism, **changed: Any) -> Mechanism:
    start = scene.bodies[0].start or BodyStart()
    return replace(scene, bodies=(replace(scene.bodies[0], start=replace(start, **changed)), *scene.bodies[1:]))


HELD = grip(20.0, 0.5)


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        (moved(HELD, position=(0.001, 0.0, 0.0)), "do not touch the body at the start"),
        (moved(HELD, position=(0.0, 0.06, 0.0)), "beside a face"),
        (moved(HELD, velocity=(0.0, 0.1, 0.0)), "moves aside"),
        (moved(HELD, rotation=(0.1, 0.0, 0.0)), "turns at the start"),
        (with_contacts(HELD, {"friction": 0.5}, {"friction": 0.4}), "different friction"),
        (with_contacts(HELD, *[{"rolling_friction": 0.1}] * 2), "rolling friction"),
        (replace(HELD, controllers=HELD.controllers[:1]), "different forces"),
        (replace(HELD, contacts=HELD.contacts[:1]), "two fingers that grip one free body"),
        (replace(HELD, joints=(replace(HELD.joints[0], damping=1.0), HELD.joints[1])), "other forces than efforts"),
        (replace(HELD, joints=(replace(HELD.joints[0], start_velocity=(1.0,)), HELD.joints[1])), "move at the start"),
        (grip(-1.0, 0.5), "fingers that open"),
        (grip(5.0, 0.5, finger=PAD, aside=(0.01, 0.0)), "not symmetrical"),
        (grip(20.0, 0.5, torsional=0.001, aside=(0.02, 0.0), lift=2.8 * GRAVITY), "turns between fingers on a carriage"),
    ],
)
def test_what_mechanics_does_not_determine_is_refused(scene: Mechanism, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        truth(scene, TIMES)


def test_random_scenes_hold_against_fifty_digits(tmp_path: Path) -> None:
    verdicts = judged(gripping_scenes.judge, 0, 2 * len(gripping_scenes.FAMILIES), tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 4


SHAKEN = grip(12.0, 0.5, lift=Sine(10.0, 25.0, 0.0, 2.8 * GRAVITY))
TURNING = grip(40.0, 1.5, torsional=0.002, aside=(0.03, 0.02))


@pytest.mark.parametrize("scene", [SHAKEN, TURNING, grip(Sine(8.0, 30.0, 0.0, 12.0), 0.5)])
def test_both_ways_agree_within_their_bounds(scene: Mechanism) -> None:
    both = computed(scene, TIMES)
    (second,) = both.witnesses
    first = as_way("", both.truth.trajectory, both.own_bounds, both.own_events)
    assert not any(apart.any() for apart in contradictions(first, second).values())
    assert first.events is not None
    assert second.events is not None
    assert not any(event_distances(first.events, second.events, TIMES[-1]))
    assert not any(event_distances(second.events, first.events, TIMES[-1]))
    assert all((getattr(both.truth.bounds, name) == getattr(both.own_bounds, name)).all() for name in STATES)


def friction_of_one_finger(patch: pytest.MonkeyPatch) -> None:
    right = way.grip_of
    patch.setattr(way, "grip_of", lambda scene: replace(right(scene), friction=right(scene).friction / 2))


def heavier_fingers(patch: pytest.MonkeyPatch) -> None:
    right = way.grip_of
    patch.setattr(way, "grip_of", lambda scene: replace(right(scene), borne=right(scene).borne * (1 + MP.mpf(10) ** -9)))


def late(patch: pytest.MonkeyPatch) -> None:
    right = course.first_negative

    def delayed(*given: Any) -> Any:
        time = right(*given)
        return time if time is None or time < 1e-20 else time + MP.mpf(10) ** -9

    patch.setattr(course, "first_negative", delayed)


@pytest.mark.parametrize("plant", [friction_of_one_finger, heavier_fingers, late])
def test_the_bounds_grow_to_the_size_of_a_planted_fault(plant: Callable[[pytest.MonkeyPatch], None]) -> None:
    right = truth(SHAKEN, TIMES)
    with pytest.MonkeyPatch.context() as patch:
        plant(patch)
        wrong, certificate = computed(SHAKEN, TIMES).truth, certify(SHAKEN, TIMES)
    largest = 0.0
    for name in ("position", "velocity"):
        off = np.linalg.norm(getattr(wrong.trajectory, name) - getattr(right.trajectory, name), axis=-1).max(axis=0)
        assert (off <= getattr(wrong.bounds, f"{name}_error") + getattr(right.bounds, f"{name}_error")).all()
        largest = max(largest, float(off.max()))
    assert largest > 1e-12
    assert certificate.faults


def test_the_judge_finds_separate_limits_in_the_place_of_one_cone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """In the scene of this seed one cone does not hold the body, and separate limits do."""
    right = way.grip_of
    with monkeypatch.context() as patch:
        patch.setattr(way, "grip_of", lambda scene: replace(right(scene), one=False))
        assert judged(gripping_scenes.judge, ONE_CONE, 1, tmp_path)[0].broken
    assert "share one limit" in judged(gripping_scenes.judge, ONE_CONE, 1, tmp_path)[0].refused


def test_sensors_of_a_gripped_body_have_no_truth() -> None:
    sensor = Sensor("felt", "accelerometer", 0)
    (told,) = sensor_truth(truth(SHAKEN, TIMES), [sensor])
    assert told.reason


@pytest.mark.parametrize("case", sorted(Path("cases/contact").glob("gripped-*.case.toml")), ids=lambda path: path.stem)
def test_a_shipped_case_has_a_truth_of_two_ways(case: Path) -> None:
    exact = bodycheck.truth(bodycheck.load(case))
    assert exact.witnesses
    assert float(exact.bounds.position_error.max()) < 1e-12
