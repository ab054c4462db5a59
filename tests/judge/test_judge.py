"""Truths of scenes that are drawn hold against arithmetic of fifty digits, and the judge knows known closed forms."""

from collections.abc import Iterator
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest

from tests.adversary.sizes import batches
from tests.judge import (
    balls,
    coins,
    contact_scenes,
    driven,
    driven_scenes,
    gripping_scenes,
    impact_scenes,
    impacts,
    jointed,
    maximal,
    mechanism_scenes,
    rods,
    rolling_scenes,
    sensor_scenes,
    sensors,
    tree_scenes,
)
from tests.judge.documents import written
from tests.judge.numerals import ZERO, Number, exact, fifty_digits, sine_cosine
from tests.judge.slips import Slip, length
from tests.judge.verdicts import Claim, judged

#: Mechanisms whose truths need no long compilation.
MECHANISMS = [15, 17]

#: Trees with two hinges on one body, and with such a chain of which one hinge follows the other.
TREES = [25, 31]

#: Trees with sensors, of shapes that are compiled for others, and one in which joints follow others.
SENSORS = [4, 25, 196]

#: Driven joints: one whose torque-speed line ends, and two between stops.
DRIVEN = [13, 259, 339]

SLIDER_AND_WHEEL = {
    "format": 2,
    "name": "slider-and-wheel",
    "bodies": [{"name": name, "mass": 1.0, "inertia": [0.1, 0.1, 0.1]} for name in ("slider", "wheel")],
    "joints": [
        {"name": "rail", "type": "prismatic", "child": "slider", "axis": [1.0, 0.0, 0.0], "effort": 1.0},
        {
            "name": "axle",
            "type": "revolute",
            "parent": "slider",
            "child": "wheel",
            "axis": [0.0, 0.0, 1.0],
            "friction": 0.1,
            "initial": {"velocity": 2.5},
        },
    ],
    "run": {"duration": 100.0, "samples": 2},
}


@pytest.fixture(autouse=True)
def digits() -> Iterator[None]:
    with fifty_digits():
        yield


@pytest.mark.parametrize("seed", MECHANISMS)
def test_truths_of_a_few_mechanisms_hold(seed: int, tmp_path: Path) -> None:
    assert not judged(mechanism_scenes.judge, seed, 1, tmp_path)[0].broken


@pytest.mark.parametrize("seed", TREES)
def test_truths_of_a_few_trees_hold(seed: int, tmp_path: Path) -> None:
    assert not judged(tree_scenes.judge, seed, 1, tmp_path)[0].broken


@pytest.mark.parametrize("seed", DRIVEN)
def test_truths_of_a_few_driven_mechanisms_hold(seed: int, tmp_path: Path) -> None:
    verdict = judged(driven_scenes.judge, seed, 1, tmp_path)[0]
    assert not verdict.broken
    assert not verdict.refused


def test_truths_of_a_scene_of_each_family_hold(tmp_path: Path) -> None:
    verdicts = judged(contact_scenes.judge, 256, len(contact_scenes.FAMILIES), tmp_path)
    assert not [str(each) for each in verdicts if each.broken]


@pytest.mark.parametrize("seed", [463, 695], ids=["lands on its side", "begins with a rounded velocity"])
def test_truths_of_coins_hold(seed: int, tmp_path: Path) -> None:
    assert not judged(contact_scenes.judge, seed, 1, tmp_path)[0].broken


@pytest.mark.parametrize("seed", SENSORS)
def test_readings_of_sensors_of_a_few_trees_hold(seed: int, tmp_path: Path) -> None:
    verdict = judged(sensor_scenes.judge, seed, 1, tmp_path)[0]
    assert not verdict.broken
    assert not verdict.refused


def test_truths_of_a_few_spheres_that_hit_each_other_hold(tmp_path: Path) -> None:
    verdicts = judged(impact_scenes.judge, 0, 3 * len(impact_scenes.FAMILIES), tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 1


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("IMPACTS"))
def test_truths_of_spheres_that_hit_each_other_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(impact_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 5 + count / 10


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("GRIPS"))
def test_truths_of_bodies_between_fingers_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(gripping_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 3 + count / 10


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("SENSORS"))
def test_readings_of_sensors_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(sensor_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken or each.refused]


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("MECHANISMS"))
def test_truths_of_mechanisms_with_dry_friction_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(mechanism_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 10 + count / 3  # the others are what is judged


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("TREES"))
def test_truths_of_trees_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(tree_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken or each.refused]


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("DRIVEN"))
def test_truths_of_driven_mechanisms_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(driven_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 5 + count / 5  # the others are what is judged


@pytest.mark.parametrize("seed", [1, 8, 14], ids=["stops", "rests", "across"])
def test_truths_of_a_few_spheres_with_rolling_friction_hold(seed: int, tmp_path: Path) -> None:
    verdict = judged(rolling_scenes.judge, seed, 1, tmp_path)[0]
    assert not verdict.broken
    assert not verdict.refused


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), [(first, 25) for first in range(0, 300, 25)])
def test_truths_of_spheres_with_rolling_friction_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(rolling_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 10 + count / 5  # the others are what is judged


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("CONTACTS"))
def test_truths_of_bodies_that_touch_hold(first: int, count: int, tmp_path: Path) -> None:
    verdicts = judged(contact_scenes.judge, first, count, tmp_path)
    assert not [str(each) for each in verdicts if each.broken]
    assert sum(bool(each.refused) for each in verdicts) <= 10 + count / 3


