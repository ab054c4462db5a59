"""The truth of a coin that rolls without slip."""

import math
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bodycheck.casefile.case import parse
from bodycheck.reference.certificate import certify
from bodycheck.reference.contact.coin import angles, bodily, ends
from bodycheck.reference.contact.coin.start import Coin
from bodycheck.reference.contact.coin.way import APPELL, STEADY, rolling_coin
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact.ways import finite
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.kinematics import geodesic_angle, multiply, rotate
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Brick, Plane, Scene, Vector
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.truth import truth
from bodycheck.reference.truths import Truth
from bodycheck.reference.witness import WideArray, angle_between
from tests.support.cases import a_case
from tests.support.coins import GRAVITY, HALF_LENGTH, MASS, RADIUS, as_coin, body, rolling

#: A wobble between the tilts 0.9 and 1.3.
WOBBLE = rolling(1.2, (0.3, 4.0, -9.0))

#: The instants of most tests (s).
TIMES = np.linspace(0.0, 2.0, 41)


def known(scene: Scene, times: Array = TIMES) -> Truth:
    return truth(scene, times)


def steady_spin(tilt: float, turning: float) -> tuple[float, float, float]:
    """The rates p, q, s of a coin whose line of nodes turns with a rate (rad/s) at a constant tilt (rad).

    The moment of gravity and of the force towards the middle of the circle about the centre of mass is the rate of change of
    the angular momentum, C s K + A q e, which turns with the line of nodes.
    """
    across, _, along = (moment / MASS for moment in body().moments)
    q, kappa = turning * math.sin(tilt), turning * math.cos(tilt)
    level, arm = RADIUS * math.cos(tilt) - HALF_LENGTH * math.sin(tilt), RADIUS * math.sin(tilt) + HALF_LENGTH * math.cos(tilt)
    # Along n: turning (A q cos - C s sin) = g level + turning (s r - q h) arm
    s = (turning * across * q * math.cos(tilt) - GRAVITY * level + turning * q * HALF_LENGTH * arm) / (
        turning * (along * math.sin(tilt) + RADIUS * arm)
    )
    assert kappa == pytest.approx(q / math.tan(tilt))
    return 0.0, q, s


@pytest.mark.parametrize(("tilt", "turning"), [(1.2, 4.0), (0.5, 12.0), (1.0, -7.0)])
def test_a_steady_circle_is_closed_and_its_bound_is_some_roundings(tilt: float, turning: float) -> None:
    rates = steady_spin(tilt, turning)
    found = known(rolling(tilt, rates))
    assert found.model == STEADY
    radius = (rates[1] * HALF_LENGTH - rates[2] * RADIUS) / turning
    # The centre of mass is on a circle about a point beside the start, towards the end of the coin's slope.
    along = np.array([math.cos(0.3), math.sin(0.3)])
    middle = radius * np.array([-along[1], along[0]])
    distances = np.linalg.norm(found.trajectory.position[:, :2] - middle, axis=1)
    assert np.abs(distances - abs(radius)).max() < 1e-15
    assert np.ptp(found.trajectory.position[:, 2]) < 1e-17
    assert np.linalg.norm(found.trajectory.velocity, axis=1) == pytest.approx(abs(radius * turning), rel=1e-14)
    # The file's doubles are steady to their rounding alone; a wobble of that size is within the bound.
    assert found.bounds.position_error.max() < 1e-14
    # The force holds the centre of mass on its circle.
    assert found.friction == pytest.approx(abs(radius) * turning**2 / GRAVITY, rel=1e-12)


def test_a_coin_that_turns_about_its_resting_centre_and_one_on_a_straight_line_are_steady() -> None:
    tilt, times = 1.5, TIMES[TIMES <= 0.5]
    across, _, along = (moment / MASS for moment in body().moments)
    weight = GRAVITY * (RADIUS * math.cos(tilt) - HALF_LENGTH * math.sin(tilt))
    turning = math.sqrt(weight / math.sin(tilt) / (across * math.cos(tilt) - along * math.sin(tilt) * HALF_LENGTH / RADIUS))
    spun = known(rolling(tilt, steady_spin(tilt, turning)), times)
    assert spun.model == STEADY
    assert np.linalg.norm(spun.trajectory.position[:, :2], axis=1).max() < 1e-15
    rolled = known(rolling(math.atan2(RADIUS, HALF_LENGTH), (0.0, 0.0, -12.0)))
    assert rolled.model == STEADY
    expected = 12.0 * RADIUS * TIMES[:, None] * np.array([math.cos(0.3), math.sin(0.3)])
    assert np.abs(rolled.trajectory.position[:, :2] - expected).max() < 1e-15
    assert rolled.friction < 1e-15


