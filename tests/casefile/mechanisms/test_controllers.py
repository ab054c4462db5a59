"""Controllers and stops in case files: what they make, and that every fault is reported where it stands."""

import tomllib

import numpy as np
import pytest

from bodycheck import Case, CaseFaults
from bodycheck.casefile.case import parse
from bodycheck.casefile.drawn import member_document, wholes
from bodycheck.casefile.identity import identity, keys
from bodycheck.casefile.key_paths import find
from bodycheck.casefile.key_paths import keys as drawable
from bodycheck.casefile.mechanisms.control_faults import MAX_CONTROLS
from bodycheck.casefile.toml_text import written
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine, Stops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.requirements import of_mechanism
from tests.support.mechanism_texts import ALL_JOINTS, CART_POLE

LIMITS = "limits = {lower = -1.0, upper = 1.0}\n"
PIN = "initial = {position = 0.3, velocity = 0.0}\n"
SINE = "{amplitude = 0.5, angular_frequency = 8.0, phase = 1.0, offset = 0.2}"
CONTROLLER = f"""
[[controllers]]
joint = "pin"
law = "pd"
kp = 20.0
kd = 0.4
ki = 3.0
target = {SINE}
target_velocity = {{times = [0.0, 0.5], values = [1.0, 2.0], between = "linear"}}
effort = -0.5
rate = 500.0
delay = 2
effort_limit = 3.0
no_load_speed = 10.0
"""
DRIVEN = CART_POLE.replace(PIN, PIN + LIMITS) + CONTROLLER


def mechanism(case: Case) -> Mechanism:
    assert isinstance(case.scene, Mechanism)
    return case.scene


def reported(text: str) -> dict[str, str]:
    """Return the messages of the faults of a case file by their lines and keys."""
    with pytest.raises(CaseFaults) as caught:
        parse(text, "f")
    return {f"{fault.position.line if fault.position else 0} {fault.key}": fault.message for fault in caught.value.faults}


def test_every_key_of_a_controller_and_of_stops() -> None:
    scene = mechanism(parse(DRIVEN, "f"))
    assert scene.controllers == (
        Controller(
            *(1, "pd", 20.0, 0.4, 3.0),
            target=Sine(0.5, 8.0, 1.0, 0.2),
            target_velocity=Samples((0.0, 0.5), (1.0, 2.0), "linear"),
            effort=-0.5,
            rate=500.0,
            delay=2,
            effort_limit=3.0,
            no_load_speed=10.0,
        ),
    )
    assert [joint.stops for joint in scene.joints] == [None, Stops(-1.0, 1.0, 0.0)]
    assert {"controllers", "rigid stops"} <= set(of_mechanism(scene).effects)


@pytest.mark.parametrize(
    ("limits", "stops"),
    [
        ("{upper = 1}", Stops(None, 1.0, 0.0)),
        ("{lower = 0.3, restitution = 0.5}", Stops(0.3, None, 0.5)),
        ("{lower = -1.0, upper = 1.0, stiffness = 400.0}", Stops(-1.0, 1.0, None, 400.0, 0.0)),
        ("{lower = -1.0, upper = 1.0, stiffness = 400.0, damping = 4.0}", Stops(-1.0, 1.0, None, 400.0, 4.0)),
    ],
)
def test_the_kinds_of_stops(limits: str, stops: Stops) -> None:
    scene = mechanism(parse(CART_POLE.replace(PIN, f"{PIN}limits = {limits}\n"), "f"))
    assert scene.joints[1].stops == stops


def test_what_a_controller_leaves_out() -> None:
    """A continuous law of feed-forward without limit."""
    scene = mechanism(parse(f'{CART_POLE}[[controllers]]\njoint = "rail"\nlaw = "effort"\n', "f"))
    assert scene.controllers == (Controller(0, "effort"),)
    assert [joint.name for joint in mechanism(parse(CART_POLE, "f")).joints if joint.stops] == []


#: A case with a fault in nearly every line below line 47.
FAULTY = (
    CART_POLE.replace(PIN, PIN + "limits = {lower = 0.5, stiffness = 1.0, restitution = 0.5}\n").replace(
        "initial = {position = 0.0, velocity = 0.5}\n", "limits = {damping = 1.0}\n"
    )
    + """\
[[controllers]]
joint = "pinn"
law = "pd"
[[controllers]]
joint = "pin"
law = "effort"
kp = 1.0
target = 1.0
delay = 2
no_load_speed = 3.0
[[controllers]]
joint = "pin"
law = "pid"
kd = -1.0
effort = {times = [0.0, 1.0, 1.0], values = [1.0, 2.0]}
rate = 1e6
gain = 2
[[controllers]]
joint = "rail"
law = "pd"
target = {amplitude = 1.0, phase = 1.0, frequency = 2.0}
target_velocity = {between = "hold"}
effort = {times = [], values = [], between = "cubic"}
rate = 0
delay = 1.5
effort_limit = -1
"""
)