@pytest.mark.parametrize(("friction", "expected"), [(1 - 1e-12, "2.49994469569969623989891260862"), (1.0, "0")])
def test_the_judge_decides_sticking_by_the_last_digit(friction: float, expected: str) -> None:
    """The slider has 2 kg, and so the acceleration (1 - friction) / 2: in 100 s it comes 2500 (1 - friction) far."""
    SLIDER_AND_WHEEL["joints"][0]["friction"] = friction  # type: ignore[index]
    motion, _ = jointed.motion(written(SLIDER_AND_WHEEL), [Decimal(100)])
    position, _ = motion[-1].joints["rail"]
    assert _near(position, 2500 * (1 - Decimal(friction)))
    assert abs(position * 10**9 - Decimal(expected)) < Decimal("1e-25")
    assert _near(motion[-1].joints["axle"][0], Decimal("3.125"))  # the doubles of friction and moment are the same


def test_the_judges_of_trees_and_of_dry_friction_agree() -> None:
    """One has the coordinates of every body, the other those of the joints, and neither decides a change in this motion."""
    joints = [{**joint, "friction": 0.0, "damping": 0.1} for joint in SLIDER_AND_WHEEL["joints"]]  # type: ignore[attr-defined]
    text = written(SLIDER_AND_WHEEL | {"joints": joints})
    ours, theirs = maximal.motion(text, [Decimal(2)])[0], jointed.motion(text, [Decimal(2)])[0][0]
    for name, (position, velocity) in theirs.joints.items():
        # Both leave out terms of 1e-35 in each step.
        assert abs(ours.joints[name][0] - position) < Decimal("1e-30")
        assert abs(ours.joints[name][1] - velocity) < Decimal("1e-30")


def _hinge(controller: dict[str, Any], limits: dict[str, float] | None = None, velocity: float = 0.0) -> str:
    joint: dict[str, Any] = {"name": "pin", "type": "revolute", "child": "arm", "axis": [0.0, 1.0, 0.0]}
    return written(
        {
            "bodies": [{"name": "arm", "mass": 1.0, "inertia": [0.01, 0.01, 0.01]}],
            "joints": [joint | {"initial": {"velocity": velocity}} | ({} if limits is None else {"limits": limits})],
            "controllers": [{"joint": "pin", "law": "effort"} | controller],
        }
    )


@pytest.mark.parametrize(("rate", "expected"), [({}, "1.13967208459371890"), ({"rate": 500.0}, "1.13332897509805060")])
def test_the_judge_knows_a_driven_hinge(rate: dict[str, float], expected: str) -> None:
    """Its inertia and gains are exact in decimals but not as doubles, so that fifteen digits agree."""
    law = {"law": "pd", "kp": 20.0, "kd": 0.4, "target": 1.0}
    instants = driven.motion(_hinge(law | rate), [Decimal("0.1")])[0]
    assert abs(instants[-1].joints["pin"][0] - Decimal(expected)) < Decimal("5e-16")


def test_the_judge_reads_held_values_at_the_instant_that_reaches_their_time() -> None:
    """The fiftieth instant at 500 Hz reaches 0.1 s, whose double is larger than 50 / 500."""
    effort = {"times": [0.0, 0.1], "values": [0.0, 1.0]}
    instants = driven.motion(_hinge({"effort": effort, "rate": 500.0}), [Decimal("0.102")])[0]
    assert abs(instants[-1].joints["pin"][0] - Decimal("0.0002")) < Decimal("1e-18")  # as the doubles 0.01 and 1


