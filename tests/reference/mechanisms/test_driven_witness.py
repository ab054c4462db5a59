"""The Lagrangian as the witness of driven trees: against known values, equations by hand, the recursion, and planted faults."""

import math
import random
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.mechanisms import recursion
from bodycheck.reference.mechanisms.certificate import certify_mechanism
from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops
from bodycheck.reference.mechanisms.hybrid import beginning, cells, sampled
from bodycheck.reference.mechanisms.lagrangian import solution
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array
from tests.reference.mechanisms.hybrid import by_hand
from tests.reference.mechanisms.hybrid.by_hand import ARM
from tests.support.jointed import body

pytest.importorskip("heyoka")

#: The accuracy of the equations by hand, which SciPy integrates over the kinks of laws at its smallest tolerance.
BY_HAND = 1e-8

#: The accuracy of DOP853 in a motion of some turns.
DOUBLES = 1e-11

HINGE = Mechanism(
    (body("arm", 1.0, (0.01, 0.01, 0.01)),),
    (Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,)),),
)
PD = Controller(0, kp=20.0, kd=0.4, target=1.0)
SHOULDER = Controller(0, kp=60.0, kd=4.0, target=Sine(0.5, 3.0, 0.25, 0.1))
ELBOW = Controller(1, kp=20.0, kd=1.0, target=Samples((0.1, 0.5, 0.8), (0.5, -0.5, 0.25), "linear"))

#: A follower of the Lagrangian.
Follow = Callable[[Mechanism, Array], Any]


def states(mechanism: Mechanism, until: float, follow: Follow = solution.follow) -> Array:
    """The coordinates and velocities of joints at a time."""
    motion = follow(mechanism, np.array([until]))
    return np.concatenate([motion.joint_position[0], motion.joint_velocity[0]]).astype(float)


def stopped(mechanism: Mechanism, *stops: Stops | None, **values: Any) -> Mechanism:
    joints = zip(mechanism.joints, stops, strict=True)
    return replace(mechanism, joints=tuple(replace(joint, stops=each, **values) for joint, each in joints))


def started(mechanism: Mechanism) -> tuple[Array, Array]:
    joints = mechanism.joints
    return np.array([joint.start[0] for joint in joints]), np.array([joint.start_velocity[0] for joint in joints])


@pytest.mark.parametrize(("follow", "room"), [(solution.follow, 1e-15), (solution.follow_in_doubles, 1e-13)])
def test_a_driven_hinge_has_the_known_values(follow: Follow, room: float) -> None:
    assert abs(states(replace(HINGE, controllers=(PD,)), 0.1, follow)[0] - 1.1396720845937189) < room
    angle, rate = states(replace(HINGE, controllers=(replace(PD, rate=500.0),)), 0.1, follow)
    assert abs(angle - 1.1333289750980506) < room
    assert abs(rate + 5.79412483285462) < 10 * room


def test_the_fiftieth_instant_at_500_hertz_reaches_a_tenth_of_a_second() -> None:
    """Fifty of 500 periods are less than the double 0.1, by less than 1e-9 of a period."""

    def angles(time: float) -> Array:
        held = replace(PD, rate=500.0, target=Samples((0.0, time), (0.0, 1.0)))
        mechanism, end = replace(ARM, controllers=(held,)), np.array([0.102])
        ways = solution.follow(mechanism, end).joint_position, recursion.follow(mechanism, end).position
        return np.concatenate(ways).astype(float)

    np.testing.assert_array_equal(angles(0.1), angles(0.0995))
    assert np.abs(angles(0.1) - angles(0.1001)).max(axis=1).min() > 1e-6  # the start of the effect of 20 N m in 2 ms


def value(signal: Signal, t: float) -> float:
    """The value of a signal in double precision."""
    match signal:
        case Sine():
            return signal.offset + signal.amplitude * math.sin(signal.angular_frequency * t + signal.phase)
        case Samples(between="linear"):
            return float(np.interp(t, signal.times, signal.values))
        case Samples():
            return signal.values[max(int(np.searchsorted(signal.times, t, "right")) - 1, 0)]
    return signal


def exerted(law: Controller, t: float, q: float, v: float, total: float = 0.0) -> float:
    """The saturated effort of a law, in double precision. total: the integral of the error."""
    error = value(law.target, t) - q
    wanted = law.kp * error + law.kd * (value(law.target_velocity, t) - v) + law.ki * total + value(law.effort, t)
    against = law.effort_limit or math.inf
    along = against * max(0.0, 1.0 - abs(v) / (law.no_load_speed or math.inf))
    high, low = (along, against) if v > 0 else (against, along)
    return min(max(wanted, -low), high)


