"""The decisions which joints with dry friction stick: exact where the file decides, each way by itself, and in the bounds."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.bounds import STATES
from bodycheck.reference.certificate import certify
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.mechanisms import recursion
from bodycheck.reference.mechanisms.followed import with_doubts
from bodycheck.reference.mechanisms.friction import stick_slip
from bodycheck.reference.mechanisms.growth import Growth
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.truths import Truth
from tests.support.jointed import body

pytest.importorskip("heyoka")

TIMES = np.linspace(0.0, 100.0, 11)

#: A wheel of 0.04 kg m^2 that turns at 10 rad/s stops after 2.5 s by this friction.
AXLE = Joint("axle", "revolute", 0, 1, axis=(0.0, 0.0, 1.0), friction=0.16, start=(0.0,), start_velocity=(10.0,))


def slider(friction: float, velocity: float = 0.0) -> Mechanism:
    """A slider on which 1 N acts, with a wheel that stops by friction after 2.5 s; together they have 2 kg."""
    rail = Joint("rail", "prismatic", WORLD, 0, axis=(1.0, 0.0, 0.0), friction=friction, effort=1.0, start=(0.0,))
    bodies = body("slider", 1.5, (0.1, 0.1, 0.1)), body("wheel", 0.5, (0.02, 0.02, 0.04))
    return Mechanism(bodies, (replace(rail, start_velocity=(velocity,)), AXLE), gravity=0.0)


def position(found: Truth) -> Fraction:
    assert found.joints is not None
    return Fraction(float(found.joints.position[-1, 0]))


@pytest.mark.parametrize("less", [1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 0.0, -1e-13])
def test_the_numbers_of_the_file_decide_whether_a_joint_sticks(less: float) -> None:
    friction = 1.0 - less
    found = mechanism_truth(slider(friction), TIMES)
    # The friction is a double, and 1 minus it is exact.
    exact = max(1 - Fraction(friction), Fraction(0)) / 2 * 100**2 / 2
    assert [name.partition(",")[0] for name in found.witnesses] == ["Euler-Lagrange"]
    assert abs(position(found) - exact) <= Fraction(float(found.bounds.position_error[-1]))
    # Some 128 roundings of 80 bits of the speed of a point at 1 m from the axle, 10 m/s, for 100 s.
    assert found.bounds.position_error[-1] < 2e-14


def test_gravity_and_friction_are_compared_in_exact_arithmetic() -> None:
    # On a slope whose axis is (3, 0, -4) / 5, gravity pulls with 2 kg * 10 m/s^2 * 4/5 = 16 N.
    fast = slider(16.0)
    for friction, slips in ((16.0, False), (np.nextafter(16.0, 0.0), True), (np.nextafter(16.0, 20.0), False)):
        rail = replace(fast.joints[0], axis=(3.0, 0.0, -4.0), friction=float(friction), effort=0.0)
        # The wheel turns about the normal of the slope, and is balanced.
        found = mechanism_truth(replace(fast, joints=(rail, replace(AXLE, axis=(4.0, 0.0, 3.0))), gravity=10.0), TIMES)
        exact = (16 - Fraction(float(friction))) / 2 * 100**2 / 2 if slips else Fraction(0)
        assert abs(position(found) - exact) <= Fraction(float(found.bounds.position_error[-1]))
        assert (position(found) > Fraction(1, 10**13)) == slips


def test_where_rounding_leaves_a_later_stop_undecided_the_bound_covers_both() -> None:
    # It slows down at 1 m/s^2 and stops after 1 s; then 1.1e-16 N more than the friction act on it.
    friction = float(np.nextafter(1.0, 0.0))
    found = mechanism_truth(slider(friction, velocity=-1.0), TIMES)
    slowing = (1 + Fraction(friction)) / 2
    stop = 1 / slowing
    exact = -stop / 2 + (1 - Fraction(friction)) / 4 * (100 - stop) ** 2
    assert abs(position(found) - exact) <= Fraction(float(found.bounds.position_error[-1]))
    slack = (1 - friction) / 2
    assert found.bounds.position_error[-1] >= slack * 99**2 / 2


def test_a_strain_within_the_error_of_a_state_is_a_doubt() -> None:
    # A spring of 2 N/m pushes as much as the friction, 1 N, where the slider stops: the decision depends on its place there.
    # With m v^2 = k q^2 + 2 f q, where m = 2 kg and q = 1/2 m, it begins at sqrt(3) / 2 m/s.
    rail = replace(slider(1.0).joints[0], stiffness=2.0, effort=0.0, start_velocity=(float(np.sqrt(0.75)),))
    mechanism = replace(slider(1.0), joints=(rail, AXLE))
    found = mechanism_truth(mechanism, TIMES)
    assert abs(position(found) - Fraction(1, 2)) < Fraction(1, 10**14)
    # The place has an error of some roundings of 80 bits, by which the force, and the acceleration for 99 s, are uncertain.
    assert found.bounds.position_error[-1] > 1e-19 * 99**2 / 2


#: The function of a way that decides, or watches joints that stick, and the module of the way.
Decide = Callable[..., Any]


@pytest.fixture(params=["recursion", "lagrangian"])
def careless(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of the ways has a fault: joints at rest stick if their friction is within 1e-11 of the force on them."""
    from bodycheck.reference.mechanisms.lagrangian import changes, phases

    recursion = request.param == "recursion"
    deciding, decide = (stick_slip, "settled") if recursion else (changes, "decided")
    watching, watch = (stick_slip, "_nearly_slipping") if recursion else (phases, "_watched")
    right: Decide = getattr(deciding, decide)
    monkeypatch.setattr(deciding, decide, lambda *given: right(*given[:3], 1e-11))
    monkeypatch.setattr(watching, watch, lambda *_: [])


