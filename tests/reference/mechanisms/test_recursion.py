"""The motion of mechanisms by the articulated-body recursion: against equations by hand, closed forms and what is conserved."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bodycheck import load
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, FloatType
from bodycheck.reference.kinematics import geodesic_angle, rotate
from bodycheck.reference.mechanisms import followed as measured_ways
from bodycheck.reference.mechanisms import kinematics, observables
from bodycheck.reference.mechanisms.articulation.nudges import growth_of_trees
from bodycheck.reference.mechanisms.growth import growth
from bodycheck.reference.mechanisms.link_states import start
from bodycheck.reference.mechanisms.mechanism import WORLD, BodyStart, Joint, Mechanism
from bodycheck.reference.mechanisms.recursion import JointStates, follow
from bodycheck.reference.mechanisms.tree import forest
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth
from tests.support.jointed import body, cart_pole, four_bar, free_chain, tree

hy = pytest.importorskip("heyoka")

from bodycheck.reference.integration.heyoka_solver import integrator, solve  # noqa: E402
from bodycheck.reference.mechanisms import tree_equations  # noqa: E402
from bodycheck.reference.mechanisms.tree_equations import MOST_OPTIMISED  # noqa: E402

TIMES = np.linspace(0.0, 2.0, 21)

#: Some hundred roundings of the 80-bit type, which the short motions here make; there are none in double precision alone.
CLOSE = 1e-17 if np.finfo(np.longdouble).nmant > 52 else 1e-13

#: A uniform rod of 1 m and 12 kg, whose moments are whole numbers.
ROD = body("rod", 12.0, (1.0, 1.0, 0.0), (0.0, 0.0, -0.5))


def doubles(states: Trajectory) -> Trajectory:
    """States of bodies, rounded to double precision."""
    parts = (states.position, states.quaternion, states.velocity, states.angular_velocity)
    return Trajectory(states.t, *(part.astype(float) for part in parts))


def rods(count: int, *, crossed: bool = False) -> Mechanism:
    """Rods of 1 m, hinged about y, or about x and y in turn; from the horizontal, or from 0.7 rad at each hinge."""
    joints = tuple(
        Joint(
            *(f"hinge-{place}", "revolute", place - 1, place, (0.0, 0.0, -1.0 if place else 0.0)),
            axis=(1.0, 0.0, 0.0) if crossed and place % 2 == 0 else (0.0, 1.0, 0.0),
            start=(0.7 if crossed else 0.0 if place else np.pi / 2,),
            start_velocity=(0.0,),
        )
        for place in range(count)
    )
    return Mechanism(tuple(replace(ROD, name=f"rod-{place}") for place in range(count)), joints, gravity=9.81)


@pytest.fixture(scope="module")
def moved_tree() -> JointStates:
    """The motion of the tree with a joint of every type."""
    return follow(tree(), TIMES)


def test_a_double_pendulum_obeys_the_equations_of_the_textbook() -> None:
    a, b, u, v = hy.make_vars("a", "b", "u", "v")
    g = hy.par[0]
    c, s = hy.cos(a - b), hy.sin(a - b)
    # Two uniform rods with angles a and b from the vertical: 4/3 a'' + c/2 b'' = p and c/2 a'' + 1/3 b'' = q.
    p, q = -s * v * v / 2 - 3 * g * hy.sin(a) / 2, s * u * u / 2 - g * hy.sin(b) / 2
    # They are solved in whole numbers, since heyoka multiplies by the double that is nearest to 1/3.
    det = 16 - 9 * c * c
    equations = [(a, u), (b, v), (u, (12 * p - 18 * c * q) / det), (v, (48 * q - 18 * c * p) / det)]
    start = np.array([np.pi / 2, np.pi / 2, 0, 0], dtype=np.longdouble)
    solver = hy.taylor_adaptive(
        equations, start, pars=np.array([9.81], np.longdouble), fp_type=np.longdouble, tol=np.longdouble(1e-20)
    )
    by_hand = solver.propagate_grid(TIMES.astype(np.longdouble))[-1]
    found = follow(rods(2), TIMES)
    # An error grows about tenfold in these two seconds.
    assert np.abs(found.position.cumsum(axis=1) - by_hand[:, :2]).max() < 10 * CLOSE
    assert np.abs(found.velocity.cumsum(axis=1) - by_hand[:, 2:]).max() < 100 * CLOSE


def test_a_tree_of_every_joint_starts_as_given_and_conserves_its_energy(moved_tree: JointStates) -> None:
    mechanism, states = tree(), doubles(moved_tree.bodies)
    begin = kinematics.initial(mechanism)
    assert geodesic_angle(states.quaternion[:, :1], begin.quaternion).max() < 1e-14  # roundings of double precision
    for part in ("position", "velocity", "angular_velocity"):
        np.testing.assert_allclose(getattr(states, part)[:, :1], getattr(begin, part), rtol=1e-14, atol=1e-14)
    energy = observables.observe(mechanism, states).total_energy
    # The energies of some joules are sums of some ten terms in double precision.
    assert np.ptp(energy) < 1e-13


def test_coordinates_of_joints_and_poses_of_bodies_agree(moved_tree: JointStates) -> None:
    mechanism, states = tree(), doubles(moved_tree.bodies)
    found = kinematics.joints(mechanism, states)
    # Both are rounded to double precision, angles up to 10 rad and rates up to some ten rad/s.
    np.testing.assert_allclose(moved_tree.position.astype(float), found.position, rtol=0, atol=2e-13)
    np.testing.assert_allclose(moved_tree.velocity.astype(float), found.velocity, rtol=0, atol=2e-12)


def test_a_free_body_moves_as_its_closed_form_says() -> None:
    scene = load("intermediate-axis-flip").scene
    initial = scene.initial
    start = BodyStart(initial.position, initial.quaternion, initial.velocity, initial.angular_velocity)
    mechanism = Mechanism((replace(body("alone", scene.body.mass, scene.body.moments), start=start),), gravity=scene.gravity)
    found, known = follow(mechanism, TIMES).bodies, truth(scene, TIMES)
    apart = geodesic_angle(found.quaternion[0], known.trajectory.quaternion.astype(np.longdouble))
    # The closed form is rounded to double precision at the end, beyond which its bound is small here.
    assert apart.max() < 1e-15 + known.bounds.error.max()
    assert np.abs(found.position[0] - known.trajectory.position).max() < 1e-15


def test_a_free_chain_conserves_its_momentum() -> None:
    mechanism = free_chain()
    seen = observables.observe(mechanism, doubles(follow(mechanism, TIMES).bodies))
    assert np.ptp(seen.momentum, axis=0).max() < 1e-14  # roundings of doubles of about 1
    assert np.ptp(seen.angular_momentum, axis=0).max() < 1e-14
    assert np.ptp(seen.total_energy) < 1e-13


@pytest.mark.parametrize("crossed", [False, True])
def test_eighty_bits_lose_few_digits(crossed: bool) -> None:
    mechanism = rods(3, crossed=crossed)
    found, wider = follow(mechanism, TIMES), follow(mechanism, TIMES, hy.real128)
    head = found.position.astype(float)
    apart = (wider.position - head).astype(float) - (found.position - head).astype(float)
    # Some hundred steps, each with some roundings, and an error grows about tenfold.
    assert np.abs(apart).max() < 10 * CLOSE


def test_multiprecision_has_the_digits_of_its_bits() -> None:
    found, wider = (follow(cart_pole(), TIMES[:6], hy.real, bits).position for bits in (192, 256))
    apart = np.abs((wider - found.astype(float)).astype(float) - (found - found.astype(float)).astype(float))
    assert apart.max() == 0  # the difference of the two is far below a double's rounding of what the doubles leave
    exact = [MP.mpf(str(value)) for value in wider[-1]]
    rough = [MP.mpf(str(value)) for value in found[-1]]
    assert max(abs(one - other) for one, other in zip(exact, rough, strict=True)) < MP.mpf(2) ** -170


def test_the_order_of_the_file_does_not_matter() -> None:
    mechanism = tree()
    places = [3, 7, 0, 5, 1, 4, 6, 2]
    new = {old: place for place, old in enumerate(places)} | {WORLD: WORLD}
    joints = tuple(replace(joint, parent=new[joint.parent], child=new[joint.child]) for joint in mechanism.joints)
    shuffled = replace(mechanism, bodies=tuple(mechanism.bodies[old] for old in places), joints=joints[::-1])
    one, other = follow(mechanism, TIMES[:6]).bodies, follow(shuffled, TIMES[:6]).bodies
    assert np.abs(one.position[places] - other.position).max() < CLOSE


def test_the_choice_of_frames_does_not_matter() -> None:
    mechanism = rods(2, crossed=True)
    turn, back = (0.5, 0.5, -0.5, 0.5), np.array([0.5, -0.5, 0.5, -0.5])

    def turned(vector: Any) -> Any:
        return tuple(rotate(back, np.array(vector)).tolist())

    # The first rod's frame is another, so that its joint and its child are given along other axes.
    first, second = mechanism.joints
    x, y, z = np.abs(turned((1.0, 1.0, 0.0))).tolist()
    rod = body("rod-0", 12.0, (x, y, z), turned(ROD.center_of_mass))
    other = replace(
        mechanism,
        bodies=(rod, mechanism.bodies[1]),
        joints=(
            replace(first, attitude=turn, axis=turned(first.axis)),
            replace(second, position=turned(second.position), attitude=(0.5, -0.5, 0.5, -0.5)),
        ),
    )
    one, two = follow(mechanism, TIMES), follow(other, TIMES)
    assert np.abs(one.position - two.position).max() < 10 * CLOSE
    assert np.abs(one.bodies.position - two.bodies.position).max() < 10 * CLOSE


def test_a_ball_is_damped_by_its_relative_rate() -> None:
    ball = body("ball", 2.0, (0.5, 0.5, 0.5))
    joint = Joint("ball", "spherical", WORLD, 0, damping=0.4, start=(1.0, 0.0, 0.0, 0.0), start_velocity=(1.0, -2.0, 3.0))
    found = follow(Mechanism((ball,), (joint,)), TIMES)
    decay: Array = np.exp(-np.longdouble(0.4) / np.longdouble(0.5) * TIMES)
    assert np.abs(found.velocity - decay[:, None] * np.array([1.0, -2.0, 3.0])).max() < CLOSE


def test_a_point_mass_swings_as_the_rod_of_the_same_length() -> None:
    pin = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(np.pi / 2,), start_velocity=(0.0,))
    point = Mechanism((body("bead", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)),), (pin,), gravity=9.81)
    # A uniform rod of 1.5 m and 4 kg: its moment about the middle is 4 * 1.5^2 / 12 = 0.75.
    rod = Mechanism((body("rod", 4.0, (0.75, 0.75, 0.0), (0.0, 0.0, -0.75)),), (pin,), gravity=9.81)
    assert np.abs(follow(point, TIMES).position - follow(rod, TIMES).position).max() < CLOSE


def test_loops_are_left_to_others() -> None:
    with pytest.raises(NotModelled, match="loops"):
        follow(four_bar(), TIMES)


def test_angles_are_not_reduced() -> None:
    pin = Joint("pin", "revolute", WORLD, 0, start=(0.5,), start_velocity=(40.0,))
    found = follow(Mechanism((body("wheel", 1.0, (1.0, 1.0, 1.0)),), (pin,)), TIMES)
    np.testing.assert_allclose(found.position[:, 0].astype(float), 0.5 + 40 * TIMES, rtol=1e-15)


def test_a_long_chain_compiles_and_conserves_its_energy() -> None:
    mechanism = rods(MOST_OPTIMISED + 1)
    times = np.array([0.0, 0.05, 0.1])
    energy = observables.observe(mechanism, doubles(follow(mechanism, times).bodies)).total_energy
    # Energies of some thousands of joules in double precision.
    assert np.ptp(energy) < 1e-10


def test_a_mechanism_without_a_motion_is_out_of_reach() -> None:
    ball = Joint("ball", "spherical", WORLD, 0, start=(1.0, 0.0, 0.0, 0.0), start_velocity=(0.0, 1.0, 0.0))
    bead = Mechanism((body("bead", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)),), (ball,), gravity=9.81)
    with pytest.raises(OutOfReach, match="stopped"):
        follow(bead, TIMES)


@pytest.mark.parametrize("friction", [0.0, 0.1], ids=["smooth", "dry friction"])
def test_a_motion_that_needs_too_many_steps_is_refused(friction: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The damping of a joint that stops it in a microsecond makes steps of a microsecond, where all else moves in seconds."""
    plain = cart_pole()
    stiff = replace(plain, joints=(replace(plain.joints[0], damping=1e6, friction=friction), *plain.joints[1:]))
    monkeypatch.setattr(tree_equations, "MAX_OPERATIONS", 20_000)
    tree_equations.most_steps.cache_clear()
    with pytest.raises(OutOfReach, match="Taylor's method stopped"):
        follow(stiff, TIMES)
    monkeypatch.undo()
    tree_equations.most_steps.cache_clear()
    follow(plain, TIMES)


