"""Controllers and stops of one joint, against sixty digits by other code (`tests.support.driven_joint`), and by invariants."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from bodycheck.reference.errors import OutOfReach, Stopped
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops
from bodycheck.reference.mechanisms.driven import form, modes
from bodycheck.reference.mechanisms.driven.linear import Row
from bodycheck.reference.mechanisms.forms.choice import form_of
from bodycheck.reference.mechanisms.forms.motion import JointForm
from bodycheck.reference.mechanisms.forms.oscillator import Oscillator
from bodycheck.reference.mechanisms.mechanism import Joint as MechanismJoint
from bodycheck.reference.mechanisms.mechanism import JointedBody, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.scene import Tensor
from bodycheck.reference.trajectory import Array
from tests.support.driven_joint import CTX, Joint, states

PD = Controller(0, kp=20.0, kd=0.4, target=1.0)
HINGE = Joint(inertia=0.01, controller=PD)
SINE = Sine(0.7, 9.0, 0.3, 0.1)
RAMP = Samples((-0.1, 0.05, 0.11, 0.3), (0.0, 0.4, -0.3, 0.9), "linear")
HELD = Samples((0.05, 0.12, 0.301), (0.5, -0.4, 1.0))

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
    # At some crossings, rounding leaves the velocity on the near side of the no-load speed.
    "crosses the line": (
        replace(HINGE, force=1.0, stiffness=12.0, controller=replace(PD, target=SINE, effort_limit=0.3, no_load_speed=0.5)),
        0.01,
    ),
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

TIMES = (0.003, 0.1, 0.15)


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
        *(rate, draw(st.integers(0, 3)) if rate else 0, limit, speed),
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
    times = [0.1]
    assert excess(joint, step, times=times) <= 1
    # The stop pushes as long as the joint is beyond it.
    monkeypatch.setattr(modes, "_of_stops", pulling)
    assert excess(joint, step, times=times) > 1e6


def pulling(joint: modes.DrivenJoint, mode: modes.Mode) -> list[Row]:
    if mode.contact == "free":
        return [modes.total((-joint.mp.one, modes.beyond(joint, side))) for side in modes.sides(joint)]
    return [modes.beyond(joint, mode.side)] if mode.contact == "pushing" else [{modes.ONE: -joint.mp.one}]


def test_a_motion_that_begins_later_is_the_same() -> None:
    """From a state that a motion reaches at a multiple of the period, with signals that are as much earlier, it continues."""
    joint = replace(
        HINGE, friction=0.1, controller=replace(PD, target=Samples((0.25, 0.5), (0.0, 1.0), "linear"), effort_limit=3.0)
    )
    for rate in (None, 64.0):
        before = replace(joint, controller=replace(joint.controller, rate=rate))
        whole = follow(before, [0.25, 0.375, 0.75])
        state = {"start": float(whole.position[0, 0]), "velocity": float(whole.velocity[0, 0])}
        shifted = replace(before.controller, target=Samples((0.0, 0.25), (0.0, 1.0), "linear"))
        later = follow(replace(before, controller=shifted, **state), [0.125, 0.5])
        # The state is rounded to doubles, and errors do not grow.
        assert later.position == pytest.approx(whole.position[1:], abs=1e-15)


@pytest.mark.parametrize("name", ["cut", "line", "friction", "sampled line", "rigid stop", "elastic", "falling with friction"])
def test_the_mirrored_joint_moves_like_its_image(name: str) -> None:
    joint, _ = JOINTS[name]
    motion, image = follow(joint), follow(mirrored(joint))
    assert (motion.position == -image.position).all()
    assert (motion.velocity == -image.velocity).all()


def mirrored(joint: Joint) -> Joint:
    """The joint with the opposite coordinate."""

    def negative(signal: Signal) -> Signal:
        match signal:
            case Sine():
                return replace(signal, amplitude=-signal.amplitude, offset=-signal.offset)
            case Samples():
                return replace(signal, values=tuple(-each for each in signal.values))
            case _:
                return -signal

    controller, stops = joint.controller, joint.stops
    if controller is not None:
        names = ("target", "target_velocity", "effort")
        controller = replace(controller, **{name: negative(getattr(controller, name)) for name in names})
    if stops is not None:
        lower, upper = (None if end is None else -end for end in (stops.upper, stops.lower))
        stops = replace(stops, lower=lower, upper=upper)
    start = {name: -getattr(joint, name) for name in ("rest", "force", "start", "velocity")}
    return replace(joint, controller=controller, stops=stops, **start)


def test_an_elastic_stop_is_half_a_period_of_a_spring() -> None:
    """A mass that flies into a stop without damping leaves it after pi / omega with the opposite velocity."""
    joint = Joint(inertia=2.0, velocity=3.0, stops=Stops(None, 0.75, None, 50.0))
    omega = 5.0
    motion = follow(joint, [0.25 + np.pi / omega / 2, 0.25 + np.pi / omega, 1.5])
    # The instants are doubles.
    assert motion.position[0, 0] == pytest.approx(0.75 + 3.0 / omega, rel=1e-15)
    assert motion.velocity[1, 0] == pytest.approx(-3.0, rel=1e-15)
    assert motion.position[2, 0] == pytest.approx(0.75 - 3.0 * (1.25 - np.pi / omega), rel=1e-14)


def test_a_damped_elastic_stop_never_pulls() -> None:
    """The critically damped spring that only pushes: overshoot v T / e, and e^-2 of the velocity is left."""
    joint = Joint(velocity=2.0, stops=Stops(None, 0.0, None, 2500.0, 100.0))
    motion = follow(joint, [0.02, 0.04, 0.5, 1.0])
    assert motion.position[0, 0] == pytest.approx(2.0 * 0.02 / np.e, rel=1e-15)
    # The stop ceases to push when the force of its spring is that of its damper, at 2 T, and the joint is still beyond it.
    assert motion.velocity[1:, 0] == pytest.approx([-2.0 / np.e**2] * 3, rel=1e-14)


@pytest.mark.parametrize("friction", [0.0, 2.0])
def test_rebounds_under_a_constant_load_end_after_a_geometric_series(friction: float) -> None:
    load, restitution, height = 8.0, 0.5, 1.0
    joint = Joint(force=-load, friction=friction, start=height, stops=Stops(0.0, 3.0, restitution))
    falling, rising = load - friction, load + friction
    fall = np.sqrt(2 * height / falling)
    speed, ratio = restitution * falling * fall, restitution * np.sqrt(falling / rising)
    end = fall + speed * (1 / rising + 1 / np.sqrt(rising * falling)) / (1 - ratio)
    motion = follow(joint, [fall, fall + speed / rising, end * (1 - 1e-9), end * (1 + 1e-9), 10.0])
    # At an impact, the velocity is the one before; the instant is a double, on either side of the impact.
    assert min(abs(motion.velocity[0, 0] + falling * fall), abs(motion.velocity[0, 0] - speed)) < 1e-14
    assert motion.position[1, 0] == pytest.approx(speed**2 / rising / 2, rel=1e-14)
    assert 0 < abs(motion.velocity[2, 0]) < 1e-7
    assert not motion.velocity[3:].any()
    assert not motion.position[3:].any()


def test_energy_pays_for_damping_friction_and_the_controller() -> None:
    joint = replace(
        HINGE, damping=0.02, friction=0.1, controller=replace(PD, effort_limit=4.0), stops=Stops(-0.3, 0.8, None, 90.0)
    )
    times = np.linspace(0, 0.5, 50001)
    motion = follow(joint, times)
    q, v = (values[:, 0].astype(float) for values in (motion.position, motion.velocity))
    effort = np.clip(20.0 * (1.0 - q) - 0.4 * v, -4.0, 4.0)
    power = effort * v - 0.02 * v**2 - 0.1 * np.abs(v)
    work = np.concatenate(([0.0], np.cumsum((power[1:] + power[:-1]) / 2) * times[1]))
    energy = 0.01 / 2 * v**2 + 90.0 / 2 * np.maximum(q - 0.8, 0) ** 2
    # The trapezoidal rule with a step h errs by h^2 / 12 times the change of the derivative of the power.
    assert np.abs(energy - work).max() < 1e-5


def test_the_integral_removes_the_error_that_remains() -> None:
    for rate in (None, 100.0):
        joint = replace(HINGE, force=1.5, controller=replace(PD, rate=rate))
        without, motion = (follow(replace(joint, controller=replace(joint.controller, ki=ki)), [16.0]) for ki in (0.0, 40.0))
        assert float(without.position[0, 0]) == pytest.approx(1 + 1.5 / 20, abs=1e-15)
        assert float(motion.position[0, 0]) == pytest.approx(1.0, abs=1e-15)


def test_a_joint_between_equal_forces_stays() -> None:
    """A force equal to the friction holds the joint, and so does a stop, until the force changes its sign."""
    ramp = Samples((0.0, 1.0, 2.0), (0.5, 0.5, 1.5), "linear")
    stuck = Joint(friction=0.5, controller=Controller(0, "effort", effort=ramp))
    motion = follow(stuck, [1.0, 1.5])
    assert not motion.position[0].any()
    assert motion.position[1, 0] == pytest.approx(0.5**3 / 6, rel=1e-15)
    held = Joint(
        stops=Stops(None, 0.0, 0.3), controller=Controller(0, "effort", effort=Samples((0.0, 1.0), (1.0, -1.0), "linear"))
    )
    motion = follow(held, [0.5, 1.0])
    assert not motion.position[0].any()
    assert motion.position[1, 0] == pytest.approx(-2 * 0.5**3 / 6, rel=1e-15)


@pytest.mark.parametrize("beside", [-1, 0, 1])
def test_a_stop_that_is_only_touched(beside: int) -> None:
    """An oscillation with an amplitude that is that of the stop, or differs by one rounding of a double."""
    upper = float(np.nextafter(1.0, 1.0 + beside))
    joint = Joint(stiffness=1.0, start=-1.0, stops=Stops(None, upper, 0.5))
    times = np.array([3.0, 6.0, 9.0])
    motion = follow(joint, times)
    if beside >= 0:
        exact = [-CTX.cos(CTX.mpf(t)) for t in times.tolist()]
    else:
        # The joint meets the stop with the velocity s, and leaves it with half of it, which is 1e-8.
        upper_mp = CTX.mpf(upper)
        impact, speed = CTX.acos(-upper_mp), CTX.sqrt(1 - upper_mp**2)
        exact = [
            -CTX.cos(CTX.mpf(t)) if t < impact else upper_mp * CTX.cos(t - impact) - speed / 2 * CTX.sin(t - impact)
            for t in times.tolist()
        ]
    errors = [abs(CTX.mpf(float(q)) - number) for q, number in zip(motion.position[:, 0], exact, strict=True)]
    assert max(errors) < 2e-16
    assert motion.error.max() < 1e-17


def test_an_impact_at_an_instant_of_the_controller() -> None:
    """The velocity that the controller reads is not determined; where it does not read it, the motion is."""
    joint = Joint(velocity=1.0, controller=Controller(0, kd=1.0, target_velocity=1.0, rate=4.0), stops=Stops(None, 0.5, 0.5))
    with pytest.raises(OutOfReach, match=r"at 0.5 s the joint meets a stop at an instant of its controller"):
        follow(joint, [1.0])
    free = replace(joint, controller=Controller(0, rate=4.0))
    assert follow(free, [1.0]).position[0, 0] == 0.25
    # One rounding beside it, the order is determined, by 1e-16 s.
    for stop, velocity in ((np.nextafter(0.5, 0), -0.5 + 0.375), (np.nextafter(0.5, 1), -0.5 + 0.5 * 0 + 0.375 - 0.375)):
        motion = follow(replace(joint, stops=Stops(None, float(stop), 0.5)), [0.75])
        assert motion.velocity[0, 0] == pytest.approx(velocity, abs=1e-14)


def test_a_controller_reads_held_values_at_instants_that_reach_their_times() -> None:
    """A time that is later than an instant by at most 1e-9 of a period counts as reached."""
    rate = 10.0
    for time, begun in ((0.3, 3), (float(np.nextafter(0.3, 1)), 3), (0.3 + 0.9e-10, 3), (0.3 + 1.1e-10, 4)):
        joint = Joint(controller=Controller(0, "effort", effort=Samples((0.0, time), (0.0, 1.0)), rate=rate))
        assert follow(joint, [1.0]).velocity[0, 0] == pytest.approx(1 - begun / 10, rel=1e-15)


def test_a_million_instants_are_the_limit() -> None:
    joint = replace(HINGE, controller=replace(PD, rate=1e6))
    with pytest.raises(OutOfReach, match="1000001 instants; at most 1000000"):
        follow(joint, [1.000001])


def test_a_start_on_a_stop_and_beyond() -> None:
    """A start on a stop that moves outwards is an impact, after which a controller reads the velocity."""
    joint = Joint(velocity=1.0, controller=Controller(0, kd=1.0, rate=1.0), stops=Stops(None, 0.0, 0.5))
    motion = follow(joint, [0.0, 0.5])
    assert motion.velocity[:, 0].tolist() == [1.0, -0.5 + 0.25]
    with pytest.raises(OutOfReach, match="starts beyond one of its rigid stops"):
        follow(replace(joint, start=0.1), [1.0])


def test_a_chaotic_motion_is_refused_when_its_digits_are_lost() -> None:
    """A sampled law that is unstable, within its limit of effort: neighbouring motions part by a factor each period."""
    law = replace(PD, kp=60.0, kd=1.5, rate=50.0, effort_limit=3.0, target=Sine(1.0, 3.0))
    joint = replace(HINGE, controller=law)
    assert follow(joint, [1.0]).error[0] < 1e-17
    with pytest.raises(Stopped, match="60 digits do not determine the motion at 20 s"):
        follow(joint, [1.0, 20.0])


def test_mechanisms_with_controllers_have_closed_forms() -> None:
    body = JointedBody("arm", Tensor(1.0, ((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.01))))
    pin = MechanismJoint("pin", "revolute", -1, 0, axis=(0.0, 0.0, 1.0), start=(0.0,), start_velocity=(0.0,))
    for joint, controllers, name in (
        (pin, (PD,), "driven joint"),
        (pin, (replace(PD, rate=500.0),), "sampled law"),
        (replace(pin, stops=Stops(-1.0, 1.0)), (), "joint between stops"),
    ):
        truth = mechanism_truth(Mechanism((body,), (joint,), (), 9.81, controllers=controllers), np.array([0.0, 0.1]))
        assert truth.model == f"closed form: {name}"
        assert truth.witnesses[0].startswith("articulated-body recursion")  # code of its own for laws and events
        assert truth.bounds.error.max() < 1e-14
    # Gravity has a moment about this axis, so that the equation is not linear.
    tilted = Mechanism((replace(body, center_of_mass=(0.1, 0.0, 0.0)),), (replace(pin, axis=(0.0, 1.0, 0.0)),), (), 9.81)
    assert form_of(tilted) is not None
    assert form_of(replace(tilted, controllers=(PD,))) is None
