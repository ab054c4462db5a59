"""What a sphere on a plane must do by the laws: closed forms, what is conserved, limits, bounds, and what has no truth."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from bodycheck.reference.contact.motion import ContactMotion
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact.round import phases
from bodycheck.reference.contact.ways import contact_motion
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, Real
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.scene import Plane, State, Vector
from bodycheck.reference.trajectory import Array
from tests.support.round_bodies import ball_on

RADIUS, G, RATIO = 0.1, 9.81, 0.4
LYING = (0.0, 0.0, RADIUS)


def moved(plane: Plane, state: State, *times: float) -> ContactMotion:
    return contact_motion(problem(ball_on(plane, state)), np.array(times))


def dropped(height: float, restitution: float, *times: float) -> ContactMotion:
    return moved(Plane(0.3, restitution=restitution), State((0.0, 0.0, RADIUS + height)), *times)


def energies(found: ContactMotion, plane: Plane) -> Array:
    """Kinetic and potential energies (n,) of one kilogram."""
    gravity = np.array([math.sin(plane.incline), 0.0, -math.cos(plane.incline)]) * G
    moving = (found.velocity[0] ** 2).sum(axis=1) / 2 + RATIO * RADIUS**2 * (found.spin[0] ** 2).sum(axis=1) / 2
    return np.asarray(moving - found.position[0] @ gravity, dtype=float)


def test_the_slip_on_a_level_plane_falls_straight_at_seven_halves_of_the_friction() -> None:
    found = moved(Plane(0.25), State(LYING, velocity=(3.0, 0.0, 0.0)), 0.1, 1.0)
    (roll,) = found.events
    assert roll.time == pytest.approx(3.0 / (3.5 * 0.25 * G), rel=1e-15)
    assert roll.velocity == pytest.approx((15 / 7, 0.0, 0.0), rel=1e-15)
    slip = found.velocity[0, 0, 0] - RADIUS * rotate(found.quaternion[0], found.spin[0])[0, 1]
    assert float(slip) == pytest.approx(3.0 - 3.5 * 0.25 * G * 0.1, rel=1e-15)


@pytest.mark.parametrize(
    ("friction", "acceleration"), [(0.2, 5 / 7 * math.sin(0.5)), (0.1, math.sin(0.5) - 0.1 * math.cos(0.5))]
)
def test_a_ball_rolls_down_an_incline_up_to_seven_halves_of_the_friction(friction: float, acceleration: float) -> None:
    found = moved(Plane(friction, incline=0.5), State(LYING), 2.0)
    assert float(found.velocity[0, 0, 0]) == pytest.approx(2 * G * acceleration, rel=1e-15)
    assert float(found.position[0, 0, 0]) == pytest.approx(2 * G * acceleration, rel=1e-15)


@pytest.mark.parametrize("restitution", [0.0, 0.2, 0.5, 0.8, 0.95])
def test_a_dropped_ball_rests_after_a_geometric_series_of_bounces(restitution: float) -> None:
    fall = math.sqrt(2 * 0.5 / G)
    rest = fall * (1 + restitution) / (1 - restitution)
    found = dropped(0.5, restitution, 0.0, 2 * rest, 1e6)
    *impacts, last = found.events
    assert (last.kind, last.time) == ("rest", pytest.approx(rest, rel=1e-14))
    for n, impact in enumerate(impacts[:10]):
        assert impact.normal_speed == pytest.approx(math.sqrt(2 * G * 0.5) * restitution**n, rel=1e-14)
    assert found.position[0, 1:, 2].tolist() == [RADIUS, RADIUS]
    assert not found.velocity[0, 1:].any()


def test_a_ball_without_losses_bounces_for_ever_to_the_same_height(monkeypatch: pytest.MonkeyPatch) -> None:
    fall = math.sqrt(2 * 0.5 / G)
    found = dropped(0.5, 1.0, *(fall * 2 * n for n in range(50)))
    assert found.position[0, :, 2].astype(float) == pytest.approx(RADIUS + 0.5, abs=1e-13)
    assert {event.kind for event in found.events} == {"impact"}
    monkeypatch.setattr(phases, "MAX_IMPACTS", 100)
    with pytest.raises(OutOfReach, match="bounces more than 100 times"):
        dropped(0.5, 1.0, 100.0)


def test_without_friction_nothing_turns_or_brakes() -> None:
    found = moved(
        Plane(restitution=0.5), State((0.0, 0.0, 0.4), velocity=(1.0, 2.0, 0.0), angular_velocity=(3.0, 4.0, 5.0)), 3.0
    )
    assert found.velocity[0, 0].astype(float).tolist() == [1.0, 2.0, 0.0]
    assert rotate(found.quaternion[0], found.spin[0])[0].astype(float) == pytest.approx([3.0, 4.0, 5.0], rel=1e-15)


def test_little_friction_and_little_incline_change_little() -> None:
    state = State(LYING, velocity=(-1.0, 2.0, 0.0), angular_velocity=(5.0, -8.0, 3.0))
    smooth, level = moved(Plane(0.0, incline=0.4), state, 1.0), moved(Plane(0.3), state, 1.0)
    nearly_smooth, nearly_level = moved(Plane(1e-9, incline=0.4), state, 1.0), moved(Plane(0.3, incline=1e-9), state, 1.0)
    assert nearly_smooth.position[0] == pytest.approx(smooth.position[0], abs=1e-8)
    assert nearly_level.position[0] == pytest.approx(level.position[0], abs=1e-8)


STATES = st.builds(
    State,
    st.tuples(st.just(0.0), st.just(0.0), st.just(RADIUS) | st.floats(RADIUS, 1.0)),
    st.just((1.0, 0.0, 0.0, 0.0)),
    st.tuples(*[st.floats(-3.0, 3.0)] * 2, st.just(0.0) | st.floats(-3.0, 3.0)),
    st.tuples(*[st.floats(-30.0, 30.0)] * 3),
)
PLANES = st.builds(
    Plane, st.floats(0.0, 1.0), incline=st.just(0.0) | st.floats(1e-3, 1.2), restitution=st.just(0.0) | st.floats(0.0, 0.9)
)


@given(PLANES, STATES)
@settings(deadline=None, max_examples=25)
def test_any_start_obeys_the_laws(plane: Plane, state: State) -> None:
    """Momentum about the point that touches, energy, the plane, and Coulomb's law between any two instants."""
    times = np.linspace(0.0, 2.0, 41)
    found = moved(plane, state, *times)
    spin = rotate(found.quaternion[0], found.spin[0]).astype(float)
    velocity = found.velocity[0].astype(float)
    speed = 1 + np.abs(velocity).max() + RADIUS * np.abs(spin).max()
    downhill, onto = G * math.sin(plane.incline), G * math.cos(plane.incline)
    momentum = np.stack([velocity[:, 0] + RATIO * RADIUS * spin[:, 1], velocity[:, 1] - RATIO * RADIUS * spin[:, 0]])
    momentum[0] -= downhill * times
    assert momentum == pytest.approx(np.broadcast_to(momentum[:, :1], momentum.shape), abs=1e-13 * speed)
    assert spin[:, 2] == pytest.approx(spin[0, 2], abs=1e-13 * speed / RADIUS)
    energy = energies(found, plane)
    assert np.diff(energy).max() <= 1e-12 * np.abs(energy).max()
    assert found.position[0, :, 2].min() >= RADIUS * (1 - 1e-12)
    # What friction can have given is mu times what the plane has given along the normal.
    gained = np.diff(velocity, axis=0) - np.diff(times)[:, None] * [downhill, 0.0, -onto]
    assert (np.hypot(gained[:, 0], gained[:, 1]) <= plane.friction * gained[:, 2] + 1e-13 * speed).all()


