"""Trees with controllers and stops: against known values, and against equations written by hand that SciPy integrates."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.reference.errors import NotModelled, OutOfReach, Stopped
from bodycheck.reference.mechanisms.certificate import certify_mechanism
from bodycheck.reference.mechanisms.control import Controller, Samples, Sine, Stops
from bodycheck.reference.mechanisms.followed import by_recursion, followed
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism, Mimic
from bodycheck.reference.mechanisms.observables import observe
from bodycheck.reference.mechanisms.recursion import follow
from bodycheck.reference.mechanisms.ways import apart
from bodycheck.reference.mechanisms.witnesses import witness_of
from bodycheck.reference.trajectory import Array, Trajectory
from tests.reference.mechanisms.hybrid import by_hand
from tests.reference.mechanisms.hybrid.by_hand import ARM, PENDULUM
from tests.support.jointed import body

pytest.importorskip("heyoka")

#: The accuracy of SciPy's integration at its smallest tolerance, which sees the kinks of saturated laws and elastic stops.
BY_HAND = 1e-8

HINGE = Mechanism(
    (body("arm", 1.0, (0.01, 0.01, 0.01)),),
    (Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,)),),
)
PD = Controller(0, kp=20.0, kd=0.4, target=1.0)


def states(mechanism: Mechanism, until: float) -> tuple[Array, Array]:
    """The coordinates and velocities of a tree at a time."""
    motion = follow(mechanism, np.array([until]))
    return motion.position[0].astype(float), motion.velocity[0].astype(float)


def stopped(mechanism: Mechanism, *stops: Stops | None) -> Mechanism:
    joints = tuple(replace(joint, stops=each) for joint, each in zip(mechanism.joints, stops, strict=True))
    return replace(mechanism, joints=joints)


def started(mechanism: Mechanism) -> tuple[Array, Array]:
    return np.array([joint.start[0] for joint in mechanism.joints]), np.array(
        [joint.start_velocity[0] for joint in mechanism.joints]
    )


def test_a_continuous_and_a_sampled_law_on_a_hinge_have_the_known_values() -> None:
    continuous, _ = states(replace(HINGE, controllers=(PD,)), 0.1)
    sampled, rate = states(replace(HINGE, controllers=(replace(PD, rate=500.0),)), 0.1)
    assert abs(continuous[0] - 1.1396720845937189) < 1e-15
    assert abs(sampled[0] - 1.1333289750980506) < 1e-15
    assert abs(rate[0] + 5.79412483285462) < 1e-14


def test_a_sampled_law_with_delay_and_integral_is_the_recurrence_of_its_definition() -> None:
    controller = replace(PD, ki=50.0, rate=100.0, delay=2, effort=Sine(0.5, 3.0), effort_limit=6.0, no_load_speed=12.0)
    q, v, total, waiting = 0.0, 0.0, 0.0, [0.0, 0.0]
    for k in range(40):
        total += 1.0 - q
        effort = 20.0 * (1.0 - q) - 0.4 * v + 50.0 * total / 100.0 + 0.5 * math.sin(0.03 * k)
        line = 6.0 * max(0.0, 1.0 - abs(v) / 12.0)
        high, low = (line, -6.0) if v > 0 else (6.0, -line)
        waiting.append(min(max(effort, low), high))
        a = waiting.pop(0) / 0.01
        q, v = q + 0.01 * v + a * 0.01**2 / 2, v + 0.01 * a
    motion = states(replace(HINGE, controllers=(controller,)), 0.4)
    assert abs(motion[0][0] - q) < 1e-12
    assert abs(motion[1][0] - v) < 1e-11


def law(controller: Controller, wanted: Callable[[float, float, float], float]) -> Callable[[float, float, float], float]:
    """The saturated effort of a law, from the time, the coordinate and the velocity."""

    def effort(t: float, q: float, v: float) -> float:
        limit, speed = controller.effort_limit or math.inf, controller.no_load_speed or math.inf
        along = limit * max(0.0, 1.0 - abs(v) / speed)
        high, low = (along, limit) if v > 0 else (limit, along)
        return min(max(wanted(t, q, v), -low), high)

    return effort


@pytest.mark.parametrize("speed", [None, 4.0])
def test_a_saturated_continuous_law_is_that_by_hand(speed: float | None) -> None:
    target = Sine(0.5, 3.0, 0.25, 1.5)
    controller = Controller(0, kp=20.0, kd=0.4, target=target, effort_limit=6.0, no_load_speed=speed)
    effort = law(controller, lambda t, q, v: 20.0 * (1.5 + 0.5 * math.sin(3.0 * t + 0.25) - q) - 0.4 * v)
    by_scipy = by_hand.follow(*started(PENDULUM), 2.0, lambda t, q, v: np.array([effort(t, q[0], v[0])]))
    motion = states(replace(PENDULUM, controllers=(controller,)), 2.0)
    np.testing.assert_allclose(np.concatenate(motion), np.concatenate(by_scipy), rtol=0, atol=BY_HAND)


@pytest.mark.parametrize("between", ["hold", "linear"])
def test_a_continuous_law_with_a_table_and_an_integral_is_that_by_hand(between: str) -> None:
    table = Samples((0.25, 0.75, 1.0), (0.0, 1.0, -0.5), "hold" if between == "hold" else "linear")
    controller = Controller(0, kp=20.0, kd=1.0, ki=8.0, target=table)

    def target(t: float) -> float:
        if between == "linear":
            return float(np.interp(t, table.times, table.values))
        return float(table.values[max(int(np.searchsorted(table.times, t, "right")) - 1, 0)])

    # The integral is the coordinate of a second, massless joint in the equations by hand: here it is summed beside them.
    from scipy.integrate import solve_ivp

    def rates(t: float, y: Array) -> list[float]:
        q, v, total = y
        inside = min(max(t, begin + 1e-12), end - 1e-12)
        error = target(inside) - q
        force = by_hand.forces(np.array([q]), np.array([v]))[0] + 20.0 * error - v + 8.0 * total
        return [v, force / by_hand.mass_matrix(np.array([q]))[0, 0], error]

    y = [1.0, 0.0, 0.0]
    for begin, end in ((0.0, 0.25), (0.25, 0.75), (0.75, 1.0), (1.0, 1.5)):
        y = solve_ivp(rates, (begin, end), y, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    motion = states(replace(PENDULUM, controllers=(controller,)), 1.5)
    np.testing.assert_allclose(np.concatenate(motion), y[:2], rtol=0, atol=BY_HAND)


def test_an_arm_with_sampled_saturated_laws_is_that_by_hand() -> None:
    laws = (
        Controller(0, kp=60.0, kd=4.0, target=0.5, rate=100.0, effort_limit=10.0),
        Controller(1, kp=20.0, kd=1.0, target=-0.5, rate=100.0, effort_limit=4.0),
    )
    q, v = started(ARM)
    for k in range(200):
        wanted = np.array([60.0, 20.0]) * (np.array([0.5, -0.5]) - q) - np.array([4.0, 1.0]) * v
        held = np.clip(wanted, [-10.0, -4.0], [10.0, 4.0])
        q, v = by_hand.follow(q, v, (k + 1) / 100, lambda t, q, v, held=held: held, begin=k / 100)  # type: ignore[misc]
    motion = states(replace(ARM, controllers=laws), 2.0)
    np.testing.assert_allclose(np.concatenate(motion), np.concatenate([q, v]), rtol=0, atol=BY_HAND)


@pytest.mark.parametrize("damping", [0.0, 4.0])
def test_elastic_stops_push_and_never_pull(damping: float) -> None:
    def effort(t: float, q: Array, v: Array) -> Array:
        low, high = 0.2 - q[0], q[0] - 1.25
        push = max(0.0, 400.0 * low - damping * v[0]) if low > 0 else 0.0
        pull = max(0.0, 400.0 * high + damping * v[0]) if high > 0 else 0.0
        return np.array([push - pull])

    mechanism = replace(PENDULUM, joints=(replace(PENDULUM.joints[0], start_velocity=(3.0,)),))
    by_scipy = by_hand.follow(*started(mechanism), 2.0, effort)
    motion = states(stopped(mechanism, Stops(0.2, 1.25, None, 400.0, damping)), 2.0)
    np.testing.assert_allclose(np.concatenate(motion), np.concatenate(by_scipy), rtol=0, atol=BY_HAND)


def test_a_pendulum_rebounds_from_a_rigid_stop() -> None:
    stop = Stops(0.2, None, 0.5)
    by_scipy = by_hand.follow(*started(PENDULUM), 1.25, lambda t, q, v: np.zeros(1), by_hand.rigid([stop]))
    motion = states(stopped(PENDULUM, stop), 1.25)
    np.testing.assert_allclose(np.concatenate(motion), np.concatenate(by_scipy), rtol=0, atol=BY_HAND)


def test_an_impact_takes_the_energy_that_its_restitution_says() -> None:
    mechanism = stopped(PENDULUM, Stops(0.2, None, 0.5))
    motion = follow(mechanism, np.array([0.5, 0.9]))
    angle, rate = motion.position[:, 0].astype(float), motion.velocity[:, 0].astype(float)
    energy = by_hand.mass_matrix(angle[:1])[0, 0] * rate**2 / 2 + 9.81 * 0.5 * (np.cos(0.2) - np.cos(angle))
    assert motion.velocity[0, 0] > 0  # between the first impact and the second one
    before = 9.81 * 0.5 * (math.cos(0.2) - math.cos(1.0))
    assert abs(energy[0] - before / 4) < 1e-14 * before


def test_a_pendulum_rests_at_a_stop_until_its_controller_pulls_it_off() -> None:
    stop, controller = Stops(0.2, None, 0.0), Controller(0, law="effort", effort=Sine(8.0, 2.0, 0.0, -2.0))
    by_scipy = by_hand.follow(
        *started(PENDULUM), 1.5, lambda t, q, v: np.array([8.0 * math.sin(2.0 * t) - 2.0]), by_hand.rigid([stop])
    )
    mechanism = replace(stopped(PENDULUM, stop), controllers=(controller,))
    np.testing.assert_allclose(np.concatenate(states(mechanism, 1.5)), np.concatenate(by_scipy), rtol=0, atol=BY_HAND)
    held = follow(stopped(PENDULUM, stop), np.linspace(1.0, 3.0, 5))
    assert (held.position[:, 0] == np.longdouble(0.2)).all()
    assert (held.velocity[:, 0] == 0).all()


@pytest.mark.parametrize("restitutions", [(1.0, 1.0), (1.0, 0.0), (0.0, 0.5)])
def test_impacts_of_an_arm_are_those_by_hand(restitutions: tuple[float, float]) -> None:
    stops = [Stops(-0.5, None, restitutions[0]), Stops(-0.4, 0.6, restitutions[1])]
    by_scipy = by_hand.follow(*started(ARM), 0.7, lambda t, q, v: np.zeros(2), by_hand.rigid(stops))
    motion = states(stopped(ARM, *stops), 0.7)
    np.testing.assert_allclose(np.concatenate(motion), np.concatenate(by_scipy), rtol=0, atol=BY_HAND)


def test_the_mirror_image_of_a_scene_moves_as_the_mirror_image() -> None:
    laws = (
        Controller(0, kp=30.0, kd=1.0, ki=3.0, target=0.25, effort_limit=7.0, no_load_speed=5.0),
        Controller(1, kp=10.0, target=Sine(0.5, 4.0), rate=50.0, delay=1),
    )
    scene = replace(stopped(ARM, Stops(-0.25, 1.5, 1.0), Stops(-0.5, 0.75, None, 300.0, 2.0)), controllers=laws)
    joints = tuple(
        replace(
            joint,
            start=(-joint.start[0],),
            stops=replace(joint.stops, lower=-joint.stops.upper, upper=-joint.stops.lower)
            if joint.stops and joint.stops.lower is not None and joint.stops.upper is not None
            else None,
        )
        for joint in scene.joints
    )
    mirrored = replace(
        scene, joints=joints, controllers=(replace(laws[0], target=-0.25), replace(laws[1], target=Sine(-0.5, 4.0)))
    )
    times = np.linspace(0.0, 1.0, 6)
    one, other = follow(scene, times), follow(mirrored, times)
    np.testing.assert_allclose(one.position.astype(float), -other.position.astype(float), rtol=0, atol=1e-15)
    np.testing.assert_allclose(one.velocity.astype(float), -other.velocity.astype(float), rtol=0, atol=1e-14)


def test_rebounds_that_accumulate_end_the_truth() -> None:
    with pytest.raises(Stopped, match="accumulate"):
        follow(stopped(PENDULUM, Stops(0.2, None, 0.5)), np.array([3.0]))


def test_two_stops_at_one_instant_are_refused_where_the_order_matters() -> None:
    start = tuple(replace(joint, start=(0.5,), start_velocity=(1.0,)) for joint in ARM.joints)
    scene = stopped(replace(ARM, joints=start), Stops(None, 0.5, 0.5), Stops(None, 0.5, 0.5))
    with pytest.raises(OutOfReach, match="order"):
        follow(scene, np.array([0.1]))


def test_the_bound_holds_and_impacts_do_not_blow_it_up() -> None:
    mechanism = stopped(PENDULUM, Stops(0.2, None, 1.0))
    times = np.linspace(0.0, 2.0, 9)
    course = by_recursion(mechanism, times)
    assert course.growth is not None
    assert course.growth.of_any[-1] < 10
    import heyoka as hy

    exact = follow(mechanism, times, hy.real, 200).position[:, 0]
    off = np.array([abs(float(one - other)) for one, other in zip(exact, course.way.motion.position[:, 0], strict=True)])
    assert (off <= course.way.errors["error"]).all()
    assert course.way.errors["error"][-1] < 1e-15


def test_elastic_stops_without_damping_keep_the_energy() -> None:
    scene = stopped(ARM, Stops(-0.25, None, None, 300.0), Stops(-0.5, 0.5, None, 200.0))
    times = np.linspace(0.0, 1.0, 21)
    bodies = follow(scene, times).bodies
    parts = (bodies.position, bodies.quaternion, bodies.velocity, bodies.angular_velocity)
    energy = observe(scene, Trajectory(times, *(part.astype(float) for part in parts))).total_energy
    # The energies are rounded to some 1e-16 of their terms, of some 10 J.
    np.testing.assert_allclose(energy, energy[0], rtol=0, atol=1e-13)


def test_controllers_of_joints_that_follow_others_act_on_what_they_move() -> None:
    # The upper arm and the fore arm turn together against one another: q2 = -q1, so that the fore arm keeps its direction.
    following = replace(ARM.joints[1], start=(-1.0,), mimic=Mimic(0, -1.0, 0.0))
    scene = replace(ARM, joints=(ARM.joints[0], following))
    controller = Controller(1, kp=20.0, kd=1.0, target=0.5, rate=50.0, effort_limit=5.0)
    # The same effort on the joint that leads, with the opposite sign and law.
    same = replace(controller, joint=0, target=-0.5)
    one, other = (states(replace(scene, controllers=(each,)), 1.0) for each in (controller, same))
    np.testing.assert_allclose(np.concatenate(one), np.concatenate(other), rtol=0, atol=1e-14)
    with pytest.raises(NotModelled, match="rigid stops"):
        followed(replace(scene, joints=(ARM.joints[0], replace(following, stops=Stops(None, 0.5)))), np.array([0.1]))


#: An arm with a sampled law and a stop that is reached.
LIMITED = replace(
    stopped(ARM, None, Stops(-0.6, 0.6, 0.0)), controllers=(Controller(0, kp=20.0, kd=1.0, target=0.5, rate=50.0),)
)


def test_the_witness_of_a_driven_tree_agrees_within_the_bounds() -> None:
    times = np.linspace(0.0, 0.5, 6)
    course = followed(LIMITED, times)
    witness = witness_of(LIMITED, times, course)
    assert witness is not None
    differences = apart(LIMITED, course.way.motion, witness.motion)
    assert all((2 * course.way.errors[name] >= difference).all() for name, difference in differences.items())
    assert max(course.way.errors["error"]) < 1e-14


@pytest.mark.slow
def test_the_certificate_of_a_driven_tree_has_no_faults() -> None:
    certificate = certify_mechanism(LIMITED, np.linspace(0.0, 0.5, 6))
    assert not certificate.faults
    assert len(certificate.differences) == 3
    assert certificate.bound[-1] < 1e-14


def test_a_stop_that_is_only_touched_is_refused() -> None:
    # Half an oscillation from rest at -0.5 ends at rest at 0.5.
    joint = replace(HINGE.joints[0], start=(-0.5,), stiffness=2.0)
    scene = stopped(replace(HINGE, joints=(joint,)), Stops(None, 0.5, 1.0))
    with pytest.raises(OutOfReach):
        by_recursion(scene, np.linspace(0.0, 1.0, 5))


def test_an_impact_at_an_instant_of_a_controller_is_refused() -> None:
    joint = replace(HINGE.joints[0], start=(-0.5,), start_velocity=(1.0,))
    scene = stopped(replace(HINGE, joints=(joint,)), Stops(None, 0.0, 1.0))
    controller = Controller(0, law="effort", effort=Samples((0.0, 0.5), (0.0, 1.0)), rate=2.0)
    with pytest.raises(OutOfReach):
        by_recursion(replace(scene, controllers=(controller,)), np.linspace(0.0, 1.0, 5))
    reading = Controller(0, kd=1e-300, target_velocity=0.0, rate=2.0)
    with pytest.raises(OutOfReach):
        by_recursion(replace(scene, controllers=(reading,)), np.linspace(0.0, 1.0, 5))
