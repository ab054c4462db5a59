"""A body that leans on an edge or its rim and is released: its fall, and the onset of slipping."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from bodycheck.reference.certificate import certify
from bodycheck.reference.contact.leaning.lean import jams, lean, onset
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.contact_observables import reach
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import MP
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.scene import Body, Brick, Cylinder, Plane, Quaternion, Scene, Shape, State, Vector
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth

GRAVITY = 9.81
MASS = 2.0

#: A rod, a brick, and a coin.
ROD, BLOCK, COIN = Cylinder(0.01, 0.5), Brick((0.3, 0.1, 0.2)), Cylinder(0.5, 0.02)

#: Their half-lengths across and along the axis that is tilted (m).
HALVES: dict[Shape, tuple[float, float]] = {ROD: (0.01, 0.5), BLOCK: (0.1, 0.2), COIN: (0.5, 0.02)}


def leaning(shape: Shape, tilt: float, friction: float, *, yaw: float = 0.0, velocity: Vector = (0.0, 0.0, 0.0)) -> Scene:
    """A body whose axis K is tilted about its axis I (rad), with its lowest points on a level plane."""
    turned = multiply(
        np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]), np.array([math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0])
    )
    w, x, y, z = turned.tolist()
    attitude: Quaternion = (w, x, y, z)
    height = float(reach(shape, turned[None], (0.0, 0.0, 1.0))[0])
    start = State((0.0, 0.0, height), attitude, velocity)
    return Scene(Body(MASS, principal_moments(shape, MASS), shape), start, GRAVITY, Plane(friction))


def forces(theta: float, rate: float, length: float, moment: float) -> Array:
    """T, N (N) and the angular acceleration (rad/s^2), from Newton's and Euler's equations for a contact that stays."""
    s, c = math.sin(theta), math.cos(theta)
    equations = np.array([[1.0, 0.0, -MASS * length * c], [0.0, 1.0, MASS * length * s], [-length * c, length * s, -moment]])
    right = np.array([-MASS * length * rate**2 * s, MASS * (GRAVITY - length * rate**2 * c), 0.0])
    return np.linalg.solve(equations, right)


def integrated(theta: float, length: float, moment: float, friction: float, times: Array) -> tuple[Array, float]:
    """Angles and rates (n, 2) of a fall that holds, and the instant (s) at which friction is not enough."""

    def slack(_: float, state: Array) -> float:
        along, normal, _turn = forces(state[0], state[1], length, moment)
        return friction * normal - abs(along)

    setattr(slack, "terminal", True)  # noqa: B010  (so SciPy wants it)
    way = solve_ivp(
        lambda _, state: np.array([state[1], forces(state[0], state[1], length, moment)[2]]),
        (0.0, times[-1]),
        [theta, 0.0],
        "DOP853",
        rtol=3e-14,
        atol=1e-16,
        max_step=0.01,
        events=slack,
        dense_output=True,
    )
    return way.sol(np.minimum(times, way.t[-1])).T, float(way.t[-1])


@pytest.mark.parametrize(
    ("shape", "tilt", "friction"),
    [
        (ROD, 0.1, 0.3),
        (ROD, 0.1, 0.6),
        (ROD, -0.7, 0.9),
        (BLOCK, 0.9, 0.4),
        (BLOCK, 0.1, 0.4),
        (COIN, 1.2, 0.3),
        (COIN, 0.5, 3.0),
    ],
)
def test_a_body_falls_and_slips_as_an_independent_integration_says(shape: Shape, tilt: float, friction: float) -> None:
    """Newton's and Euler's equations in double precision, tolerance 3e-14 a step; the slip is a root of its interpolant."""
    scene = leaning(shape, tilt, friction, yaw=0.3)
    half, height = HALVES[shape]
    length, start = math.hypot(half, height), abs(tilt) - math.atan2(half, height)
    moment = scene.body.moments[0]
    times = np.linspace(0.0, 2.0, 401)
    expected, slip = integrated(abs(start), length, moment, friction, times)
    found = truth(scene, times)
    (event,) = found.events
    if event.kind == "slip":
        assert event.time == pytest.approx(slip, abs=1e-12)
    else:
        assert slip > event.time
    held = times < event.time
    assert held.any()
    turned = np.sign(tilt) * np.sign(start) * (expected[held, 0] - abs(start))
    attitude = [leaning(shape, tilt + angle, friction, yaw=0.3).initial.quaternion for angle in turned]
    assert found.trajectory.quaternion[held] == pytest.approx(np.array(attitude), abs=1e-12)
    assert np.linalg.norm(found.trajectory.angular_velocity[held], axis=1) == pytest.approx(expected[held, 1], abs=1e-12)
    assert found.trajectory.position[held, 2] == pytest.approx(length * np.cos(expected[held, 0]), abs=1e-12)
    speed = np.linalg.norm(found.trajectory.velocity[held], axis=1)
    assert speed == pytest.approx(length * expected[held, 1], abs=1e-12)
    assert np.isnan(found.trajectory.position[times > event.time]).all()
    assert np.isnan(found.bounds.error[times > event.time]).all()
    assert found.bounds.error[held].max() < 1e-12


def test_the_forces_that_hold_a_contact() -> None:
    """By SymPy: those that give the centre of mass the acceleration of the pendulum; a thin rod has the book's formulas."""
    theta, first, beta, g, length = sympy.symbols("theta theta0 beta g l", positive=True)
    turn, square = beta * g / length * sympy.sin(theta), 2 * beta * g / length * (sympy.cos(first) - sympy.cos(theta))
    assert sympy.simplify(sympy.diff(square, theta) / 2 - turn) == 0
    x, z = length * sympy.sin(theta), length * sympy.cos(theta)
    along = sympy.diff(x, theta) * turn + sympy.diff(x, theta, 2) * square
    normal = g + sympy.diff(z, theta) * turn + sympy.diff(z, theta, 2) * square
    cosine, start = sympy.cos(theta), sympy.cos(first)
    assert sympy.simplify(along - beta * g * sympy.sin(theta) * (3 * cosine - 2 * start)) == 0
    stated = g * (1 - beta * (1 + 2 * cosine * start - 3 * cosine**2))
    assert sympy.simplify(normal - stated) == 0
    # Euler's equation holds with k^2 = l^2 (1 - beta) / beta.
    spin = turn * length**2 * (1 - beta) / beta
    assert sympy.simplify(spin - normal * x + along * z) == 0
    thin = {beta: sympy.Rational(3, 4), first: 0}
    assert sympy.simplify((along - 3 * g * sympy.sin(theta) * (3 * cosine - 2) / 4).subs(thin)) == 0
    assert sympy.simplify((normal - g * (3 * cosine - 1) ** 2 / 4).subs(thin)) == 0