def test_motions_in_lanes_are_those_of_separate_integrations() -> None:
    followed = max(forest(tree()).trees, key=lambda each: len(each.links))
    kind, instants = FloatType(np.float64), np.linspace(0.0, 2.0, 33)
    solver = integrator(tree_equations._equations(tree_equations.shape_of(followed)), np.float64, large=True)
    begin, numbers = kind.array(start(followed)), kind.array(tree_equations.parameters(followed))
    nudge = 2.0**-30 * np.random.default_rng(1).choice([-1.0, 1.0], len(begin))
    rows, deviations, factors = tree_equations.beside(followed, instants, [(0, nudge), (8, nudge)], np.ones(len(begin)))
    # Both integrations have errors of some hundred roundings, in double precision, and steps of their own.
    np.testing.assert_allclose(rows, solve(solver, begin, numbers, instants), rtol=0, atol=1e-11)
    assert not factors[1, :8].any()
    assert not deviations[1, :8].any()
    np.testing.assert_array_equal(deviations[:, [0, 8]][[0, 1], [0, 1]], [nudge, nudge])
    # A nudge from a state on is a nudge of the motion that begins there.
    for lane, first in ((0, 0), (1, 8)):
        moved = solve(solver, rows[first] + nudge, numbers, instants[first:] - instants[first])
        off = deviations[lane, first:] * factors[lane, first:, None]
        # Deviations of at most 1e-5 are proportional to the nudge but for their squares.
        np.testing.assert_allclose(off, moved - rows[first:], rtol=0, atol=1e-4 * np.abs(off).max())