def test_the_judge_knows_rebounds_under_a_constant_load() -> None:
    """After the first fall of a time T, rebounds of e = 1/2 last T in all twice, so that the joint rests after 3 T."""
    text = _hinge({"effort": 0.02}, {"upper": 1.0, "restitution": 0.5})
    fall = (2 * exact(0.01) / exact(0.02)).sqrt()
    instants = driven.motion(text, [fall * Decimal("1.5"), fall * Decimal("2.999"), fall * 3])[0]
    # In the middle of the first rebound, which lasts T, it is at the highest place: a quarter of the way, as e^2 says.
    assert _near(instants[0].joints["pin"][0], Decimal("0.75"))
    assert instants[1].joints["pin"][0] < 1
    assert instants[2].joints["pin"][0] == 1


def test_the_judge_knows_an_elastic_stop() -> None:
    """Without damping, the joint leaves the stop with the velocity that it had, after half a period of the spring."""
    text = _hinge({}, {"upper": 0.0, "stiffness": 4.0}, velocity=2.0)
    quarter = Decimal("3.14159265358979323846264338327950288419716939937511") / (exact(4.0) / exact(0.01)).sqrt() / 2
    instants = driven.motion(text, [quarter, 4 * quarter])[0]
    # Series leave out terms of 1e-35 in each step.
    assert abs(instants[0].joints["pin"][0] - 2 * (exact(0.01) / 4).sqrt()) < Decimal("1e-32")
    assert abs(instants[1].joints["pin"][1] + 2) < Decimal("1e-32")


def test_the_judge_knows_the_accelerometer_of_a_brick_in_free_flight() -> None:
    """Gravity drops out. The rates follow from Euler's equations, and a = rate x r + w x (w x r)."""
    sensor = {"name": "imu", "type": "accelerometer", "body": "brick", "position": [0.1, 0.05, 0.02]}
    moments, spin, place = (0.0134, 0.0105, 0.0043), (1.0, 5.0, 1.0), (0.1, 0.05, 0.02)
    start = {"velocity": [1.0, 2.0, 3.0], "angular_velocity": list(spin)}
    bodies = [{"name": "brick", "mass": 1.0, "inertia": list(moments), "initial": start}]
    text = written({"bodies": bodies, "sensors": [sensor], "scene": {"gravity": 9.81}})
    (a, b, c), (p, q, r), (x, y, z) = exact(moments), exact(spin), exact(place)
    rates = ((b - c) * q * r / a, (c - a) * r * p / b, (a - b) * p * q / c)
    expected = [
        rates[1] * z - rates[2] * y - x * (q * q + r * r) + p * (q * y + r * z),
        rates[2] * x - rates[0] * z - y * (r * r + p * p) + q * (r * z + p * x),
        rates[0] * y - rates[1] * x - z * (p * p + q * q) + r * (p * x + q * y),
    ]
    (reading,) = sensors.readings(text, [Decimal(0)])["imu"]
    assert all(map(_near, reading, expected))
    known = (-2.5159379844961242, 0.7909406456091635, 0.0323383084577115)
    assert list(map(float, reading)) == pytest.approx(known, abs=1e-15)


def test_the_judge_knows_the_wrench_of_a_pendulum_at_the_bottom() -> None:
    """A point mass that starts from the horizontal pulls at the bottom with 3 m g, whatever its length."""
    joint = {"name": "pin", "type": "revolute", "child": "bob", "axis": [0.0, 1.0, 0.0], "initial": {"velocity": 4.0}}
    bob = {"name": "bob", "mass": 2.0, "inertia": [0.0, 0.0, 0.0], "center_of_mass": [0.0, 0.0, -0.5]}
    sensor = {"name": "wrench", "type": "force_torque", "joint": "pin"}
    # The speed that a fall by the length of 0.5 m gives is the root of 2 g 0.5 m = 4 m^2/s^2, where g is 4 m/s^2.
    text = written({"bodies": [bob], "joints": [joint], "sensors": [sensor], "scene": {"gravity": 4.0}})
    (reading,) = sensors.readings(text, [Decimal(0)])["wrench"]
    assert all(map(_near, reading, (ZERO, ZERO, 3 * exact(2.0) * 4, ZERO, ZERO, ZERO)))


def test_the_judge_knows_the_ball_that_begins_to_roll() -> None:
    """It rolls from 2 v / (7 mu g) on with 5/7 v (Coriolis 1835)."""
    text = written(
        {
            "body": {"shape": "sphere", "radius": 0.125, "mass": 1.0},
            "initial": {"velocity": [2.0, 0.0, 0.0]},
            "scene": {"gravity": 8.0, "plane": {"friction": 0.25}},
            "run": {"duration": 1.0, "samples": 2},
        }
    )
    motion = balls.motion(text, [Decimal(0), Decimal(1)])
    ((kind, time),) = motion.events
    assert kind == "roll"
    assert _near(time, Decimal(2) / 7)
    assert _near(motion.states[1].velocity[0], Decimal(10) / 7)
    assert _near(motion.states[1].spin[1], Decimal(80) / 7)