def test_a_steady_motion_that_is_unstable_is_followed_as_its_decimals_have_it() -> None:
    found = known(rolling(1.4, steady_spin(1.4, -9.0)))
    assert found.model == APPELL
    # The doubles of the scene, 1e-16 beside the circle, have left it by 1e-9 after 2 s.
    assert found.bounds.position_error.max() < 1e-12


def test_a_wobble_has_a_bound_below_1e_12_and_keeps_its_energy_and_its_contact() -> None:
    found = known(WOBBLE, np.linspace(0.0, 4.0, 201))
    bounds, motion = found.bounds, found.trajectory
    assert bounds.error.max() < 1e-14
    assert bounds.position_error.max() < 1e-14
    assert bounds.velocity_error.max() < 1e-13
    assert bounds.angular_velocity_error.max() < 1e-12
    energies = observe(WOBBLE, motion).total_energy
    assert np.abs(energies - energies[0]).max() < 1e-15 * MASS * GRAVITY
    # The rim's lowest point is on the plane and does not move along it.
    axis = rotate(motion.quaternion, np.tile([0.0, 0.0, 1.0], (len(motion), 1)))
    steep = np.hypot(axis[:, 0], axis[:, 1])[:, None]
    uphill = (np.array([0.0, 0.0, 1.0]) - axis[:, 2:] * axis) / steep
    rim = -HALF_LENGTH * axis - RADIUS * uphill
    assert np.abs(motion.position[:, 2] + rim[:, 2]).max() < 1e-16
    spin = rotate(motion.quaternion, motion.angular_velocity)
    assert np.abs(motion.velocity + np.cross(spin, rim)).max() < 1e-14
    assert found.witnesses
    assert found.events == ()


def test_a_wobble_is_that_of_an_integration_by_other_software() -> None:
    coin = as_coin(WOBBLE)
    times = np.linspace(0.0, 1.0, 11)
    found = known(WOBBLE, times).trajectory
    doubles = replace(
        coin, **{name: np.float64(getattr(coin, name)) for name in ("radius", "half_length", "across", "along", "gravity")}
    )

    def rate(_: float, state: Array) -> Array:
        return np.asarray(bodily.equations(doubles)(state[None])[0], dtype=float)

    span = times / float(coin.time)
    other = solve_ivp(rate, span[[0, -1]], bodily.initial(coin).astype(float), "DOP853", span, rtol=2.3e-14, atol=1e-15)
    assert np.abs(other.y[7:].T * float(coin.length) - found.position).max() < 1e-12
    assert np.abs(other.y[4:7].T / float(coin.time) - found.angular_velocity).max() < 1e-11


def mirrored(scene: Scene) -> Scene:
    """A scene behind a mirror in the plane y = 0; the coin is its own mirror image along its axis J."""
    x, y, z = scene.initial.position
    u, v, w = scene.initial.velocity
    qw, qx, qy, qz = scene.initial.quaternion
    a, b, c = scene.initial.angular_velocity
    state = replace(scene.initial, position=(x, -y, z), velocity=(u, -v, w), quaternion=(qw, -qx, qy, -qz))
    return replace(scene, initial=replace(state, angular_velocity=(-a, b, -c)))


def test_a_mirror_image_rolls_as_the_mirror_image() -> None:
    one, other = known(WOBBLE).trajectory, known(mirrored(WOBBLE)).trajectory
    assert np.abs(one.position * [1, -1, 1] - other.position).max() < 1e-15
    assert np.abs(one.angular_velocity * [-1, 1, -1] - other.angular_velocity).max() < 1e-13
    assert geodesic_angle(one.quaternion * [1, -1, 1, -1], other.quaternion).max() < 1e-14


def test_a_coin_on_its_other_face_rolls_alike() -> None:
    """Half a turn about I exchanges the faces."""
    half = np.array([0.0, 1.0, 0.0, 0.0])
    w, x, y, z = multiply(np.array(WOBBLE.initial.quaternion), half).tolist()
    a, b, c = WOBBLE.initial.angular_velocity
    turned = replace(WOBBLE, initial=replace(WOBBLE.initial, quaternion=(w, x, y, z), angular_velocity=(a, -b, -c)))
    one, other = known(WOBBLE).trajectory, known(turned).trajectory
    assert np.abs(one.position - other.position).max() < 1e-16
    assert np.abs(one.velocity - other.velocity).max() < 1e-16
    assert geodesic_angle(multiply(one.quaternion, np.tile(half, (len(one), 1))), other.quaternion).max() < 1e-15
    assert np.abs(one.angular_velocity * [1, -1, -1] - other.angular_velocity).max() < 1e-14