def test_all_faults_at_once_each_with_its_line() -> None:
    messages = reported(FAULTY)
    lines = FAULTY.splitlines()
    assert all(key.split(" ")[0] != "0" for key in messages)
    told = {key.split(" ", 1)[1]: lines[int(key.split(" ")[0]) - 1] for key in messages}
    assert told == {
        "joints[1].limits": "limits = {damping = 1.0}",
        "joints[1].limits.damping": "limits = {damping = 1.0}",
        "joints[2].limits.lower": "limits = {lower = 0.5, stiffness = 1.0, restitution = 0.5}",
        "joints[2].limits.restitution": "limits = {lower = 0.5, stiffness = 1.0, restitution = 0.5}",
        "controllers[1].joint": 'joint = "pinn"',
        "controllers[2].kp": "kp = 1.0",
        "controllers[2].target": "target = 1.0",
        "controllers[2].delay": "delay = 2",
        "controllers[2].no_load_speed": "no_load_speed = 3.0",
        "controllers[3].joint": 'joint = "pin"',
        "controllers[3].law": 'law = "pid"',
        "controllers[3].kd": "kd = -1.0",
        "controllers[3].effort.times[3]": "effort = {times = [0.0, 1.0, 1.0], values = [1.0, 2.0]}",
        "controllers[3].effort.values": "effort = {times = [0.0, 1.0, 1.0], values = [1.0, 2.0]}",
        "controllers[3].rate": "rate = 1e6",
        "controllers[3].gain": "gain = 2",
        "controllers[4].target.angular_frequency": "target = {amplitude = 1.0, phase = 1.0, frequency = 2.0}",
        "controllers[4].target.frequency": "target = {amplitude = 1.0, phase = 1.0, frequency = 2.0}",
        "controllers[4].target_velocity": 'target_velocity = {between = "hold"}',
        "controllers[4].effort.times": 'effort = {times = [], values = [], between = "cubic"}',
        "controllers[4].effort.values": 'effort = {times = [], values = [], between = "cubic"}',
        "controllers[4].effort.between": 'effort = {times = [], values = [], between = "cubic"}',
        "controllers[4].rate": "rate = 0",
        "controllers[4].delay": "delay = 1.5",
        "controllers[4].effort_limit": "effort_limit = -1",
    }


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        ('joint = "pin"', 'joint = "pinn"', "joint", "there is no such joint; allowed: rail, pin; did you mean 'pin'?"),
        ('law = "pd"', 'law = "effort"', "kp", 'read 20.0; belongs to the law "pd"; the law "effort" has only effort'),
        ('law = "pd"', 'law = "effort"', "target", 'belongs to the law "pd"'),
        ("rate = 500.0\n", "", "delay", "counts periods of a controller with a rate; give rate too, or leave delay out"),
        ("effort_limit = 3.0\n", "", "no_load_speed", "read 10.0; needs effort_limit, which is the effort at rest"),
        ("rate = 500.0", "rate = 300000.0", "rate", "have 1.2e+06 instants in 4 s; allowed: at most 1e+06"),
        ("[0.0, 0.5]", "[0.5, 0.5]", "target_velocity.times[2]", "read 0.5; is not later than the time before it, 0.5"),
        ("[0.0, 0.5]", "[0.5]", "target_velocity.values", "has 2 values for 1 times; allowed: a value for each time"),
        (SINE, "{}", "target", "is no signal; allowed: a number"),
        ("effort = -0.5", "efort = -0.5", "efort", "did you mean 'effort'?"),
        ("offset = 0.2}", "ofset = 0.2}", "target.ofset", "did you mean 'offset'?"),
        ("effort = -0.5", 'effort = "high"', "effort", "read 'high'; should be a valid number"),
    ],
)  # fmt: skip
def test_a_fault_of_a_controller_says_what_is_allowed(old: str, new: str, key: str, words: str) -> None:
    head, table = DRIVEN.split("[[controllers]]")
    assert old in table
    messages = {
        where.split(" ", 1)[1]: message
        for where, message in reported(f"{head}[[controllers]]{table.replace(old, new)}").items()
    }
    assert words in messages.get(f"controllers[1].{key}", ""), messages