def test_growth_in_lanes_is_that_of_separate_motions() -> None:
    mechanism, instants = rods(3), np.linspace(0.0, 20.0, 129)
    base, together = growth_of_trees(mechanism, instants)
    apart = growth(mechanism, measured_ways._in_doubles, base, instants)
    assert together.of_any[-1] > 1e4
    # Nudges in other directions deviate by other factors, and a sum of two deviations is at least the larger one.
    ratio = together.of_any / apart.of_any
    assert ratio.min() > 0.1
    assert ratio.max() < 10.0


def test_a_lane_that_fails_ends_alone() -> None:
    (followed,) = forest(rods(2)).trees
    instants = np.linspace(0.0, 1.0, 9)
    rows, _, factors = tree_equations.beside(followed, instants, [(0, np.full(4, np.inf)), (2, np.full(4, 1e-9))], np.ones(4))
    assert np.isfinite(rows).all()
    assert not factors[0, 1:].any()
    assert factors[1, 2:].all()


def test_code_that_is_not_optimised_gives_the_same_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    quick = follow(rods(2), TIMES)
    monkeypatch.setattr(tree_equations, "QUICK_STEPS", 1)
    tree_equations._kept.cache_clear()
    optimised = follow(rods(2), TIMES)
    np.testing.assert_allclose(quick.position.astype(float), optimised.position.astype(float), rtol=0, atol=CLOSE * 100)