def test_a_coin_slips_where_the_friction_that_it_needs_exceeds_the_friction() -> None:
    needed = known(WOBBLE).friction
    held = known(replace(WOBBLE, plane=Plane(needed * (1 + 1e-9))))
    assert held.events == ()
    assert held.friction == needed
    assert np.array_equal(held.trajectory.position, known(WOBBLE).trajectory.position)
    start = float(known(WOBBLE, TIMES[:1]).friction)
    friction = (start + needed) / 2
    slipping = known(replace(WOBBLE, plane=Plane(friction)))
    (slip,) = slipping.events
    assert (slip.kind, slipping.friction) == ("slip", 0.0)
    assert np.array_equal(np.isnan(slipping.bounds.error), slip.time < TIMES)
    # Another coin, which rolls on, needs that friction at that instant, and never before.
    assert known(WOBBLE, np.array([0.0, slip.time])).friction == pytest.approx(friction, rel=1e-12)
    moved = known(WOBBLE, np.array([0.0, slip.time])).trajectory
    assert np.abs(moved.position[-1] - slip.position).max() < 1e-15
    assert np.abs(rotate(moved.quaternion, moved.angular_velocity)[-1] - slip.spin).max() < 1e-13
    assert slip.error < 1e-13


def test_an_engine_gets_twice_the_friction_that_is_needed() -> None:
    plane = finite(WOBBLE, 2.0).plane
    assert plane is not None
    assert plane.friction == pytest.approx(2 * known(WOBBLE, np.linspace(0, 2, 1001)).friction, rel=1e-12)


def test_a_coin_without_spin_falls_on_its_face_at_the_instant_of_its_quadrature() -> None:
    scene = rolling(0.8, (0.0, 0.0, 0.0))
    found, landing = rolling_coin(problem(scene), TIMES), landed(scene)
    assert found is not None
    across = mpmath.mpf(body().moments[0]) / mpmath.mpf(MASS) + RADIUS**2 + HALF_LENGTH**2

    def height(tilt: mpmath.mpf) -> mpmath.mpf:
        return HALF_LENGTH * mpmath.cos(tilt) + RADIUS * mpmath.sin(tilt)

    def slowness(depth: mpmath.mpf) -> mpmath.mpf:
        """dt / d depth, with the tilt 0.8 - depth^2, where the coin begins at rest."""
        if depth < 1e-8:
            return 2 / mpmath.sqrt(2 * GRAVITY * (RADIUS * mpmath.cos(0.8) - HALF_LENGTH * mpmath.sin(0.8)) / across)
        return 2 * depth / mpmath.sqrt(2 * GRAVITY * (height(0.8) - height(0.8 - depth**2)) / across)

    # Sixteen digits of mpmath, of which the difference of heights loses some.
    assert landing == pytest.approx(float(mpmath.quad(slowness, [0, mpmath.sqrt(0.8)])), rel=1e-12)
    assert np.array_equal(np.isnan(found.errors["position_error"]), landing < TIMES)
    (impact,) = found.events
    assert (impact.kind, impact.time, impact.ends_flight) == ("impact", landing, False)
    assert impact.error < 1e-16
    assert np.isnan([*impact.velocity, *impact.spin]).all()


def landed(scene: Scene) -> float:
    """When (s) a coin meets the plane with more than a point."""
    coin = as_coin(scene)
    end = ends.followed(coin, math.inf, TIMES / float(coin.time)).end
    assert end is not None
    assert end.kind == "impact"
    return float(end.time * coin.time)


def test_a_coin_that_passes_upright_lands_on_its_side() -> None:
    scene = rolling(1.5, (0.1, 0.5, -12.0))
    landing, before = landed(scene), known(scene, np.array([0.0, landed(scene) * (1 - 1e-12)]))
    assert before.trajectory.position[-1, 2] == pytest.approx(RADIUS, abs=1e-14)
    for friction in (math.inf, 2 * known(scene).friction):
        found = known(replace(scene, plane=Plane(friction)))
        (impact,) = found.events
        assert (impact.kind, impact.time, found.friction) == ("impact", landing, known(scene).friction)
        assert impact.error < 1e-16
        assert np.array_equal(np.isnan(found.trajectory.position).any(axis=1), landing < TIMES)