@pytest.mark.parametrize(
    ("limits", "key", "words"),
    [
        ("{}", "limits", "has neither lower nor upper; give at least one of them"),
        ("{lower = 1.0, upper = 1.0}", "limits.lower", "read 1.0; is not below upper, 1.0"),
        ("{lower = 0.4}", "limits.lower", "read 0.4; the joint starts outside, at 0.3; allowed: a start of at least 0.4"),
        ("{upper = -0.4}", "limits.upper", "read -0.4; the joint starts outside, at 0.3; allowed: a start of at most -0.4"),
        ("{upper = 1.0, stiffness = 1.0, restitution = 0.0}", "limits.restitution", "stiffness is given too; rigid stops have"),
        ("{upper = 1.0, damping = 1.0}", "limits.damping", "read 1.0; belongs to elastic stops; give stiffness too"),
        ("{upper = 1.0, restitution = 1.1}", "limits.restitution", "read 1.1; should be less than or equal to 1"),
        ("{uper = 1.0, lower = 0.0}", "limits.uper", "did you mean 'upper'?"),
    ],
)
def test_a_fault_of_stops_says_what_is_allowed(limits: str, key: str, words: str) -> None:
    messages = reported(CART_POLE.replace(PIN, f"{PIN}limits = {limits}\n"))
    assert {where.split(" ", 1)[1]: words in message for where, message in messages.items()} == {f"joints[2].{key}": True}, (
        messages
    )


def test_two_controllers_of_a_joint_and_joints_that_cannot_be_driven() -> None:
    second = CONTROLLER.replace('"pin"', '"{}"')
    (message,) = reported(DRIVEN + CONTROLLER).values()
    assert message == "read 'pin'; has controller 1 already; a joint has one controller"
    (message,) = reported(ALL_JOINTS + second.replace("{}", "ball")).values()
    assert message.startswith(
        "read 'ball'; is of the type spherical; a controller drives a revolute or prismatic joint; allowed: "
    )
    following = CART_POLE.replace(PIN, 'mimic = {joint = "rail"}\n' + LIMITS) + CONTROLLER
    assert set(reported(following).values()) == {
        "read 'pin'; the joint follows another one, which a controller can drive in its place; allowed: rail",
        "the joint follows another one, whose own limits can hold both; leave them out here",
    }


def test_the_instants_of_all_controllers_count_and_those_of_longer_runs_of_extremes() -> None:
    rate = MAX_CONTROLS / 4
    assert parse(DRIVEN.replace("rate = 500.0", f"rate = {rate}"), "f").duration == 4.0
    both = DRIVEN.replace("rate = 500.0", f"rate = {rate}") + '[[controllers]]\njoint = "rail"\nlaw = "pd"\nrate = 1.0\n'
    (message,) = reported(both).values()
    assert "all controllers together have 1e+06 instants in 4 s" in message
    extremes = reported(DRIVEN + "[extremes]\nsteps = [100, 10000000]\n")
    assert [where.split(" ", 1)[1] for where in extremes] == ["extremes.steps[2]"]


@pytest.mark.parametrize(
    ("path", "whole", "value"),
    [
        ("controllers.pin.kp", ("controllers", 0, "kp"), 20.0),
        ("controllers.0.kd", ("controllers", 0, "kd"), 0.4),
        ("controllers.'pin'.rate", ("controllers", 0, "rate"), 500.0),
        ("controllers.pin.target.amplitude", ("controllers", 0, "target", "amplitude"), 0.5),
        ("controllers.pin.effort", ("controllers", 0, "effort"), -0.5),
        ("joints.pin.limits.upper", ("joints", 1, "limits", "upper"), 1.0),
    ],
)
def test_numbers_of_controllers_and_stops_are_drawn_by_the_name_of_the_joint(
    path: str, whole: tuple[object, ...], value: float
) -> None:
    vary = f'[[ensemble.vary]]\nkey = "{path}"\ndistribution = "choice"\nvalues = [{value}, 0.75]\n'
    drawing = f"{DRIVEN}[ensemble]\nmembers = 2\n{vary}"
    case = parse(drawing, "f")
    assert case.ensemble is not None
    (variation,) = case.ensemble.vary
    assert variation.key.whole == whole
    document = tomllib.loads(drawing)
    drawn = wholes(document, {variation.key.text: np.array([value, 0.75])})
    same, other = (parse(written(member_document(document, drawn, row, row)), "f") for row in (0, 1))
    assert same.scene == parse(DRIVEN, "f").scene != other.scene


def test_all_numbers_of_a_driven_case_can_be_named() -> None:
    document = tomllib.loads(DRIVEN)
    texts = {text for text in drawable(document) if text.startswith("controllers.")}
    gains = {f"controllers.pin.{key}" for key in ("kp", "kd", "ki", "effort", "rate", "effort_limit", "no_load_speed")}
    target = {f"controllers.pin.target.{key}" for key in ("amplitude", "angular_frequency", "phase", "offset")}
    assert texts == gains | target
    assert all(find(text, document) is not None for text in texts)


@pytest.mark.parametrize(
    ("old", "new"), [("kp = 20.0", "kp = 21.0"), ("delay = 2", "delay = 1"), ("upper = 1.0", "upper = 1.1")]
)
def test_the_identity_of_a_case_contains_its_controllers_and_stops(old: str, new: str) -> None:
    case, other = parse(DRIVEN, "f"), parse(DRIVEN.replace(old, new), "f")
    assert identity(case) != identity(other)
    before, after = keys(case), keys(other)
    assert [key for key in before if before[key] != after[key]] != []