def test_a_way_that_sticks_where_it_must_slip_shows_in_full_and_revokes_the_cross_check(careless: None) -> None:
    checked = certify(slider(1.0 - 1e-12), TIMES)
    # One of the ways says 0, and the other one 2.5e-9 m.
    assert checked.truth.bounds.position_error[-1] >= 2.4999e-9
    assert not checked.certified
    assert any("Euler-Lagrange" in fault for fault in checked.faults)


@pytest.fixture(params=["recursion", "lagrangian"])
def early(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of the ways has a fault: joints stop, and in the recursion break loose, 1e-4 units of its time too early."""
    from bodycheck.reference.mechanisms.lagrangian import phases

    module: Any = stick_slip if request.param == "recursion" else phases
    advance: Decide = module._advanced

    def wrong(*given: Any) -> Any:
        change, left = advance(*given)
        if change is None:
            return change, left
        if module is phases:
            rests = any(guard.name == "rest" for guard in change.guards)
            return replace(change, time=change.time - 1e-4 * rests), left
        return tuple(part if isinstance(part, int) else part - 1e-4 for part in change), left

    monkeypatch.setattr(module, "_advanced", wrong)


def test_a_way_whose_joints_stick_too_early_shows_and_revokes_the_cross_check(early: None) -> None:
    rod = body("rod", 1.0, (1 / 12, 1 / 12, 0.0), (0.0, 0.0, -0.5))
    pin = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), friction=0.8, start=(1.5,), start_velocity=(0.0,))
    hinge = replace(pin, name="hinge", parent=0, child=1, position=(0.0, 0.0, -1.0), start=(0.0,))
    checked = certify(Mechanism((rod, replace(rod, name="tip")), (pin, hinge), gravity=9.81), np.linspace(0.0, 1.0, 6))
    # The hinge stops from some 10 rad/s^2 times 1e-4 s, or a quarter of it.
    assert checked.truth.bounds.angular_velocity_error[-1] > 1e-5
    assert not checked.certified


def test_without_a_fault_the_two_ways_agree() -> None:
    checked = certify(slider(1.0 - 1e-12), TIMES)
    assert checked.certified
    assert checked.truth.bounds.position_error[-1] < 2e-14


def test_a_joint_that_has_not_moved_is_decided_exactly_where_another_one_stops() -> None:
    # Friction is the double nearest to what gravity asks of the hinge, 9.81 * 1.5 sin(1/2) / 2 N m: an irrational number.
    rod = body("rod", 1.0, (1 / 12, 1 / 12, 0.0), (0.0, 0.0, -0.5))
    hinge = Joint("hinge", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(0.5,), start_velocity=(0.0,))
    tie = 9.81 * 0.75 * float(np.sin(0.5))
    axle = replace(AXLE, position=(0.0, 0.0, -0.5))
    wheel = body("wheel", 0.5, (0.02, 0.02, 0.04))
    for friction in (np.nextafter(tie, 9.0), tie * (1 + 1e-14)):
        mechanism = Mechanism((rod, wheel), (replace(hinge, friction=float(friction)), axle), gravity=9.81)
        found = mechanism_truth(mechanism, TIMES)
        assert found.joints is not None
        assert (found.joints.position[:, 0] == 0.5).all()
        # The wheel's 12.5 rad have some roundings, and nothing grows with the 97.5 s of the hinge.
        assert found.bounds.error[-1] < 1e-13


@pytest.mark.parametrize("arm", [0.25, 0.5])
def test_the_rounding_of_forces_that_cancel_where_a_joint_begins_to_slip_is_in_the_bounds(arm: float) -> None:
    # A frame sticks, tilted about x; on it a level arm of 1 kg, about y, pulls a little more than the friction of its hinge.
    pull = MP.mpf(9.81) * MP.cos(0.25) * arm
    friction = float(pull) if float(pull) < pull else float(np.nextafter(float(pull), 0.0))
    base = Joint("base", "revolute", WORLD, 0, axis=(1.0, 0.0, 0.0), friction=3.0, start=(-0.25,), start_velocity=(0.0,))
    hinge = Joint("hinge", "revolute", 0, 1, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,))
    bodies = body("frame", 1.0, (0.3, 0.3, 0.3)), body("arm", 1.0, (0.1, 0.2, 0.25), (arm, 0.0, 0.0))
    times = np.linspace(0.0, 2.0, 9)
    for _ in range(3):
        found = mechanism_truth(Mechanism(bodies, (base, replace(hinge, friction=friction)), gravity=9.81), times)
        assert found.joints is not None
        # The pull is stationary where the arm is level, so that the acceleration is constant but for a part of 1e-28.
        acceleration = (pull - friction) / (MP.mpf(0.2) + MP.mpf(arm) ** 2)
        for time, velocity, bound in zip(
            times.tolist(), found.joints.velocity[:, 1].tolist(), found.bounds.angular_velocity_error.tolist(), strict=True
        ):
            assert abs(velocity - acceleration * time) <= bound
            # Some roundings of 80 bits of the pull.
            assert bound <= 2e-17 * (1 + time)
        friction = float(np.nextafter(friction, 0.0))


def test_a_doubt_moves_all_joints_and_grows() -> None:
    # A cart of 2 kg is held by just its friction, and a pendulum with a bob of 1 kg at 0.5 m hangs from it.
    rail = Joint("rail", "prismatic", WORLD, 0, axis=(1.0, 0.0, 0.0), friction=1.0, effort=1.0, start=(0.0,))
    pin = Joint("pin", "revolute", 0, 1, axis=(0.0, 1.0, 0.0), start=(0.0,), start_velocity=(0.0,))
    bodies = body("cart", 2.0, (0.1, 0.1, 0.1)), body("bob", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, -0.5))
    times = np.array([0.0, 2.0])
    mechanism = Mechanism(bodies, (replace(rail, start_velocity=(0.0,)), pin), gravity=9.75)
    states = recursion.follow(mechanism, times)
    uncertain = replace(states, decisions=tuple(replace(each, exact=frozenset()) for each in states.decisions))

    def added(growth: float) -> tuple[float, float]:
        grown = Growth(times, {name: np.ones(2) for name in STATES}, np.ones(2), np.array([1.0, growth]))
        with_doubt, without = (with_doubts(mechanism, each, grown, 8.0, 2.0**-63) for each in (uncertain, states))
        turned, moved = (float(with_doubt[name][-1] - without[name][-1]) for name in ("error", "position_error"))
        return turned, moved

    turned, moved = added(1.0)
    # A force on the cart accelerates it by 1 / (2 kg), and the pendulum, whose bob stays at rest, by 1 / (2 kg 0.5 m).
    # Positions change by the motion of the cart and, at the length of 0.5 m and as much again, by the turn.
    assert turned > 0
    assert moved == pytest.approx(turned * 0.5 + turned * 0.5, rel=1e-12)
    assert added(3.0) == pytest.approx((3 * turned, 3 * moved), rel=1e-12)