def test_the_hodograph_solves_the_equation_of_a_slip_across_the_fall_line() -> None:
    g, c, a, b, q = sp.symbols("g c a b q", positive=True)
    x = a * sp.exp(-(c - g) * q) - b * sp.exp(-(c + g) * q)
    y = 2 * sp.sqrt(a * b) * sp.exp(-c * q)
    pace = a * sp.exp(-(c - g) * q) + b * sp.exp(-(c + g) * q)
    assert sp.simplify(sp.expand(x**2 + y**2 - pace**2)) == 0
    assert sp.simplify(sp.expand(sp.diff(x, q) - (g * pace - c * x))) == 0  # dq is dt over the speed
    assert sp.simplify(sp.diff(y, q) + c * y) == 0


def test_impulse_and_momentum_give_the_laws_of_an_impact() -> None:
    """An impulse p over the mass changes the velocity by p and the spin by -p/(k r), and so the slip by (1 + 1/k) p."""
    v, w, p, k, r = sp.symbols("v w p k r")
    arm, impulse = sp.Matrix([0, 0, -r]), sp.Matrix([p, 0, 0])
    spin = sp.Matrix([0, w, 0]) + arm.cross(impulse) / (k * r**2)
    slip = (sp.Matrix([v, 0, 0]) + impulse + spin.cross(arm))[0]
    assert sp.simplify(slip - (v - r * w + (1 + 1 / k) * p)) == 0
    (ending,) = sp.solve(slip, p)
    assert sp.simplify(ending + (v - r * w) * k / (1 + k)) == 0