def test_a_thin_rod_from_nearly_upright_slips_where_the_formulas_of_the_book_say() -> None:
    """Below mu = 0.371 it slips before cos(theta) = 9/11, backwards, and otherwise after cos(theta) = 2/3, forwards."""
    thin = Cylinder(1e-7, 0.5)
    for friction, backwards in ((0.30, True), (0.37, True), (0.372, False), (0.8, False)):
        falling = lean(problem(leaning(thin, 1e-5, friction)))
        assert falling is not None
        kind, cosine = onset(falling, friction)
        assert kind == "slip"
        at = float(cosine)
        needed = 3 * math.sqrt(1 - at**2) * abs(3 * at - 2) / (3 * at - 1) ** 2
        assert needed == pytest.approx(friction, abs=1e-6)
        assert (at > 2 / 3) is backwards


@given(st.floats(0.05, 1.5), st.floats(0.0, 1.2))
def test_what_slips_at_once_is_decided_by_the_first_forces(tilt: float, friction: float) -> None:
    falling = lean(problem(leaning(ROD, tilt, friction)))
    assert falling is not None
    cosine = MP.cos(falling.angle)
    along, normal = falling.forces(cosine)
    kind, at = onset(falling, friction)
    assert (kind == "slip" and at == cosine) is bool(along > MP.mpf(friction) * normal)