LAWS = {
    "saturated": (replace(SHOULDER, effort_limit=10.0), replace(ELBOW, effort_limit=2.0)),
    "torque-speed line": (replace(SHOULDER, effort_limit=20.0, no_load_speed=3.0), replace(ELBOW, ki=4.0)),
    "delayed": (replace(SHOULDER, delay=2, effort=Sine(3.0, 5.0)), replace(ELBOW, delay=1, effort_limit=3.0)),
}


@pytest.mark.parametrize("name", LAWS)
def test_an_arm_with_sampled_laws_is_that_by_hand(name: str) -> None:
    laws = tuple(replace(law, rate=100.0) for law in LAWS[name])
    (q, v), totals, waiting = started(ARM), [0.0, 0.0], [[0.0] * law.delay for law in laws]
    for k in range(100):
        held = np.empty(2)
        for law in laws:
            totals[law.joint] += (value(law.target, k / 100) - q[law.joint]) / 100
            waiting[law.joint].append(exerted(law, k / 100, q[law.joint], v[law.joint], totals[law.joint]))
            held[law.joint] = waiting[law.joint].pop(0)
        q, v = by_hand.follow(q, v, (k + 1) / 100, lambda t, q, v, held=held: held, begin=k / 100)  # type: ignore[misc]
    np.testing.assert_allclose(states(replace(ARM, controllers=laws), 1.0), [*q, *v], rtol=0, atol=BY_HAND)


@pytest.mark.parametrize("name", ["saturated", "torque-speed line"])
def test_an_arm_with_continuous_laws_is_that_by_hand(name: str) -> None:
    laws = tuple(replace(law, ki=0.0) for law in LAWS[name])
    mechanism = replace(ARM, controllers=laws)
    q, v = by_hand.follow(
        *started(ARM), 1.0, lambda t, q, v: np.array([exerted(law, t, q[law.joint], v[law.joint]) for law in laws])
    )
    np.testing.assert_allclose(states(mechanism, 1.0), [*q, *v], rtol=0, atol=BY_HAND)
    np.testing.assert_allclose(states(mechanism, 1.0, solution.follow_in_doubles), [*q, *v], rtol=0, atol=BY_HAND)


@pytest.mark.parametrize("damping", [0.0, 4.0])
def test_elastic_stops_push_and_never_pull(damping: float) -> None:
    def effort(t: float, q: Array, v: Array) -> Array:
        low, high = 0.2 - q[0], q[0] - 1.25
        return np.array(
            [max(0.0, 400.0 * low - damping * v[0]) * (low > 0) - max(0.0, 400.0 * high + damping * v[0]) * (high > 0), 0.0]
        )

    mechanism = stopped(ARM, Stops(0.2, 1.25, None, 400.0, damping), None)
    by_scipy = np.concatenate(by_hand.follow(*started(ARM), 1.0, effort))
    for follow in (solution.follow, solution.follow_in_doubles):
        np.testing.assert_allclose(states(mechanism, 1.0, follow), by_scipy, rtol=0, atol=BY_HAND)


@pytest.mark.parametrize("restitutions", [(1.0, 1.0), (1.0, 0.0), (0.0, 0.5)])
def test_an_arm_rebounds_from_rigid_stops_and_rests_at_them(restitutions: tuple[float, float]) -> None:
    stops = Stops(-0.5, None, restitutions[0]), Stops(-0.4, 0.6, restitutions[1])
    by_scipy = np.concatenate(by_hand.follow(*started(ARM), 0.7, lambda t, q, v: np.zeros(2), by_hand.rigid(stops)))
    for follow in (solution.follow, solution.follow_in_doubles):
        np.testing.assert_allclose(states(stopped(ARM, *stops), 0.7, follow), by_scipy, rtol=0, atol=BY_HAND)


def test_a_start_that_moves_outwards_on_a_stop_is_an_impact() -> None:
    plain = stopped(HINGE, Stops(None, 0.0, 0.5), start_velocity=(2.0,))
    np.testing.assert_array_equal(states(plain, 0.5), [-0.5, -1.0])
    np.testing.assert_array_equal(states(stopped(plain, Stops(0.0, None, 0.5)), 0.5), [1.0, 2.0])


def test_rebounds_that_accumulate_and_stops_that_are_reached_together_are_refused() -> None:
    falling = stopped(by_hand.PENDULUM, Stops(0.2, None, 0.5))
    both = stopped(ARM, Stops(None, 0.5, 0.5), Stops(None, 0.5, 0.5), start=(0.5,), start_velocity=(1.0,))
    for mechanism, text in ((falling, "accumulate"), (both, "order")):
        with pytest.raises(OutOfReach, match=text):
            solution.follow(mechanism, np.array([3.0]))