def bounces(times: Array, height: Real, restitution: Real, gravity: Real) -> list[Real]:
    """Heights over the plane of a ball that is dropped, in a hundred digits."""
    found = []
    for t in map(MP.mpf, times):
        begin, rise, above = MP.mpf(0), MP.mpf(0), height
        while True:
            speed = MP.sqrt(rise**2 + 2 * gravity * above)
            if t <= begin + (rise + speed) / gravity:
                found.append(above + rise * (t - begin) - gravity * (t - begin) ** 2 / 2)
                break
            begin, rise, above = begin + (rise + speed) / gravity, restitution * speed, MP.mpf(0)
    return found


def test_bounds_hold_against_a_hundred_digits() -> None:
    times = np.linspace(0.0, 1.6, 33)
    found = dropped(0.5, 0.8, *times)
    height = MP.mpf(RADIUS + 0.5) - MP.mpf(RADIUS)
    exact = bounces(times, height, MP.mpf(0.8), MP.mpf(G))
    error = [
        abs(MP.mpf(float(z)) + MP.mpf(float(z - float(z))) - MP.mpf(RADIUS) - x)
        for z, x in zip(found.position[0, :, 2], exact, strict=True)
    ]
    assert all(e <= bound for e, bound in zip(error, found.errors["position_error"], strict=True))
    assert found.errors["position_error"].max() < 1e-14


def test_at_an_impact_the_bound_allows_both_velocities() -> None:
    (first, *_) = dropped(0.5, 0.8, 1.0).events
    found = dropped(0.5, 0.8, first.time)
    # The double nearest to the instant is farther away from it than its error, or the bound is that of the jump.
    before, after = -first.normal_speed, 0.8 * first.normal_speed
    known = float(found.velocity[0, 0, 2])
    assert min(abs(known - before), abs(known - after)) < 1e-12
    assert found.errors["velocity_error"][0] < 1e-12 or found.errors["velocity_error"][0] >= after - before


def test_at_the_steepest_slope_the_bound_allows_slip_and_roll() -> None:
    friction = 0.2
    incline = math.atan(3.5 * friction)
    ends = [moved(Plane(friction, incline=math.nextafter(incline, side)), State(LYING), 60.0) for side in (0.0, 2.0)]
    apart = abs(float(ends[1].position[0, 0, 0] - ends[0].position[0, 0, 0]))
    assert apart <= sum(float(end.errors["position_error"][0]) for end in ends) + 1e-11 * apart
    assert max(end.errors["position_error"][0] for end in ends) < 1e-10


@pytest.mark.parametrize(
    ("state", "incline", "needed"),
    [
        (State(LYING), 0.0, 0.0),
        (State(LYING), 0.3, math.tan(0.3) * 2 / 7),
        (State((0.0, 0.0, 0.6), velocity=(1.0, 0.0, 0.0)), 0.0, 2 / 7 / 1.5 / math.sqrt(2 * G * 0.5)),
    ],
)
def test_where_nothing_slips_the_smallest_friction_that_holds_is_told(state: State, incline: float, needed: float) -> None:
    for friction in (math.inf, needed * 1.001 + 1e-3):
        found = moved(Plane(friction, incline=incline, restitution=0.5), state, 0.0, 1.0)
        assert found.friction == pytest.approx(needed, rel=1e-12)
    if needed:
        assert moved(Plane(needed * 0.999, incline=incline, restitution=0.5), state, 0.0, 1.0).friction == 0


def test_a_ball_at_rest_bears_its_weight_on_the_plane() -> None:
    (load,) = moved(Plane(0.3), State(LYING), 0.0, 60.0).interfaces
    assert load.bodies == (-1, 0)
    assert load.load == pytest.approx(2.0 * G, rel=1e-15)
    assert moved(Plane(0.3), State(LYING, angular_velocity=(0.0, 0.0, 1.0)), 1.0).interfaces == ()


@pytest.mark.parametrize(
    ("plane", "position", "velocity", "reason"),
    [
        (Plane(0.3), (0.0, 0.0, 0.09), (0.0, 0.0, 0.0), "begins within the plane"),
        (Plane(math.inf), LYING, (1.0, 0.0, 0.0), "slips at the start on a plane on which nothing slips"),
    ],
)
def test_what_has_no_truth_says_why(plane: Plane, position: Vector, velocity: Vector, reason: str) -> None:
    with pytest.raises(NotModelled, match=reason):
        moved(plane, State(position, velocity=velocity), 0.0)
