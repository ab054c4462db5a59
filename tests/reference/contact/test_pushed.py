"""A pushed box with spheres on it: Newton and Euler, by hand, by SymPy, and by an integration with constraints."""

import math
from collections.abc import Sequence

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from bodycheck.reference.contact.piles import pushed
from bodycheck.reference.contact.problem import Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import PairContact
from bodycheck.reference.scene import Brick, Push, Sphere, Vector
from tests.support.piles import GRAVITY, body, moved, pile

BOX = Brick((10.0, 10.0, 0.5))
TIMES = np.linspace(0, 4, 9)
ALONG = (75.0, 129.9038105676658, 0.0)

Ball = tuple[float, float, float, float, float]


def scene(
    balls: Sequence[Ball],
    force: Vector = ALONG,
    box: Brick = BOX,
    friction: float = 0.4,
    yaw: float = 0.0,
    end: float = math.inf,
) -> Problem:
    """A box of 10 kg with balls: mass, radius, x, y and friction of each."""
    top = 2 * box.semi_axes[2]
    bodies = [body("box", box, 10.0, (0.0, 0.0, top / 2), yaw=yaw)]
    bodies += [body(f"ball-{n}", Sphere(r), m, (x, y, top + r)) for n, (m, r, x, y, _) in enumerate(balls)]
    contacts = [PairContact((0, 1 + n), own[4], 0.0) for n, own in enumerate(balls)]
    return pile(*bodies, friction=friction, contacts=contacts, push=Push(force, end=end))


GRID: list[Ball] = [(1.0, 0.1, float(x), float(y), 0.8) for x in range(-2, 3) for y in range(-2, 3)]


def test_the_published_scene_has_the_accelerations_of_its_formula() -> None:
    found = moved(pushed.motion, scene(GRID), TIMES)
    speeds = np.hypot(found.velocity[:, -1, 0], found.velocity[:, -1, 1]).astype(float)
    assert speeds[0] / 4 == pytest.approx(0.7385, abs=1e-15)
    assert speeds[1:] / 4 == pytest.approx(0.211, abs=1e-15)
    assert found.velocity[:, -1, :2] @ [-ALONG[1], ALONG[0]] == pytest.approx(0.0, abs=1e-14)
    assert found.events == ()
    assert max(found.errors["position_error"]) < 1e-14


def test_newton_and_euler_give_the_accelerations() -> None:
    """In symbols: two spheres of different roundness k, mass and radius."""
    big, force, friction, gravity, fast = sp.symbols("M F mu g A", positive=True)
    masses, radii, kinds = (sp.symbols(f"{name}:2", positive=True) for name in "mrk")
    accelerations, turns, forces = (sp.symbols(f"{name}:2") for name in "awf")
    equations = [big * fast - force + friction * gravity * (big + sum(masses)) + sum(forces)]
    for m, r, k, a, w, f in zip(masses, radii, kinds, accelerations, turns, forces, strict=True):
        equations += [m * a - f, k * m * r**2 * w + r * f, a - r * w - fast]
    (solved,) = sp.solve(equations, [fast, *accelerations, *turns, *forces], dict=True)
    shares = [k / (1 + k) for k in kinds]
    box = (force - friction * gravity * (big + sum(masses))) / (
        big + sum(m * share for m, share in zip(masses, shares, strict=True))
    )
    assert sp.simplify(solved[fast] - box) == 0
    for a, w, share, r, k in zip(accelerations, turns, shares, radii, kinds, strict=True):
        assert sp.simplify(solved[a] - share * box) == 0
        assert sp.simplify(solved[w] + share * box / (k * r)) == 0
    assert shares[0].subs(kinds[0], sp.Rational(2, 5)) == sp.Rational(2, 7)