@pytest.mark.parametrize("rate", [-2.0, -0.1])
def test_both_ways_know_when_a_coin_that_already_falls_lands_on_its_face(rate: float) -> None:
    """The second way has no equations beyond the face, unless it keeps the level diameter about which the coin falls."""
    scene = falling(0.8, rate)
    certificate = certify(scene, TIMES)
    assert certificate.faults == ()
    (impact,) = certificate.truth.events
    assert impact.kind == "impact"
    assert impact.position[2] == HALF_LENGTH


def falling(tilt: float, rate: float) -> Scene:
    """A coin that falls about a level diameter of any direction, with a tilt (rad) and a rate (rad/s) at the start."""
    velocity = list(rolling(tilt, (rate, 0.0, 0.0), psi=0.0).initial.velocity)
    text = a_case(
        body={"shape": "cylinder", "radius": RADIUS, "half_length": HALF_LENGTH, "mass": MASS},
        initial={"euler_zxz": [0.3, tilt, 0.0], "velocity": velocity, "angular_velocity": [rate, 0.0, 0.0]},
        scene={"gravity": GRAVITY, "plane": {"friction": "no-slip"}},
    )
    scene = parse(text, "falling.case.toml").scene
    assert isinstance(scene, Scene)
    return scene


def nudged(scene: Scene, key: str, values: Vector) -> Scene:
    old = getattr(scene.initial, key)
    added: Vector = (old[0] + values[0], old[1] + values[1], old[2] + values[2])
    return replace(scene, initial=replace(scene.initial, **{key: added}))


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        (
            nudged(WOBBLE, "velocity", (3e-4, 0.0, 0.0)),
            "a coin that slips at its start: its rim moves along the plane with 0.0003 m/s",
        ),
        (
            nudged(WOBBLE, "velocity", (0.0, 0.0, 2e-3)),
            "a coin whose rim hits the plane or leaves it at its start, with 0.002 m/s",
        ),
        (replace(WOBBLE, plane=Plane(0.01)), "a coin that slips at its start: it needs the friction 0.1"),
        (rolling(1.0, (20.0, 4.0, -9.0)), "a coin that slips at its start: its rim is lifted from the plane"),
        (
            replace(WOBBLE, body=replace(WOBBLE.body, moments=(1.3e-5, 1.2e-5, 2e-5))),
            "a coin whose moments about its diameters differ: 1.29",
        ),
    ],
)
def test_what_is_not_rolling_without_slip_is_refused_with_a_number(scene: Scene, message: str) -> None:
    with pytest.raises(NotModelled, match=message):
        known(scene)


@pytest.mark.parametrize(
    "scene",
    [
        nudged(WOBBLE, "position", (0.0, 0.0, 1e-9)),
        replace(WOBBLE, body=replace(WOBBLE.body, shape=Brick((0.1, 0.1, 0.1)))),
        replace(WOBBLE, gravity=0.0),
    ],
)
def test_what_is_no_coin_on_its_rim_is_left_to_others(scene: Scene) -> None:
    assert rolling_coin(problem(scene), TIMES) is None


def test_the_bound_covers_a_fault_of_one_formulation(monkeypatch: pytest.MonkeyPatch) -> None:
    """A torque of gravity that is 1e-9 too large in the Euler angles."""
    right = known(WOBBLE)
    accelerated = angles.accelerated

    def heavier(coin: Coin, states: WideArray) -> angles.Accelerated:
        return accelerated(replace(coin, gravity=coin.gravity * Wide(1 + 1e-9)), states)

    monkeypatch.setattr(angles, "accelerated", heavier)
    wrong = known(WOBBLE)
    moved = distance(right.trajectory, wrong.trajectory)
    assert moved[-1] > 1e-12
    assert (moved <= wrong.bounds.position_error).all()


def distance(one: Trajectory, other: Trajectory) -> Array:
    return np.asarray(np.linalg.norm(one.position - other.position, axis=1))


def test_a_coin_that_wobbles_too_much_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ends, "MOST", 300)
    with pytest.raises(OutOfReach, match=r"so close to lying flat: .* more than 300 evaluations"):
        known(rolling(0.05, (0.0, 0.02, -0.3)))