def test_the_judge_knows_the_impact_that_exchanges_velocities() -> None:
    """A sphere that hits one of the same mass head-on, without loss, stops, and the other one goes on."""
    ball = {"shape": "sphere", "radius": 0.125, "mass": 2.0}
    starts = {"position": [0.0, 0.0, 0.0], "velocity": [2.0, 0.0, 0.0]}, {"position": [1.25, 0.0, 0.0]}
    names = "one", "other"
    pair = {"bodies": list(names), "friction": 0.5, "restitution": 1.0}
    bodies = [{"name": name, **ball, "initial": start} for name, start in zip(names, starts, strict=True)]
    text = written({"bodies": bodies, "scene": {"contacts": [pair]}, "run": {"duration": 1.0, "samples": 2}})
    one, other = impacts.motions(text, [Decimal(0), Decimal(1)])
    assert one.events == other.events
    assert _near(one.events[0][1], Decimal("0.5"))
    assert all(map(_near, one.states[1].velocity, (ZERO, ZERO, ZERO)))
    assert all(map(_near, other.states[1].velocity, (Decimal(2), ZERO, ZERO)))


def test_the_judge_knows_slips_across_their_drive() -> None:
    """In steps of a thousandth the slip changes by its rates, and it ends in the direction of its drive."""
    slip = Slip((Decimal(2), Decimal(1)), Decimal(4), (Decimal(-1), Decimal(1)))
    end, step = slip.end(), Decimal("1e-12")
    assert end is not None
    for part in ("0.1", "0.5", "0.9"):
        (before, way), (after, farther) = (slip.at(end * Decimal(part) + shift) for shift in (-step, step))
        speed = slip.at(end * Decimal(part))[0]
        for axis in (0, 1):
            rate = slip.drive[axis] - 4 * speed[axis] / length(speed)
            assert abs((after[axis] - before[axis]) / (2 * step) - rate) < Decimal("1e-20")
            assert abs((farther[axis] - way[axis]) / (2 * step) - speed[axis]) < Decimal("1e-20")
    last = slip.at(end * (1 - Decimal("1e-20")))[0]
    assert length(last) < Decimal("1e-19")
    assert abs(last[0] - 2 * last[1]) < Decimal("1e-3") * last[0]


def test_the_judge_knows_the_coin_that_rolls_along_a_circle() -> None:
    """The tilt of the shipped circle stays, as far as its decimals state the steady turning rate."""
    text = Path("cases/contact/rolling-coin-circle.case.toml").read_text("utf-8")
    motion = coins.motion(text, [Decimal(0), Decimal("0.1")])
    assert abs(motion.states[1].turn[2][2] - sine_cosine(Decimal(1))[1]) < Decimal("1e-15")


def test_the_judge_knows_when_a_leaning_rod_slips() -> None:
    """A thin rod slips where 3 sin a (3 cos a - 2 cos b) / 4 is the friction times (1 + 9 cos^2 a - 6 cos a cos b) / 4."""
    body = {"shape": "cylinder", "radius": 1e-40, "half_length": 0.5, "mass": 1.0}
    start = {"euler_zxz": [0.0, 0.25, 0.0]}
    text = written(
        {
            "body": body,
            "initial": start,
            "scene": {"gravity": 9.81, "plane": {"friction": 0.3}},
            "run": {"duration": 1.0, "samples": 2},
        }
    )
    ((kind, time),) = rods.motion(text, [Decimal(0), Decimal(1)]).events
    state = rods.motion(text, [Decimal(0), time]).states[1]
    cosine, start_cosine = state.turn[2][2], sine_cosine(Decimal("0.25"))[1]
    sine = (1 - cosine * cosine).sqrt()
    push = 3 * sine * (3 * cosine - 2 * start_cosine)
    assert kind == "slip"
    assert abs(push - exact(0.3) * (1 + 9 * cosine * cosine - 6 * cosine * start_cosine)) < Decimal("1e-28")


@pytest.mark.parametrize(("error", "bound", "holds"), [(1e-16, 2e-16, True), (3e-16, 2e-16, False), (1e-17, 0.0, False)])
def test_a_number_outside_its_bound_is_broken(error: float, bound: float, holds: bool) -> None:
    assert (Claim("position", error, bound).ratio <= 1) == holds


def _near(value: Number, expected: Number) -> bool:
    return abs(value - expected) < Decimal("1e-45")