def integrated(known: Problem, times: np.ndarray) -> list[np.ndarray]:
    """Positions, velocities, rotation matrices and angular velocities of box and balls that roll, from Lagrange multipliers.

    All coordinates in space, with multipliers for each point of contact, and friction of the plane against the motion.
    """
    masses = np.array([float(own.mass) for own in known.bodies])
    radii = [own.shape.radius for own in known.bodies if isinstance(own.shape, Sphere)]
    count = len(radii)
    weight = masses.sum() * GRAVITY
    push = np.array(known.pushes[0].force)
    size = 3 + 6 * count
    mass = np.diag(
        [*3 * [masses[0]], *(m for b, r in zip(masses[1:], radii, strict=True) for m in (*3 * [b], *3 * [0.4 * b * r**2]))]
    )
    rolling = np.zeros((3 * count, size))
    for n, r in enumerate(radii):
        rows, place = slice(3 * n, 3 * n + 3), 3 + 6 * n
        rolling[rows, :3] = -np.eye(3)
        rolling[rows, place : place + 3] = np.eye(3)
        rolling[rows, place + 3 : place + 6] = np.array([[0, -r, 0], [r, 0, 0], [0, 0, 0]])  # omega x (0, 0, -r)
    held = np.zeros((1, size))
    held[0, 2] = 1.0
    constraints = np.vstack([rolling, held])
    system = np.block([[mass, constraints.T], [constraints, np.zeros((3 * count + 1, 3 * count + 1))]])
    loads = np.zeros(size + 3 * count + 1)
    direction = push / np.linalg.norm(push)
    loads[:3] = push - known.plane.friction * weight * direction - [0, 0, masses[0] * GRAVITY]
    for n in range(count):
        loads[5 + 6 * n] = -masses[1 + n] * GRAVITY
    acceleration = np.linalg.solve(system, loads)[:size]

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        speeds, axes = state[:size], state[size:].reshape(-1, 3, 3)
        spun = [np.cross(speeds[6 + 6 * n : 9 + 6 * n], axes[n], axisb=0, axisc=0).ravel() for n in range(count)]
        return np.concatenate([acceleration, *spun])

    begin = np.concatenate([np.zeros(size), *count * [np.eye(3).ravel()]])
    solved = solve_ivp(rates, (0, times[-1]), begin, "DOP853", t_eval=times, rtol=1e-13, atol=1e-14, max_step=0.01)
    return [solved.y[:size].T, solved.y[size:].T.reshape(len(times), count, 3, 3)]


def test_an_integration_with_multipliers_agrees() -> None:
    balls = [(1.0, 0.1, -1.0, -1.0, 0.8), (2.0, 0.2, 1.0, 1.0, 0.8), (0.5, 0.4, -0.5, 2.5, 0.8), (0.5, 0.4, 1.5, -1.5, 0.8)]
    known = scene(balls, force=(45.0, 45.0, 0.0))
    found = moved(pushed.motion, known, TIMES)
    speeds, axes = integrated(known, TIMES)
    assert found.velocity[0] == pytest.approx(speeds[:, :3], abs=1e-12)
    for n in range(len(balls)):
        place = 3 + 6 * n
        assert found.velocity[1 + n] == pytest.approx(speeds[:, place : place + 3], abs=1e-12)
        quaternions = found.quaternion[1 + n].astype(float)
        turned = rotate(quaternions[:, None], np.broadcast_to(np.eye(3), (len(TIMES), 3, 3))).swapaxes(1, 2)
        # The integration turns by up to 90 rad, of which each step adds a rounding.
        assert np.abs(turned - axes[:, n]).max() < 1e-11
        spin = rotate(found.quaternion[1 + n], found.spin[1 + n])
        assert spin == pytest.approx(speeds[:, place + 3 : place + 6], abs=1e-11)


BALLS = st.lists(
    st.tuples(st.floats(0.1, 5.0), st.floats(0.05, 0.2), st.one_of(st.just(0.0), st.floats(0.01, 2.0))),
    min_size=1,
    max_size=6,
)


@settings(max_examples=30, deadline=None)
@given(BALLS, st.floats(0.0, 1000.0), st.floats(0.0, 1.0))
def test_every_sphere_obeys_coulomb(balls: list[tuple[float, float, float]], size: float, friction: float) -> None:
    """Newton for the box, and for each sphere rolling within the cone, or slipping on its rim with the box ahead of it."""
    row = [(mass, radius, place - 3.0, 0.0, own) for place, (mass, radius, own) in enumerate(balls)]
    known = scene(row, force=(size + 1e-3, 0.0, 0.0), box=Brick((1000.0, 10.0, 0.05)), friction=friction)
    found = moved(pushed.motion, known, np.array([0.0, 1e-3]))
    ahead = found.velocity[:, -1, 0].astype(float) / 1e-3
    weight = GRAVITY * (10.0 + sum(mass for mass, *_ in row))
    forces = [mass * own for (mass, *_), own in zip(row, ahead[1:], strict=True)]
    if size + 1e-3 <= friction * weight:
        assert not ahead.any()
        assert found.friction == pytest.approx((size + 1e-3) / weight)
        return
    assert 10 * ahead[0] + sum(forces) == pytest.approx(size + 1e-3 - friction * weight, abs=1e-9)
    for (mass, radius, _, _, own), force, spin in zip(row, forces, found.spin[1:, -1, 1].astype(float) / 1e-3, strict=True):
        assert spin == pytest.approx(-force / (0.4 * mass * radius), rel=1e-12, abs=1e-12)
        lowest = force / mass - radius * spin
        assert 0 <= force <= own * mass * GRAVITY * (1 + 1e-12)
        if force < own * mass * GRAVITY * (1 - 1e-12):
            assert lowest == pytest.approx(ahead[0], rel=1e-12)
        else:
            assert lowest <= ahead[0] * (1 + 1e-12)


