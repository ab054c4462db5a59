"""Controllers and stops of one joint, against sixty digits by other code (`tests.support.driven_joint`), and by invariants."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine, Stops
from bodycheck.reference.mechanisms.driven import form, modes
from bodycheck.reference.mechanisms.driven.linear import Row
from bodycheck.reference.mechanisms.forms.motion import JointForm
from bodycheck.reference.mechanisms.forms.oscillator import Oscillator
from bodycheck.reference.trajectory import Array
from tests.support.driven_joint import CTX, Joint, states

PD = Controller(0, kp=20.0, kd=0.4, target=1.0)
HINGE = Joint(inertia=0.01, controller=PD)
SINE = Sine(0.7, 9.0, 0.3, 0.1)
RAMP = Samples((-0.1, 0.05, 0.21, 0.3), (0.0, 0.4, -0.3, 0.9), "linear")
HELD = Samples((0.05, 0.2, 0.301), (0.5, -0.4, 1.0))

#: One joint of each kind, and the length (s) of steps of the judge.
JOINTS: dict[str, tuple[Joint, float]] = {
    "step": (HINGE, 0.01),
    "every signal": (replace(HINGE, controller=replace(PD, target=SINE, target_velocity=RAMP, effort=HELD)), 0.01),
    "integral": (replace(HINGE, controller=replace(PD, ki=90.0, target=HELD), damping=0.02, stiffness=1.0, rest=0.2), 0.008),
    "effort": (Joint(damping=0.3, stiffness=2.0, controller=Controller(0, "effort", effort=SINE)), 0.05),
    "unstable": (Joint(controller=Controller(0, kp=3.0, ki=40.0, target=0.5)), 0.05),
    "sampled": (replace(HINGE, controller=replace(PD, rate=500.0)), 0.02),
    "sampled signals": (
        replace(HINGE, controller=replace(PD, rate=130.0, target=RAMP, target_velocity=SINE, effort=HELD, ki=30.0)),
        0.02,
    ),
    "delayed": (replace(HINGE, controller=replace(PD, rate=250.0, delay=3, target=SINE), damping=0.1, stiffness=0.5), 0.02),
    "sampled, cut": (replace(HINGE, controller=replace(PD, rate=300.0, effort_limit=2.0, target=HELD, effort=0.7)), 0.02),
    "sampled line": (
        replace(HINGE, controller=replace(PD, rate=300.0, effort_limit=5.0, no_load_speed=6.0, target=HELD, ki=50.0)),
        0.02,
    ),
    "cut": (replace(HINGE, controller=replace(PD, effort_limit=2.0, target=SINE, effort=0.3)), 0.01),
    "line": (replace(HINGE, controller=replace(PD, effort_limit=4.0, no_load_speed=8.0, target=HELD, ki=20.0)), 0.01),
    "beyond the line": (replace(HINGE, velocity=15.0, controller=replace(PD, effort_limit=4.0, no_load_speed=8.0)), 0.01),
    "friction": (replace(HINGE, friction=0.5, controller=replace(PD, kd=0.1, target=SINE)), 0.01),
    "sampled, friction": (replace(HINGE, friction=0.5, controller=replace(PD, kd=0.1, target=HELD, rate=100.0)), 0.01),
    "sticks": (replace(HINGE, friction=2.0, controller=replace(PD, kd=0.1, ki=60.0, target=0.2)), 0.01),
    "rigid stop": (replace(HINGE, controller=replace(PD, target=Sine(1.5, 20.0)), stops=Stops(-0.5, 0.4, 0.0)), 0.01),
    "falling": (Joint(force=-9.0, start=0.1, stops=Stops(0.0, None, 0.5)), 0.05),
    "falling with friction": (Joint(force=-9.0, friction=2.0, start=0.1, stops=Stops(0.0, None, 0.7)), 0.05),
    "starts on a stop": (Joint(force=-9.0, velocity=-1.0, stops=Stops(0.0, 0.1, 0.5)), 0.05),
    "elastic": (replace(HINGE, controller=replace(PD, kd=0.1), stops=Stops(-0.3, 0.6, None, 90.0, 0.4)), 0.004),
    "starts beyond an elastic stop": (Joint(start=0.7, velocity=-1.0, stops=Stops(-0.3, 0.6, None, 400.0, 30.0)), 0.01),
}

#: Joints with many events.
RESTLESS: dict[str, tuple[Joint, float]] = {
    "rebounds": (replace(HINGE, controller=replace(PD, kd=0.1, target=SINE), stops=Stops(-0.3, 0.4, 0.6)), 0.01),
    "sampled rebounds": (
        replace(HINGE, controller=replace(PD, kd=0.1, target=HELD, rate=100.0), stops=Stops(-0.3, 0.4, 0.5)),
        0.01,
    ),
    "elastic, sampled": (
        replace(HINGE, friction=0.1, controller=replace(PD, kd=0.1, rate=200.0), stops=Stops(-0.3, 0.6, None, 400.0, 0.5)),
        0.002,
    ),
}

TIMES = (0.003, 0.1, 0.2)


def follow(joint: Joint, times: Sequence[float] | Array = TIMES) -> JointForm:
    """The motion of a joint by its closed form."""
    names = ("inertia", "damping", "stiffness", "rest", "force", "friction", "start", "velocity")
    plant = Oscillator(**{name: MP.mpf(getattr(joint, name)) for name in names})
    return form.follow(plant, joint.controller, joint.stops, np.asarray(times, dtype=float))


def excess(joint: Joint, step: float, of_form: Joint | None = None, times: Sequence[float] = TIMES) -> float:
    """Return the largest error of the form, in units of its bound. of_form: the joint that the form follows instead."""
    motion = follow(of_form or joint, times)
    largest = 0.0
    for row, exact in enumerate(states(joint, times, step)):
        for values, bounds, number in zip(
            (motion.position, motion.velocity), (motion.error, motion.velocity_error), exact, strict=True
        ):
            high = float(values[row, 0])
            error = abs(CTX.mpf(high) + CTX.mpf(float(values[row, 0] - np.longdouble(high))) - number)
            # A joint at rest at zero has the bound zero; the judge has some thirty digits.
            largest = max(largest, float(error / (bounds[row] or 1e-25)))
    return largest


@pytest.mark.parametrize("name", [*JOINTS, *(pytest.param(name, marks=pytest.mark.slow) for name in RESTLESS)])
def test_the_motion_keeps_its_bound(name: str) -> None:
    joint, step = (JOINTS | RESTLESS)[name]
    assert excess(joint, step) <= 1
    motion = follow(joint)
    for values, bounds in ((motion.position, motion.error), (motion.velocity, motion.velocity_error)):
        # 1e-14 of the largest value of the motion.
        assert bounds.max() <= 1e-14 * float(np.abs(values).max())


signals_of_any_kind = st.one_of(
    st.floats(-1, 1),
    st.builds(Sine, st.floats(-1, 1), st.floats(-30, 30), st.floats(-3, 3), st.floats(-1, 1)),
    st.builds(
        lambda times, values, between: Samples(tuple(sorted(times)), tuple(values), between),
        st.lists(st.floats(-0.1, 0.3), min_size=4, max_size=4, unique=True),
        st.lists(st.floats(-1, 1), min_size=4, max_size=4),
        st.sampled_from(["hold", "linear"]),
    ),
)


@st.composite
def joints(draw: st.DrawFn) -> Joint:
    """A joint with a controller, and with everything else or without."""
    rate = draw(st.none() | st.floats(20, 300))
    limit = draw(st.none() | st.floats(0.1, 20))
    speed = draw(st.none() | st.floats(1, 10)) if limit is not None else None
    controller = Controller(
        0,
        *("pd", draw(st.floats(0, 20)), draw(st.floats(0, 0.5)), draw(st.just(0.0) | st.floats(0, 50))),
        *(draw(signals_of_any_kind) for _ in range(3)),
        *(
            rate,
            draw(st.integers(0, 3)) if rate else 0,
            limit,
            draw(st.none() | st.floats(1, 10)) if limit is not None else None,
        ),
    )
    lower, upper = draw(st.floats(-1, -0.1)), draw(st.floats(0.1, 1))
    rigid = st.builds(Stops, st.just(lower), st.just(upper), st.just(0.0) | st.floats(0, 0.5))
    elastic = st.builds(Stops, st.just(lower), st.just(upper), st.none(), st.floats(1, 100), st.just(0.0) | st.floats(0, 1))
    return Joint(
        inertia=draw(st.floats(0.01, 0.1)),
        damping=draw(st.just(0.0) | st.floats(0, 0.3)),
        stiffness=draw(st.just(0.0) | st.floats(0, 5)),
        rest=draw(st.floats(-1, 1)),
        force=draw(st.just(0.0) | st.floats(-1, 1)),
        friction=draw(st.just(0.0) | st.floats(0.01, 1)),
        start=draw(st.floats(lower, upper)),
        velocity=draw(st.just(0.0) | st.floats(-5, 5)),
        controller=controller,
        stops=draw(st.none() | rigid | elastic),
    )


@pytest.mark.slow
@given(joints())
@settings(max_examples=150, deadline=None)
def test_any_joint_keeps_its_bound(joint: Joint) -> None:
    try:
        follow(joint)
    except OutOfReach:
        reject()
    assert excess(joint, 0.002) <= 1


def test_the_hinge_of_the_documentation() -> None:
    """The position and the rate after 0.1 s, from sources apart from this project."""
    continuous, sampled = follow(HINGE, [0.1]), follow(replace(HINGE, controller=replace(PD, rate=500.0)), [0.1])
    assert float(continuous.position[0, 0]) == 1.1396720845937189
    # The inertia 0.01 is a double, which shifts the last digit of the rate.
    assert float(sampled.position[0, 0]) == pytest.approx(1.1333289750980506, rel=3e-16)
    assert float(sampled.velocity[0, 0]) == pytest.approx(-5.79412483285462, rel=1e-14)


def with_kd_on_the_absolute_velocity(joint: Joint) -> Joint:
    return replace(joint, controller=replace(joint.controller, target_velocity=0.0))


def with_hold_at_the_end(joint: Joint) -> Joint:
    """A held signal that has the value at the end of each of its pieces."""
    target = joint.controller.target
    later = replace(target, values=(*target.values[1:], target.values[-1]))
    return replace(joint, controller=replace(joint.controller, target=later))


def with_saturation_before_the_feed_forward(joint: Joint) -> Joint:
    """The feed-forward is constant, so that the plant can exert it."""
    return replace(joint, force=joint.force + joint.controller.effort, controller=replace(joint.controller, effort=0.0))


def with_one_period_more(joint: Joint) -> Joint:
    return replace(joint, controller=replace(joint.controller, delay=joint.controller.delay + 1))


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("every signal", with_kd_on_the_absolute_velocity),
        ("sampled signals", with_kd_on_the_absolute_velocity),
        ("integral", with_hold_at_the_end),
        ("sampled, cut", with_hold_at_the_end),
        ("cut", with_saturation_before_the_feed_forward),
        ("sampled, cut", with_saturation_before_the_feed_forward),
        ("sampled", with_one_period_more),
        ("delayed", with_one_period_more),
    ],
)
def test_a_planted_fault_is_found(name: str, fault: Callable[[Joint], Joint]) -> None:
    joint, step = JOINTS[name]
    assert excess(joint, step, of_form=fault(joint), times=TIMES[1:2]) > 1e6


def test_a_stop_that_pulls_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    joint, step = JOINTS["elastic"]
    times = [0.2]
    assert excess(joint, step, times=times) <= 1
    # The stop pushes as long as the joint is beyond it.
    monkeypatch.setattr(modes, "_of_stops", pulling)
    assert excess(joint, step, times=times) > 1e6


def pulling(joint: modes.DrivenJoint, mode: modes.Mode) -> list[Row]:
    if mode.contact == "free":
        return [modes.total((-joint.mp.one, modes.beyond(joint, side))) for side in modes.sides(joint)]
    return [modes.beyond(joint, mode.side)] if mode.contact == "pushing" else [{modes.ONE: -joint.mp.one}]
