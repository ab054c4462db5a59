"""Bodies that fall on a face, an edge or a corner: free flight until the first touch, and nothing after it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from bodycheck.reference.contact import dropped
from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.problem import Problem, problem
from bodycheck.reference.contact.ways import WAYS
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.kinematics import quaternion_from_euler, rotate
from bodycheck.reference.scene import Body, Brick, Cylinder, Ellipsoid, Plane, Quaternion, Scene, Shape, State, Vector
from tests.support.piles import moved

HALF = (0.1, 0.15, 0.05)
MOMENTS = tuple(2.0 * (sum(half**2 for half in HALF) - own**2) / 3 for own in HALF)
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * HALF
ROUGH = Plane(friction=0.5)
EULER = (0.3, 0.7, 0.5)


def quaternion(phi: float, theta: float, psi: float) -> Quaternion:
    w, x, y, z = map(float, quaternion_from_euler(*map(np.float64, (phi, theta, psi))))
    return w, x, y, z


def falling(
    position: Vector = (0.0, 0.0, 0.5),
    euler: Vector = EULER,
    velocity: Vector = (0.0, 0.0, 0.0),
    spin: Vector = (0.0, 0.0, 0.0),
    gravity: float = 9.81,
    plane: Plane = ROUGH,
) -> Problem:
    a, b, c = MOMENTS
    brick = Body(2.0, (a, b, c), Brick(HALF))
    return problem(Scene(brick, State(position, quaternion(*euler), velocity, spin), gravity, plane))


def instant_of(found: ContactMotion) -> float:
    (event,) = found.events
    assert event.kind == "impact"
    return event.time


def test_a_brick_that_does_not_turn_falls_for_the_time_of_its_lowest_corner() -> None:
    known = falling()
    found = moved(dropped.motion, known, np.linspace(0, 1, 101))
    lowest = float(rotate(np.tile(known.bodies[0].quaternion, (8, 1)), CORNERS.astype(np.longdouble))[:, 2].min()) + 0.5
    (event,) = found.events
    assert event.time == pytest.approx(math.sqrt(2 * lowest / 9.81), abs=event.error)
    assert event.error < 1e-14
    assert event.normal_speed == pytest.approx(9.81 * event.time, rel=1e-14)
    before = np.linspace(0, 1, 101) < event.time
    t = np.linspace(0, 1, 101)[before]
    assert found.position[0, before, 2] == pytest.approx(0.5 - 9.81 * t**2 / 2, abs=1e-15)
    for states in (found.position, found.velocity, found.quaternion, found.spin):
        assert np.isnan(states[0, ~before]).all()
    for errors in found.errors.values():
        assert np.isnan(errors[~before]).all()
        assert (errors[before] < 1e-14).all()


@pytest.mark.parametrize("incline", [0.0, 0.4])
def test_a_brick_that_tumbles_falls_as_an_integration_says(incline: float) -> None:
    """Euler's equations and the rotation matrix by DOP853, with an event where the lowest corner is on the plane."""
    spin = np.array([3.0, -7.0, 5.0])
    known = falling(velocity=(1.0, 0.5, 2.0), spin=(3.0, -7.0, 5.0), plane=Plane(friction=0.5, incline=incline))
    own, moments = known.bodies[0], np.array(MOMENTS)

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        velocity, axes, omega = state[3:6], state[6:15].reshape(3, 3), state[15:]
        turning = axes @ np.array([[0, -omega[2], omega[1]], [omega[2], 0, -omega[0]], [-omega[1], omega[0], 0]])
        return np.concatenate(
            [velocity, known.gravity.astype(float), turning.ravel(), np.cross(moments * omega, omega) / moments]
        )

    def gap(_: float, state: np.ndarray) -> float:
        return float((state[2] + CORNERS @ state[6:15].reshape(3, 3)[2]).min())

    gap.terminal = True  # type: ignore[attr-defined]
    axes = rotate(own.quaternion[None].astype(float), np.eye(3)).T
    begin = np.concatenate([own.position.astype(float), own.velocity.astype(float), axes.ravel(), spin])
    solved = solve_ivp(rates, (0, 3), begin, "DOP853", rtol=1e-13, atol=1e-15, events=gap, max_step=0.02)
    (event,) = moved(dropped.motion, known, np.linspace(0, 3, 11)).events
    # The event of SciPy is on its interpolant, which is of a lower order than its steps.
    assert event.time == pytest.approx(solved.t_events[0][0], abs=1e-12)
    assert event.position == pytest.approx(solved.y_events[0][0, :3], abs=1e-11)
    near = np.array([0.0, solved.t[len(solved.t) // 2]])
    found = moved(dropped.motion, known, near)
    state = solved.y[:, len(solved.t) // 2]
    assert found.position[0, 1] == pytest.approx(state[:3], abs=1e-12)
    assert found.spin[0, 1] == pytest.approx(state[15:], abs=1e-12)
    assert rotate(found.quaternion[0, 1].astype(float)[None], np.eye(3)).T.ravel() == pytest.approx(state[6:15], abs=1e-12)


@settings(max_examples=10, deadline=None)
@given(st.tuples(*3 * [st.integers(-40, 40).map(float)]), st.floats(0.2, 1.0), st.floats(-1.0, 2.0))
def test_no_corner_is_below_the_plane_before_the_first_touch(spin: Vector, high: float, up: float) -> None:
    known = falling(position=(0.0, 0.0, high), velocity=(0.0, 0.0, up), spin=spin)
    touch = instant_of(moved(dropped.motion, known, np.array([0.0, 5.0])))
    times = np.linspace(0, touch, 2001)[:-1]
    found = moved(dropped.motion, known, times)
    corners = rotate(found.quaternion[0, :, None].astype(float), np.broadcast_to(CORNERS, (2000, 8, 3)))[..., 2]
    gaps = (found.position[0, :, 2].astype(float) + corners.min(axis=1))[~np.isnan(found.position[0, :, 2].astype(float))]
    # The bound of a height is some roundings of it.
    assert gaps.min() > -1e-14
    assert gaps[-1] < 1e-2 * (1 + np.abs(spin).max())


def test_a_body_that_begins_on_an_edge_has_no_motion() -> None:
    tilted = 0.15 * math.sin(0.4) + 0.05 * math.cos(0.4)
    found = moved(dropped.motion, falling((0.0, 0.0, tilted), (0.0, 0.4, 0.0)), np.linspace(0, 1, 3))
    assert np.isnan(found.position).all()
    assert found.events == ()


def test_what_moves_away_touches_nothing() -> None:
    known = falling(velocity=(0.0, 0.0, 1.0), spin=(1.0, 2.0, 3.0), gravity=0.0)
    found = moved(dropped.motion, known, np.linspace(0, 10, 3))
    assert found.events == ()
    assert not np.isnan(found.position).any()


def test_a_body_that_lies_flat_is_another_ways() -> None:
    assert dropped.motion(falling((0.0, 0.0, 0.05), (0.3, 0.0, 0.0)), np.zeros(1)) is None


def test_a_truth_is_asked_for_at_the_start_alone() -> None:
    """That is how it is found out whether the reference knows a scene."""
    found = moved(dropped.motion, falling(), np.zeros(1))
    assert found.events == ()
    assert not np.isnan(found.position).any()


@pytest.mark.parametrize(
    ("known", "reason"),
    [
        (falling(plane=Plane(friction=math.inf)), "nothing slips"),
        (falling((0.0, 0.0, 0.1)), "into the plane"),
    ],
)
def test_what_has_no_motion_and_no_inequality_is_told(known: Problem, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        dropped.motion(known, np.array([0.0, 1.0]))


@pytest.mark.parametrize("shape", [Ellipsoid(HALF), Cylinder(0.1, 0.2)])
def test_an_ellipsoid_and_a_cylinder_touch_where_their_surfaces_do(shape: Shape) -> None:
    """The first touch against many points of the surface, of which none is below the plane before."""
    attitude, spin = quaternion(*EULER), (2.0, 3.0, -4.0)
    body = Body(2.0, (0.01, 0.02, 0.0225), shape)
    known = problem(Scene(body, State((0.0, 0.0, 0.6), attitude, angular_velocity=spin), 9.81, ROUGH))
    touch = instant_of(moved(dropped.motion, known, np.array([0.0, 2.0])))
    there = moved(dropped.motion, known, np.array([touch * (1 - 1e-12)]))
    around, along = np.meshgrid(np.linspace(0, 2 * np.pi, 721), np.linspace(-1, 1, 721))
    if isinstance(shape, Ellipsoid):
        ring = np.sqrt(1 - along**2)
        points = np.stack([ring * np.cos(around), ring * np.sin(around), along], axis=-1) * HALF
    else:
        points = np.stack([0.1 * np.cos(around), 0.1 * np.sin(around), 0.2 * along], axis=-1)
    heights = float(there.position[0, 0, 2]) + rotate(there.quaternion[0, 0].astype(float), points)[..., 2]
    # The points are 1e-2 rad apart, and the surface between them is lower by the square of that.
    assert heights.min() > -1e-10
    assert heights.min() < 1e-5


def test_falling_is_the_last_way_since_it_gives_inequalities() -> None:
    assert WAYS[-1] is dropped.motion
