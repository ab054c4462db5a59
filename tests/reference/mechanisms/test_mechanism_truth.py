"""The truth of a mechanism, its bounds, and its cross-check."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck.reference.bounds import EPS, STATES
from bodycheck.reference.certificate import certify
from bodycheck.reference.mechanisms import followed, observables, recursion, witnesses
from bodycheck.reference.mechanisms import truth as truths
from bodycheck.reference.mechanisms.certificate import rounded_to_wide
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.forms import pendulum
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.mechanisms.recursion import JointStates
from bodycheck.reference.mechanisms.truth import known_until, mechanism_truth
from bodycheck.reference.mechanisms.ways import Motion, apart
from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.reference.witnesses import DOP853_NAME
from tests.support.jointed import body, cart_pole

TIMES = np.linspace(0.0, 3.0, 31)


def chain(links: int, length: float, spatial: bool = False) -> Mechanism:
    """Uniform rods of 1 kg: hinged in a plane from the horizontal, or about y and x in turn with all angles 0.7, at rest."""
    moment = length**2 / 12
    rods = tuple(body(f"rod-{n}", 1.0, (moment, moment, 0.0), (0.0, 0.0, -length / 2)) for n in range(links))
    joints = []
    for n in range(links):
        axis = (1.0, 0.0, 0.0) if spatial and n % 2 else (0.0, 1.0, 0.0)
        angle = 0.7 if spatial else np.pi / 2 * (n == 0)
        origin = (0.0, 0.0, -length if n else 0.0)
        joints.append(
            Joint(f"hinge-{n}", "revolute", n - 1, n, origin, axis=axis, start=(float(angle),), start_velocity=(0.0,))
        )
    return Mechanism(rods, tuple(joints), gravity=9.81)


def ball_and_slider() -> Mechanism:
    """A damped ball that carries a slider on a spring."""
    return Mechanism(
        (
            body("arm", 1.0, (0.02, 0.03, 0.015), (0.05, 0.1, -0.4)),
            body("bead", 0.3, (0.001, 0.002, 0.003), (0.02, 0.0, 0.0)),
        ),
        (
            Joint("ball", "spherical", WORLD, 0, damping=0.05, start=(0.9, 0.3, -0.2, 0.1), start_velocity=(1.0, -2.0, 3.0)),
            Joint(
                "bead", "prismatic", 0, 1, axis=(0.0, 0.6, -0.8), stiffness=40.0, rest=0.3, start=(0.2,), start_velocity=(0.5,)
            ),
        ),
        gravity=9.81,
    )


def motion_of(found: Truth) -> Motion:
    assert found.joints is not None
    return Motion(found.joints.position, found.joints.velocity, found.trajectory)


def exact_motion(mechanism: Mechanism) -> Motion:
    """The motion in arithmetic of 160 bits, in the wide type."""
    heyoka = pytest.importorskip("heyoka")
    found = recursion.follow(mechanism, TIMES, heyoka.real, 160)
    states = found.bodies.position, found.bodies.quaternion, found.bodies.velocity, found.bodies.angular_velocity
    bodies = Trajectory(TIMES, *(rounded_to_wide(values) for values in states))
    return Motion(rounded_to_wide(found.position), rounded_to_wide(found.velocity), bodies)


@pytest.mark.parametrize("mechanism", [cart_pole(), ball_and_slider()], ids=["cart-pole", "ball-and-slider"])
def test_the_bounds_cover_the_error_and_are_not_much_larger(mechanism: Mechanism) -> None:
    exact = exact_motion(mechanism)
    way = followed.followed(mechanism, TIMES).way
    found = mechanism_truth(mechanism, TIMES)
    of_way, of_truth = apart(mechanism, way.motion, exact), apart(mechanism, motion_of(found), exact)
    for name in STATES:
        assert (of_way[name] <= way.errors[name]).all()
        assert (of_truth[name] <= getattr(found.bounds, name)).all()
        # The number of roundings is the largest of any figure and instant, eightfold, and growth is that of the worst moment.
        assert way.errors[name][-1] <= 2000 * max(of_way[name])
        assert getattr(found.bounds, name)[-1] <= 100 * max(of_truth[name])


@pytest.fixture
def heavier(monkeypatch: pytest.MonkeyPatch) -> None:
    """The recursion with a fault: gravity is a part in 1e9 larger than the file says."""
    follow = recursion.follow

    def wrong(mechanism: Mechanism, times: Any, *arithmetic: Any) -> JointStates:
        return follow(replace(mechanism, gravity=mechanism.gravity * (1 + 1e-9)), times, *arithmetic)

    monkeypatch.setattr(recursion, "follow", wrong)


def test_a_fault_of_the_recursion_is_in_the_bound(heavier: None, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = mechanism_truth(cart_pole(), TIMES)
    monkeypatch.undo()
    right = mechanism_truth(cart_pole(), TIMES)
    off = apart(cart_pole(), motion_of(wrong), motion_of(right))
    for name in STATES:
        assert max(off[name]) > 1e-10
        assert (off[name] <= getattr(wrong.bounds, name)).all()
    change = np.abs(energy(wrong) - energy(right))
    assert (change <= wrong.bounds.energy_error).all()


def energy(found: Truth) -> Any:
    return observables.observe(cart_pole(), found.trajectory).total_energy


def test_the_certificate_of_a_recursion_with_a_fault_names_the_ways(heavier: None) -> None:
    pytest.importorskip("heyoka")
    found = certify(cart_pole(), TIMES)
    assert not found.certified
    assert any("Euler-Lagrange" in fault and "truth" in fault for fault in found.faults)


@pytest.mark.parametrize("mechanism", [cart_pole(), chain(2, 1.0)], ids=["cart and pole", "rods that begin horizontal"])
def test_a_certificate_is_measured_against_more_digits(mechanism: Mechanism) -> None:
    pytest.importorskip("heyoka")
    found = certify(mechanism, TIMES)
    assert found.certified
    assert found.digits > 30
    assert found.bound[-1] <= found.truth.bounds.error[-1]
    assert found.growth is not None


def test_where_energy_drifts_more_than_the_bound_allows_the_bound_grows() -> None:
    mechanism = cart_pole()
    found = followed.followed(mechanism, TIMES)
    motion = found.way.motion
    faster = replace(motion.bodies, velocity=motion.bodies.velocity * (1 + 1e-9))
    fast = replace(found, way=replace(found.way, motion=replace(motion, bodies=faster)))
    drifting = truths.joined(mechanism, TIMES, fast, None).truth
    drift = np.abs(energy(drifting) - energy(drifting)[0])
    assert drift[-1] > 1e-10
    assert drifting.bounds.energy_error[-1] >= drift[-1] / 2
    assert drifting.bounds.error[-1] > 100 * truths.joined(mechanism, TIMES, found, None).truth.bounds.error[-1]


def test_without_a_witness_the_bound_is_that_of_the_growth_of_rounding() -> None:
    alone = truth(cart_pole(), TIMES, vouched=False)
    vouched = truth(cart_pole(), TIMES)
    assert alone.witnesses == ()
    assert len(vouched.witnesses) == 1
    assert alone.model == "articulated-body recursion"
    assert (alone.bounds.error <= vouched.bounds.error).all()
    assert (alone.bounds.error >= EPS).all()
    assert alone.growth is not None
    assert (np.diff(alone.growth) >= 0).all()


def test_in_double_precision_the_ways_agree_and_the_truth_names_dop853(monkeypatch: pytest.MonkeyPatch) -> None:
    times = np.linspace(0.0, 0.5, 6)
    wide = mechanism_truth(cart_pole(), times)
    for module in (followed, witnesses):
        monkeypatch.setattr(module, "arithmetic", lambda: (np.float64, DOP853_NAME, 16))
    monkeypatch.setattr(recursion, "solver", lambda: recursion.followed_by_dop853)
    found = mechanism_truth(cart_pole(), times)
    assert found.backend == DOP853_NAME
    assert found.witnesses == (f"Euler-Lagrange, {DOP853_NAME}",)
    off = apart(cart_pole(), motion_of(found), motion_of(wide))
    for name in STATES:
        assert (off[name] <= getattr(found.bounds, name) + getattr(wide.bounds, name)).all()


def test_a_chaotic_chain_says_until_when_it_is_known() -> None:
    pytest.importorskip("heyoka")
    times = np.linspace(0.0, 12.0, 121)
    found = mechanism_truth(chain(3, 0.1), times)
    until = known_until(found)
    assert until is not None
    assert 3.0 < until < 12.0
    assert found.growth is not None
    assert found.growth[-1] > 1e10
    assert found.bounds.error[-1] > 1e-3
    assert np.isfinite(found.bounds.energy_error).all()


@pytest.mark.slow
@pytest.mark.parametrize(("spatial", "error"), [(False, 1e-12), (True, 1e-10)], ids=["plane", "space"])
def test_ten_rods_are_known_over_five_seconds(spatial: bool, error: float) -> None:
    pytest.importorskip("heyoka")
    found = mechanism_truth(chain(10, 1.0, spatial), np.linspace(0.0, 5.0, 51))
    assert found.bounds.error[-1] <= error


def test_a_pendulum_is_a_closed_form_that_the_recursion_vouches_for() -> None:
    rod = chain(1, 1.0)
    found = mechanism_truth(rod, TIMES)
    assert found.model == "closed form: pendulum"
    assert [name.partition(",")[0] for name in found.witnesses] == ["articulated-body recursion"]
    assert found.bounds.error[-1] < 1e-14
    with_recursion = followed.by_recursion(rod, TIMES).way.motion
    off = apart(rod, motion_of(found), with_recursion)
    for name in STATES:
        assert (off[name] <= getattr(found.bounds, name)).all()


def upright(off: float) -> Mechanism:
    """A rod that hangs and begins at the velocity that takes it to the upright position, times 1 + off: 2 omega = sqrt(6 g)."""
    still = chain(1, 1.0)
    velocity = float(np.sqrt(6 * 9.81)) * (1 + off)
    return replace(still, joints=(replace(still.joints[0], start=(0.0,), start_velocity=(velocity,)),))


@pytest.mark.parametrize("off", [1e-10, -1e-10, 1e-12, 1e-14, 0.0])
def test_the_error_of_the_witness_of_a_pendulum_near_the_separatrix_is_not_printed(off: float) -> None:
    pytest.importorskip("heyoka")
    times = np.linspace(0.0, 20.0, 41)
    found = mechanism_truth(upright(off), times)
    alone = mechanism_truth(upright(off), times, vouched=False)
    witness = followed.by_recursion(upright(off), times).way.motion
    assert found.witnesses
    # The closed form has some roundings of doubles of its largest angle, which is up to 10 rad.
    assert found.bounds.error[-1] < 2e-14
    assert (found.bounds.error == alone.bounds.error).all()
    assert apart(upright(off), motion_of(found), witness)["error"].max() > 1e4 * found.bounds.error[-1]


def test_a_fault_of_a_closed_form_is_in_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    right = mechanism_truth(chain(1, 1.0), TIMES)
    follow = pendulum.follow
    monkeypatch.setattr(
        pendulum, "follow", lambda system, times: follow(replace(system, square=system.square * (1 + 1e-9)), times)
    )
    wrong = mechanism_truth(chain(1, 1.0), TIMES)
    off = apart(chain(1, 1.0), motion_of(wrong), motion_of(right))
    for name in STATES:
        assert max(off[name]) > 1e-10
        assert (off[name] <= getattr(wrong.bounds, name)).all()


def test_a_truth_is_a_part_of_itself() -> None:
    found = truth(cart_pole(), TIMES, vouched=False)
    part = found.at(TIMES[[3, 7]])
    assert isinstance(part.joints, JointMotion)
    np.testing.assert_array_equal(part.joints.position, motion_of(found).position[[3, 7]])
    assert part.trajectory.position.shape == (2, 2, 3)


def rough_chain(size: float) -> Mechanism:
    """Two rods that fall from the horizontal on hinges with dry friction, which stick and slip some ten times."""
    plain = chain(2, 1.0)
    return replace(plain, joints=tuple(replace(joint, friction=size) for joint in plain.joints))


def test_the_lagrangian_vouches_for_a_chain_that_sticks_and_slips(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("heyoka")
    right = truth(rough_chain(0.8), TIMES)
    assert [name.partition(",")[0] for name in right.witnesses] == ["Euler-Lagrange"]
    assert right.bounds.error[-1] < 1e-14
    assert (motion_of(right).velocity[:, 1] == 0).any()
    follow = recursion.follow

    def wrong(mechanism: Mechanism, times: Any, *arithmetic: Any) -> JointStates:
        rougher = (replace(joint, friction=joint.friction * (1 + 1e-7)) for joint in mechanism.joints)
        return follow(replace(mechanism, joints=tuple(rougher)), times, *arithmetic)

    monkeypatch.setattr(recursion, "follow", wrong)
    faulty = truth(rough_chain(0.8), TIMES)
    off = apart(rough_chain(0.8), motion_of(faulty), motion_of(right))
    for name in STATES:
        assert max(off[name]) > 1e-9
        assert (off[name] <= getattr(faulty.bounds, name)).all()