def test_the_motion_is_not_known_once_a_ball_leaves_the_box() -> None:
    known = scene([(1.0, 0.1, -1.0, 0.0, 0.8)], force=(100.0, 0.0, 0.0), box=Brick((2.0, 1.0, 0.1)))
    found = moved(pushed.motion, known, np.linspace(0, 2, 2001))
    gone = np.isnan(found.position[0, :, 0].astype(float))
    assert gone[-1]
    last = found.position[:, ~gone, 0][:, -1]
    assert 0 < 2.0 - float(last[0] - last[1]) < 0.02
    for errors in found.errors.values():
        assert np.array_equal(np.isnan(errors), gone)


def test_balls_that_meet_are_told() -> None:
    """One without friction stays where it is, and another one rolls along with the box."""
    known = scene([(1.0, 0.2, 0.0, 0.0, 0.8), (1.0, 0.3, 1.0, 0.0, 0.0)], force=(100.0, 0.0, 0.0))
    found = moved(pushed.motion, known, np.linspace(0, 4, 5))
    (event,) = found.events
    assert event.kind == "impact"
    there = moved(pushed.motion, known, np.array([event.time * (1 - 1e-15)])).position[1:, 0].astype(float)
    assert np.linalg.norm(there[0] - there[1]) == pytest.approx(0.5, abs=1e-12)
    assert np.isnan(found.position[:, -1]).all()


def test_the_push_ends() -> None:
    found = moved(pushed.motion, scene(GRID, end=2.0), np.array([0.0, 1.9, 2.1]))
    assert np.isnan(found.position[0, :, 0].astype(float)).tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("known", "reason"),
    [
        (scene([(1.0, 0.1, 0.0, 1.0, 0.8)], force=(100.0, 0.0, 0.0)), "turns"),
        (scene([(1.0, 0.1, 0.0, 0.0, 0.8)], force=(2000.0, 0.0, 0.0), friction=1.0, box=Brick((0.2, 0.2, 0.5))), "tips"),
    ],
)
def test_a_box_that_turns_or_tips_has_no_motion(known: Problem, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        pushed.motion(known, TIMES)


def test_the_load_wanders_until_the_box_tips() -> None:
    """The centre of the load, from the moments about the centre of mass, reaches the rim when the motion ends."""
    half = 0.6
    known = scene([(30.0, 0.1, 0.0, 0.0, 0.8)], force=(200.0, 0.0, 0.0), friction=0.0, box=Brick((half, half, 1.0)))
    found = moved(pushed.motion, known, np.linspace(0, 3, 3001))
    gone = np.isnan(found.position[0, :, 0].astype(float))
    (event,) = found.events
    assert event.kind == "tip"
    last = found.position[:, ~gone, 0][:, -1].astype(float)
    reaction = 30 * 200 * (2 / 7) / (10 + 30 * 2 / 7)
    centre = (30 * GRAVITY * (last[1] - last[0]) - 1.0 * reaction) / (40 * GRAVITY)
    assert centre == pytest.approx(-half, abs=0.01)


@pytest.mark.parametrize(
    "known",
    [
        scene([(1.0, 0.1, 0.0, 0.0, 0.8), (1.0, 0.1, 0.2, 0.0, 0.8)]),
        scene([(1.0, 0.1, 10.5, 0.0, 0.8)]),
        scene([(1.0, 0.1, 0.0, 0.0, 0.8)], force=(100.0, 0.0, 1.0)),
    ],
    ids=["balls that touch", "a ball beside the box", "a push upwards"],
)
def test_other_scenes_are_another_ways(known: Problem) -> None:
    assert pushed.motion(known, TIMES) is None


def test_the_bounds_cover_the_errors_of_the_states() -> None:
    """Against the formulas with fifty digits; a sphere that rolls and one that slips."""
    known = scene([(1.0, 0.1, 0.0, -1.0, 0.8), (3.0, 0.25, 0.0, 2.0, 0.01)], force=(0.0, 68.0, 0.0))
    found = moved(pushed.motion, known, TIMES)
    with mp.workdps(50):
        gravity, slips = mp.mpf(GRAVITY), mp.mpf(0.01) * mp.mpf(GRAVITY)
        box = (68 - mp.mpf(0.4) * 14 * gravity - 3 * slips) / (10 + mp.mpf(2) / 7)
        for place, acceleration in enumerate((box, 2 * box / 7, slips)):
            for n, t in enumerate(TIMES):
                moved_by = found.position[place, n] - known.bodies[place].position
                exact = [mp.mpf(0), acceleration * mp.mpf(t) ** 2 / 2]
                apart = [abs(mp.mpf(str(own)) - other) for own, other in zip(moved_by, exact, strict=False)]
                assert max(apart) <= found.errors["position_error"][n] + 1e-18  # the difference of positions is rounded
                assert (
                    abs(mp.mpf(str(found.velocity[place, n, 1])) - acceleration * mp.mpf(t))
                    <= found.errors["velocity_error"][n]
                )