def test_a_sampled_controller_moves_a_hinge_with_dry_friction_as_the_steps_by_hand() -> None:
    """Between two instants the force is constant, so that the motion follows from a parabola or two, or does not begin."""
    inertia, friction, period = Fraction(0.01), Fraction(0.75), Fraction(1, 50)
    q, v = Fraction(0), Fraction(0)
    for _ in range(40):
        force, left = 20 * (1 - q) - Fraction(0.4) * v, period
        while left:
            sign = (v > 0) - (v < 0) or ((force > friction) - (force < -friction))
            a = (force - sign * friction) / inertia if sign else Fraction(0)
            step = min(left, -v / a) if v and a * v < 0 else left
            q, v, left = q + v * step + a * step**2 / 2, v + a * step, left - step
    mechanism = stopped(replace(HINGE, controllers=(replace(PD, rate=50.0),)), None, friction=0.75)
    np.testing.assert_allclose(states(mechanism, 0.8), [float(q), float(v)], rtol=0, atol=1e-14)
    np.testing.assert_allclose(states(mechanism, 0.8, solution.follow_in_doubles), [float(q), float(v)], rtol=0, atol=DOUBLES)


def random_signal(chance: random.Random, size: float) -> Signal:
    kind = chance.randrange(4)
    if kind == 0:
        return round(chance.uniform(-size, size), 2)
    if kind == 1:
        amplitude, frequency = round(chance.uniform(0.2, size), 2), round(chance.uniform(1, 6), 2)
        return Sine(amplitude, frequency, round(chance.uniform(-1, 1), 2), round(chance.uniform(-0.3, 0.3), 2))
    times = tuple(round(0.1 + 0.3 * index + 0.05 * chance.random(), 3) for index in range(4))
    return Samples(times, tuple(round(chance.uniform(-size, size), 2) for _ in times), "hold" if kind == 2 else "linear")


def random_controller(chance: random.Random, joint: int) -> Controller:
    law = Controller(
        joint,
        kp=chance.choice([10.0, 30.0]),
        kd=chance.choice([0.5, 2.0]),
        ki=chance.choice([0.0, 5.0]),
        target=random_signal(chance, 0.8),
        target_velocity=chance.choice([0.0, random_signal(chance, 0.5)]),
        effort=chance.choice([0.0, random_signal(chance, 2.0)]),
    )
    if chance.random() < 0.5:
        law = replace(law, rate=chance.choice([50.0, 100.0, 75.5]), delay=chance.choice([0, 1]))
    if chance.random() < 0.6:
        law = replace(law, effort_limit=round(chance.uniform(1, 8), 1))
    if law.effort_limit and chance.random() < 0.5:
        law = replace(law, no_load_speed=round(chance.uniform(1, 6), 1))
    return law


def random_stops(chance: random.Random, start: float) -> Stops | None:
    lower, upper = round(start - chance.uniform(0.1, 0.4), 2), round(start + chance.uniform(0.1, 0.4), 2)
    kind = chance.random()
    if kind < 0.25:
        return Stops(lower, upper, chance.choice([0.0, 1.0]))
    return Stops(lower, upper, None, chance.choice([100.0, 400.0]), chance.choice([0.0, 2.0])) if kind < 0.5 else None


def random_tree(seed: int) -> Mechanism:
    """A driven tree of one to three bodies."""
    chance = random.Random(seed)
    bodies, joints, laws = [], [], []
    for index in range(chance.randrange(1, 4)):
        start, mass = round(chance.uniform(-0.4, 0.4), 2), round(chance.uniform(0.4, 1.5), 2)
        bodies.append(body(f"b{index}", mass, (0.02, 0.025, 0.03), (0.05, 0.0, round(chance.uniform(-0.3, -0.1), 2))))
        joint = Joint(
            f"j{index}",
            "revolute" if chance.random() < 0.75 else "prismatic",
            chance.choice([WORLD, *range(index)]),
            index,
            position=(0.1 * index, 0.0, -0.3 * (index > 0)),
            axis=chance.choice([(0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.6, 0.8, 0.0)]),
            start=(start,),
            start_velocity=(round(chance.uniform(-1, 1), 2),),
            damping=chance.choice([0.0, 0.1]),
            friction=chance.choice([0.0, 0.0, 0.0, 0.4]),
            stops=random_stops(chance, start),
        )
        joints.append(joint)
        if chance.random() < 0.85:
            laws.append(random_controller(chance, index))
    return Mechanism(tuple(bodies), tuple(joints), gravity=9.81, controllers=tuple(laws))


def disagreement(mechanism: Mechanism, times: Array) -> float | None:
    """The largest difference of coordinates by the Lagrangian and the recursion; None if one of them refuses the motion."""
    try:
        one, other = solution.follow(mechanism, times), recursion.follow(mechanism, times)
    except OutOfReach:
        return None
    return float(np.abs(one.joint_position - other.position).max())