def test_a_body_on_which_nothing_slips_lands() -> None:
    times = np.linspace(0.0, 2.0, 21)
    found = truth(leaning(BLOCK, 1.2, math.inf), times)
    (event,) = found.events
    assert event.kind == "impact"
    assert event.position[2] == pytest.approx(0.1, abs=1e-15)
    # Energy: half of (m k^2 + m l^2) times the rate squared is what the centre of mass has lost in height.
    lost = found.trajectory.position[0, 2] - 0.1
    rate = -truth(leaning(BLOCK, 1.2, math.inf), np.array([0.0, event.time * (1 - 1e-15)])).trajectory.velocity[-1, 2] / 0.2
    moment = principal_moments(BLOCK, MASS)[0] + MASS * 0.05
    assert moment * rate**2 / 2 == pytest.approx(MASS * GRAVITY * lost, rel=1e-14)
    # Twice the friction that it needs holds it, and a little less does not.
    for part, kind in ((1 + 1e-9, "impact"), (1 - 1e-9, "slip")):
        (end,) = truth(leaning(BLOCK, 1.2, part * found.friction), times).events
        assert end.kind == kind


def test_a_body_that_the_plane_would_have_to_pull_slips_even_without_slip() -> None:
    """With its mass in its centre, N is m g cos a (3 cos a - 2 cos b), which is zero at 2/3 of the first cosine."""
    heavy = leaning(BLOCK, 1.2, math.inf)
    scene = replace(heavy, body=replace(heavy.body, moments=(1e-30, 1e-30, 1e-30)))
    certificate = certify(scene, np.linspace(0.0, 2.0, 21))
    assert certificate.faults == ()
    (slip,) = certificate.truth.events
    assert slip.kind == "slip"
    assert slip.position[2] == pytest.approx(2 / 3 * scene.initial.position[2], rel=1e-14)
    assert np.array_equal(np.isnan(certificate.truth.bounds.error), slip.time < certificate.truth.trajectory.t)
    # The friction that it needs grows beyond all bounds as the normal force vanishes.
    early, late = (truth(scene, np.array([0.0, part * slip.time])).friction for part in (0.9, 0.999))
    assert certificate.truth.friction > late > early > 1
    assert certificate.truth.friction < 1e9


def test_a_small_lean_grows_and_its_bound_with_it() -> None:
    times = np.linspace(0.0, 4.0, 5)
    scene = leaning(BLOCK, math.atan2(0.1, 0.2) + 1e-9, math.inf)
    found = truth(scene, times)
    assert (np.diff(found.bounds.error[np.isfinite(found.bounds.error)]) >= 0).all()


def test_no_motion_is_given_where_friction_is_inconsistent() -> None:
    """A thin rod that slides against its lean jams for mu > (1/3 + sin^2) / (sin cos), which is 4/3 at least."""
    tilt = math.atan(0.5)
    for velocity, friction in (((0.0, 1.0, 0.0), 1.4), ((0.0, 1.0, 0.0), 1.3), ((0.0, -1.0, 0.0), 1.4)):
        scene = leaning(Cylinder(1e-9, 0.5), tilt, friction, velocity=velocity)
        falling = lean(problem(scene))
        assert falling is not None
        towards = float(falling.towards[1])
        expected = velocity[1] * towards < 0 and friction > 4 / 3 + 1e-6
        assert jams(falling, friction, velocity[1] * towards) is expected
        if expected:
            with pytest.raises(NotModelled, match="Painlevé"):
                truth(scene, np.array([0.0, 1.0]))
