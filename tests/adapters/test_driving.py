"""The efforts of controllers in a miniature engine that is exact while efforts are held: when they are computed, and act."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bodycheck.adapters import scheduling
from bodycheck.adapters.contract import EngineDiverged, ErrorControlled, Method, SceneUnsupported
from bodycheck.adapters.stepping import Loop
from bodycheck.reference.mechanisms.control import Controller, Samples, Stops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from tests.support.driven_hinge import (
    INERTIA,
    PD,
    SAMPLED,
    SAMPLED_RATE,
    Exact,
    angles,
    error_control,
    fixed_steps,
    hinge,
    rows,
)


def run(mechanism: Mechanism, timestep: float, duration: float, spelling: str = "exact") -> Exact:
    """Return the hinge after a run."""
    exact = Exact(mechanism.joints[0].start[0], mechanism.joints[0].start_velocity[0])
    method = Method.parse(spelling, timestep)
    simulation = scheduling.driven(fixed_steps(exact, timestep), mechanism, method)
    simulation.advance(np.array([0, round(duration / timestep)]))
    return exact


@pytest.mark.parametrize("timestep", [0.002, 0.001, 0.0004, 0.00025])
def test_a_sampled_law_has_its_exact_motion_at_any_step_that_divides_the_period(timestep: float) -> None:
    exact = run(hinge(replace(PD, rate=500.0)), timestep, 0.1)
    # 400 roundings at most; the rate is of the order of 10 rad/s.
    assert exact.angle == pytest.approx(SAMPLED, abs=1e-13)
    assert exact.rate == pytest.approx(SAMPLED_RATE, abs=1e-12)


def test_the_fiftieth_instant_at_500_hertz_reaches_a_tenth_of_a_second() -> None:
    """Fifty of 500 periods are less than the double 0.1, by less than 1e-9 of a period."""
    target = Samples((0.0, 0.1), (0.0, 1.0))
    exact = run(hinge(Controller(0, kp=20.0, target=target, rate=500.0)), 0.001, 0.11)
    assert next(time for time, effort in exact.applied if effort) == pytest.approx(0.1, rel=1e-12)  # a sum of steps
    linear = replace(target, between="linear")
    assert run(hinge(Controller(0, kp=20.0, target=linear, rate=500.0)), 0.001, 0.002).angle == 0


def test_samples_between_the_instants_do_not_change_the_motion() -> None:
    exact, method = Exact(), Method.parse("exact", 0.0005)
    simulation = scheduling.driven(fixed_steps(exact, 0.0005), hinge(replace(PD, rate=500.0)), method)
    seen = angles(simulation.advance(np.array([0, 1, 0, 2, 5, 91])))
    more = angles(simulation.advance(np.array([1, 100])))
    alone = run(hinge(replace(PD, rate=500.0)), 0.0005, 0.05)
    assert len(exact.applied) == 50
    assert seen[0] == 0
    assert seen[1] == seen[2]
    assert seen[-1] < more[0]
    assert more[0] == pytest.approx(alone.angle, abs=1e-15)  # of an arc tangent
    assert more[1] == pytest.approx(SAMPLED, abs=1e-13)


def test_a_delay_is_a_number_of_periods_without_effort_before() -> None:
    exact = run(hinge(replace(PD, rate=500.0, delay=3)), 0.001, 0.012)
    assert [effort for _, effort in exact.applied[:4]] == [0, 0, 0, 20]
    # Until 4 ms later, the state that the law sees is that of the start: 20 N m at rest.
    turned = [20 * (time - 0.006) ** 2 / 2 / INERTIA for time in (0.006, 0.008, 0.010, 0.012)]
    assert exact.angle == pytest.approx(turned[-1], rel=1e-12)


def test_the_integral_of_a_sampled_law_includes_the_present_error() -> None:
    exact = run(hinge(Controller(0, ki=5.0, target=1.0, rate=100.0)), 0.001, 0.02)
    moved = 5.0 * 0.01 / INERTIA * 0.01**2 / 2
    assert [effort for _, effort in exact.applied] == pytest.approx([0.05, 5 * (1 + 1 - moved) / 100], rel=1e-14)


def test_an_instant_between_steps_acts_from_the_next_step_on() -> None:
    exact = run(hinge(replace(PD, rate=500.0)), 0.0008, 0.008)
    assert [time for time, _ in exact.applied] == pytest.approx([0, 0.0024, 0.004, 0.0064], abs=1e-15)
    late = scheduling.lateness(hinge(replace(PD, rate=500.0)), Method.parse("exact", 0.0008), 0.1)
    assert late == {"pin": pytest.approx(0.0004, rel=1e-9)}


def test_steps_at_the_instants_are_not_late_whatever_their_rounding() -> None:
    for rate, timestep in (
        (500.0, 0.002),
        (500.0, 0.0001),
        (1000.0, 0.001),
        (100.0, 0.01 / 3),
        (3.0, 1 / 30),
        (333.0, 1 / 333),
    ):
        driven = hinge(replace(PD, rate=rate))
        assert scheduling.lateness(driven, Method.parse("exact", timestep), 10.0) == {}
        exact = run(driven, timestep, 2 / rate)
        assert len(exact.applied) == 2
    assert scheduling.lateness(hinge(PD), Method.parse("exact", 0.0013), 10.0) == {}


def test_a_rate_above_that_of_the_steps_uses_the_last_result() -> None:
    assert run(hinge(replace(PD, rate=4000.0)), 0.001, 0.05).angle == run(hinge(replace(PD, rate=1000.0)), 0.001, 0.05).angle
    late = scheduling.lateness(hinge(replace(PD, rate=4000.0)), Method.parse("exact", 0.001), 0.05)
    assert late == {"pin": pytest.approx(0.00075, rel=1e-9)}


def test_a_continuous_law_is_held_over_each_step_of_an_engine_without_stages() -> None:
    assert run(hinge(PD), 0.002, 0.1).angle == run(hinge(replace(PD, rate=500.0)), 0.002, 0.1).angle


def test_the_integral_of_a_continuous_law_is_of_fourth_order() -> None:
    # The effort is a force that does not depend on the integral, so that the hinge moves exactly.
    controller = Controller(0, ki=1e-30, effort=0.3, target=Samples((0.0, 0.05, 0.2), (0.0, 2.0, 1.0), "linear"))
    followers = []
    for timestep in (0.05, 0.01):
        exact = Exact(rate=0.4)
        simulation = scheduling.driven(
            fixed_steps(exact, timestep), hinge(controller, rate=0.4), Method.parse("exact", timestep)
        )
        assert isinstance(simulation, scheduling.Scheduled)
        simulation.advance(np.array([round(0.2 / timestep), 1]))
        followers.append(simulation.controls.followers[0])
    # At 0.2 s: the table has 0.05 + 0.225 rad s, and the angle is 0.4 t + 15 t^2.
    assert followers[0].integral == pytest.approx(0.275 - 0.2 * 0.2**2 - 5 * 0.2**3, rel=1e-13)
    assert followers[0].time == pytest.approx(0.2, abs=1e-15)


def test_elastic_stops_are_efforts_with_limits_effort() -> None:
    stops = Stops(None, 0.1, None, 40.0, 0.0)
    exact = run(hinge(stops=stops, rate=2.0), 1e-5, 0.2, "exact:limits=effort")
    # Half a swing of the spring gives the velocity back; holding the effort over a step changes it by 1e-5 s of the swing.
    assert exact.rate == pytest.approx(-2.0, rel=1e-3)
    assert run(hinge(stops=stops, rate=2.0), 1e-3, 0.2).rate == 2.0


def test_error_control_ends_its_steps_at_the_instants() -> None:
    driven, method = hinge(replace(PD, rate=500.0)), Method.parse("exact:accuracy=0.001", 0.02)
    exact = Exact()
    simulation = scheduling.driven(error_control(exact, 0.02), driven, method)
    assert isinstance(simulation, ErrorControlled)
    seen = angles(simulation.reach(np.array([0.0, 0.0333, 0.05, 0.1])))
    assert [time for time, _ in exact.applied] == pytest.approx([0.002 * k for k in range(50)], abs=1e-15)
    assert seen[-1] == pytest.approx(SAMPLED, abs=1e-13)
    finished = Exact()
    simulation = scheduling.driven(error_control(finished, 0.02), driven, method)
    assert isinstance(simulation, ErrorControlled)
    simulation.finish(0.1)
    assert finished.angle == pytest.approx(SAMPLED, abs=1e-13)
    assert simulation.work.steps == 1
    advanced = scheduling.driven(error_control(Exact(), 0.02), driven, method).advance(np.array([0, 2, 3]))
    assert angles(advanced)[-1] == pytest.approx(SAMPLED, abs=1e-13)


def test_error_control_takes_a_sample_within_the_slack_as_the_instant() -> None:
    exact = Exact()
    simulation = scheduling.driven(
        error_control(exact, 0.02), hinge(replace(PD, rate=10.0)), Method.parse("e:accuracy=0.1", 0.02)
    )
    assert isinstance(simulation, ErrorControlled)
    simulation.reach(np.array([0.1 + 1e-15, 0.2 - 1e-15, 0.25]))
    assert [time for time, _ in exact.applied] == [0.0, 0.1 + 1e-15, 0.2 - 1e-15]


def test_error_control_refuses_laws_that_it_would_hold_for_steps_of_unknown_length() -> None:
    with pytest.raises(SceneUnsupported, match="computed at each step"):
        scheduling.driven(error_control(Exact(), 0.02), hinge(PD), Method.parse("exact:accuracy=0.001", 0.02))


def test_a_simulation_that_takes_no_efforts_is_refused() -> None:
    still = Loop(np.zeros(2), lambda state: state, np.copy, rows)
    with pytest.raises(SceneUnsupported, match="efforts of controllers"):
        scheduling.driven(still, hinge(PD), Method.parse("exact", 0.001))
    assert scheduling.driven(still, hinge(), Method.parse("exact", 0.001)) is still


def test_a_failure_keeps_the_states_of_all_samples_before_it() -> None:
    exact = Exact(most=0.5)
    simulation = scheduling.driven(fixed_steps(exact, 0.001), hinge(replace(PD, rate=500.0)), Method.parse("exact", 0.001))
    with pytest.raises(EngineDiverged) as caught:
        simulation.advance(np.array([0, 5, 5, 5, 50]))
    seen = angles(caught.value.states)
    assert len(seen) >= 4
    assert (np.diff(seen) > 0).all()
    assert seen[-1] > 0.5


def test_instants_are_compared_as_rationals() -> None:
    # 0.1 is a double above 1 / 10, so that the third step of 0.1 s begins later than 3 / 10 s by rounding, and reaches it.
    controls = scheduling.driven(fixed_steps(Exact(), 0.1), hinge(replace(PD, rate=10.0)), Method.parse("exact", 0.1))
    assert isinstance(controls, scheduling.Scheduled)
    sampler = controls.controls.samplers[0]
    sampler.instants = 3
    assert sampler.instant == Fraction(3, 10)
    assert controls.controls.following(2, 10, 0.1) == 3