def test_the_two_ways_follow_random_driven_trees_alike() -> None:
    apart = [disagreement(random_tree(seed), np.linspace(0.0, 0.75, 4)) for seed in range(6)]
    assert sum(each is not None for each in apart) >= 4
    # Some thousand roundings of 80 bits, since errors grow where a delayed law is unstable.
    assert all(each < 1e-15 for each in apart if each is not None), apart


@pytest.mark.slow
def test_the_two_ways_follow_twenty_random_driven_trees_alike() -> None:
    apart = [disagreement(random_tree(seed), np.linspace(0.0, 0.75, 4)) for seed in range(6, 36)]
    assert sum(each is not None for each in apart) >= 20
    assert all(each < 1e-15 for each in apart if each is not None), apart


#: An arm with all that the planted faults concern.
FAULTY = replace(
    stopped(ARM, Stops(0.2, 1.25, None, 400.0, 20.0), None),
    controllers=(
        replace(SHOULDER, rate=100.0, target_velocity=0.5),
        replace(ELBOW, rate=100.0, delay=1, target=Sine(0.5, 3.0), effort=2.0, effort_limit=3.0),
    ),
)
TIMES = np.linspace(0.0, 0.5, 3)


def of_another(change: Callable[[Controller], Controller]) -> Callable[[pytest.MonkeyPatch], None]:
    """A fault by which the recursion follows laws that are changed."""

    def plant(monkeypatch: pytest.MonkeyPatch) -> None:
        right = recursion.follow

        def wrong(mechanism: Mechanism, *given: Any) -> Any:
            return right(replace(mechanism, controllers=tuple(change(law) for law in mechanism.controllers)), *given)

        monkeypatch.setattr(recursion, "follow", wrong)

    return plant


def at_the_end(law: Controller) -> Controller:
    """A law whose target is that of the end of the period."""
    if not isinstance(law.target, Sine) or law.rate is None:
        return law
    return replace(law, target=replace(law.target, phase=law.target.phase + law.target.angular_frequency / law.rate))


def saturated_too_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """Saturate a law before its feed-forward is added."""
    right = sampled.computed

    def wrong(controller: Controller, memory: Any, given: tuple[Any, Any, Any], q: Any, v: Any) -> Any:
        after = right(replace(controller, delay=0), replace(memory, waiting=()), (given[0], given[1], 0 * given[2]), q, v)
        waiting = (*memory.waiting, after.acting + given[2])
        if len(waiting) <= controller.delay:
            return replace(after, waiting=waiting, acting=memory.acting)
        return replace(after, waiting=waiting[1:], acting=waiting[0])

    monkeypatch.setattr(beginning, "computed", wrong)


def pulling(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let an elastic stop pull with its damping while the joint returns from it."""
    right = beginning.elastic

    def wrong(stops: Stops, beyond: tuple[Any, Any], v: Any) -> cells.Cell:
        for side, x, place in zip((-1, 1), beyond, (stops.lower, stops.upper), strict=True):
            if place is not None and x > 0:
                inside = cells.Margin(side, MP.mpf(place))
                return cells.Cell((inside,), force=stops.stiffness * place, stiffness=stops.stiffness, damping=stops.damping)
        return right(stops, beyond, v)

    monkeypatch.setattr(beginning, "elastic", wrong)


FAULTS: dict[str, Callable[[pytest.MonkeyPatch], None]] = {
    "kd on the absolute velocity": of_another(lambda law: replace(law, target_velocity=0.0)),
    "hold at the end": of_another(at_the_end),
    "saturation before feed-forward": saturated_too_early,
    "delay off by one": of_another(lambda law: replace(law, delay=law.delay + 1)),
}


def test_without_a_fault_the_witness_and_the_truth_agree() -> None:
    checked = certify_mechanism(FAULTY, TIMES)
    assert checked.certified, checked.faults
    assert checked.truth.bounds.error[-1] < 1e-12


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_of_the_truth_is_a_disagreement_beyond_both_bounds(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    FAULTS[fault](monkeypatch)
    require_found(FAULTY, TIMES)


def test_a_stop_of_the_truth_that_pulls_is_a_disagreement_beyond_both_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    pulling(monkeypatch)
    require_found(stopped(ARM, Stops(0.2, 1.25, None, 400.0, 4.0), None), 2 * TIMES)


def require_found(mechanism: Mechanism, times: Array) -> None:
    """Require that the witness contradicts the truth of a mechanism, and that the bound shows it."""
    checked = certify_mechanism(mechanism, times)
    assert not checked.certified
    assert any("Euler-Lagrange" in text for text in checked.faults)
    assert checked.truth.bounds.error[-1] > 1e-4