def test_the_bounds_cover_the_errors_against_128_bits() -> None:
    """The decimals of a scene are meant exactly, from the attitude on; the integration is heyoka's."""
    pytest.importorskip("heyoka")
    found = known(WOBBLE)
    exact = quadruple(WOBBLE, TIMES)
    coin = as_coin(WOBBLE)
    position, velocity, quaternion, spin = angles.poses(coin, exact)
    bounds, motion = found.bounds, found.trajectory
    # The differences of doubles from numbers of the wide type, in it.
    apart = np.linalg.norm((motion.position - position * coin.length).astype(float), axis=1)
    assert (apart <= bounds.position_error).all()
    moved = np.linalg.norm((motion.velocity - velocity * (coin.length / coin.time)).astype(float), axis=1)
    assert (moved <= bounds.velocity_error).all()
    assert (angle_between(motion.quaternion, quaternion) <= bounds.error).all()
    turned = np.linalg.norm((motion.angular_velocity - spin / coin.time).astype(float), axis=1)
    assert (turned <= bounds.angular_velocity_error).all()
    # The bounds without the rounding to doubles are those of two integrations in 80 bits.
    own = rolling_coin(problem(WOBBLE), TIMES)
    assert own is not None
    wide = np.sqrt(((own.position[0] - position * coin.length) ** 2).sum(axis=1)).astype(float)
    assert (wide <= own.errors["position_error"]).all()
    assert own.errors["position_error"].max() < 1e-16


def quadruple(scene: Scene, times: Array) -> WideArray:
    """The states (n, 8) of a coin as `contact.coin.angles` has them, in its units, integrated in 128 bits."""
    import heyoka as hy

    from bodycheck.reference.integration.heyoka_solver import QUADRUPLE, compiled, solve

    coin = as_coin(scene)

    def exactly(value: Any) -> Any:
        return QUADRUPLE(mpmath.nstr(value, 40))

    with mpmath.workdps(50):
        length, time = mpmath.mpf(float(coin.length)), mpmath.mpf(float(coin.time))
        r, h = mpmath.mpf(RADIUS) / length, mpmath.mpf(HALF_LENGTH) / length
        a, c = (mpmath.mpf(scene.body.moments[place]) / mpmath.mpf(MASS) / length**2 for place in (0, 2))
        g = mpmath.mpf(GRAVITY) * time**2 / length
        parameters = [exactly(value) for value in (r, h, a, c, g)]
        w, x, y, z = (mpmath.mpf(part) for part in scene.initial.quaternion)
        theta = 2 * mpmath.atan2(mpmath.hypot(x, y), mpmath.hypot(w, z))
        phi, psi = mpmath.atan2(z, w) + mpmath.atan2(y, x), mpmath.atan2(z, w) - mpmath.atan2(y, x)
        i, j, k = (mpmath.mpf(rate) * time for rate in scene.initial.angular_velocity)
        p, q = i * mpmath.cos(psi) - j * mpmath.sin(psi), i * mpmath.sin(psi) + j * mpmath.cos(psi)
        start = np.array([exactly(value) for value in (theta, p, q, k, phi, psi, 0, 0)])
    r, h, a, c, g = (hy.par[place] for place in range(5))
    theta, p, q, s, phi, psi, x, y = hy.make_vars("theta", "p", "q", "s", "phi", "psi", "x", "y")
    cosine, sine = hy.cos(theta), hy.sin(theta)
    kappa, u = q * cosine / sine, q * h - s * r
    turned = q * r + kappa * h
    right_q, right_s = p * (c * s - a * kappa - h * turned), r * p * turned
    determinant = a * c + a * r**2 + c * h**2
    outward = p * (h * cosine + r * sine)
    system = [
        (theta, p),
        (p, (q * (a * kappa - c * s) + turned * u + g * (h * sine - r * cosine)) / (a + r**2 + h**2)),
        (q, ((c + r**2) * right_q + h * r * right_s) / determinant),
        (s, (h * r * right_q + (a + h**2) * right_s) / determinant),
        (phi, q / sine),
        (psi, s - kappa),
        (x, u * hy.cos(phi) + outward * hy.sin(phi)),
        (y, u * hy.sin(phi) - outward * hy.cos(phi)),
    ]
    rows = solve(compiled(system, QUADRUPLE, None), start, np.array(parameters), times / float(coin.time))
    return np.array([[Wide(str(value)) for value in row] for row in rows])
