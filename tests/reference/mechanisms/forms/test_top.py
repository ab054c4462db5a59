"""Lagrange's top and other bodies on a ball joint: published values, equations in 80 bits, and special cases."""

import math
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy

from bodycheck.reference.exact.numbers import MP, Wide, wide
from bodycheck.reference.exact.rotations import unit
from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.flight.closed_form import flight
from bodycheck.reference.kinematics import geodesic_angle, multiply
from bodycheck.reference.mechanisms.forms import top
from bodycheck.reference.mechanisms.forms.carlson import third_kind
from bodycheck.reference.mechanisms.forms.choice import form_of
from bodycheck.reference.mechanisms.forms.motion import FormMotion
from bodycheck.reference.mechanisms.forms.top import Top
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Definition, Quaternion, Tensor, Vector

TIMES = np.array([0.0, 0.125, 1.0, 2.5, 7.0, 20.0])

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
HANGING = (0.0, 1.0, 0.0, 0.0)


def tilted(angle: float, spin: float = 0.3) -> Quaternion:
    """An attitude whose axis is off the vertical by an angle."""
    half = angle / 2
    return math.cos(half), math.sin(half) * math.cos(spin), math.sin(half) * math.sin(spin), 0.0


#: Moments I1 and I3, mu = M g r, attitude, rates.
TOPS: dict[str, tuple[float, float, float, Quaternion, Vector]] = {
    "fast": (1.0, 0.5, 3.0, tilted(0.5), (0.0, 0.0, 20.0)),
    "looping": (1.0, 0.5, 3.0, tilted(0.5), (0.3, -0.5, 20.0)),
    "cusped": (1.0, 1.7, 2.0, tilted(1.2), (0.0, 0.0, 5.0)),
    "spherical pendulum": (1.0, 0.3, 9.0, tilted(2.0), (0.4, 1.5, 0.0)),
    "plane pendulum": (1.0, 0.3, 9.0, tilted(2.0, 0.0), (1.0, 0.0, 0.0)),
    "plane pendulum over the top": (1.0, 0.3, 9.0, tilted(2.0, 0.0), (9.0, 0.0, 0.0)),
    "plane pendulum from upright": (1.0, 0.3, 9.0, UPRIGHT, (0.0, 3.0, 0.0)),
    "plane pendulum from hanging": (1.0, 0.3, 9.0, HANGING, (0.0, -7.0, 0.0)),
    "from upright": (1.0, 0.5, 3.0, UPRIGHT, (1.0, 0.5, 8.0)),
    "from hanging": (1.0, 0.5, 3.0, HANGING, (1.0, 0.5, 8.0)),
    "nearly through upright": (1.0, 0.5, 3.0, tilted(1e-7), (1.0, 0.5, 8.0)),
    "nearly through hanging": (1.0, 0.5, 3.0, tilted(math.pi - 1e-7), (-1.0, 0.5, 8.0)),
    "nearly plane": (1.0, 0.5, 3.0, tilted(2.0, 0.0), (1.0, 1e-6, 0.0)),
    "asleep": (1.0, 0.5, 3.0, UPRIGHT, (0.0, 0.0, 40.0)),
    "asleep but unstable": (1.0, 0.5, 3.0, UPRIGHT, (0.0, 0.0, 1.0)),
    "hanging asleep": (1.0, 0.5, 3.0, HANGING, (0.0, 0.0, 1.0)),
    "at rest, hanging": (1.0, 0.5, 3.0, HANGING, (0.0, 0.0, 0.0)),
    "small wobble": (1.0, 0.5, 3.0, UPRIGHT, (1e-8, 0.0, 40.0)),
}


@cache
def equations() -> Any:
    """The equations of the top as an integrator of heyoka in 80 bits; its parameters are I1, I3 and mu."""
    heyoka = pytest.importorskip("heyoka")
    w, x, y, z, p, q, r = heyoka.make_vars("w", "x", "y", "z", "p", "q", "r")
    across, along, weight = (heyoka.par[n] for n in range(3))
    up_x, up_y = 2 * (x * z - w * y), 2 * (y * z + w * x)
    half = Wide(0.5)
    system = [
        (w, -half * (x * p + y * q + z * r)),
        (x, half * (w * p + y * r - z * q)),
        (y, half * (w * q + z * p - x * r)),
        (z, half * (w * r + x * q - y * p)),
        (p, ((across - along) * q * r + weight * up_y) / across),
        (q, ((along - across) * p * r - weight * up_x) / across),
        (r, 0 * r),
    ]
    return heyoka.taylor_adaptive(system, [Wide(0)] * 7, fp_type=Wide, pars=[Wide(1)] * 3, compact_mode=True)


@pytest.mark.parametrize("name", TOPS)
def test_the_form_obeys_the_equations(name: str) -> None:
    across, along, weight, attitude, rates = TOPS[name]
    exact = unit(tuple(MP.mpf(part) for part in attitude))
    found = top.follow(Top(*(MP.mpf(v) for v in (across, along, weight)), exact, tuple(map(MP.mpf, rates))), TIMES)
    solver = equations()
    solver.time = Wide(0)
    solver.pars[:] = np.array([across, along, weight], dtype=Wide)
    solver.state[:] = np.array([*(wide(part) for part in exact), *rates], dtype=Wide)
    states = solver.propagate_grid(TIMES.astype(Wide))[5]
    apart = geodesic_angle(found.attitude, states[:, :4])
    # Taylor's method errs by some roundings of 80 bits for each step, which an unstable equilibrium multiplies.
    growth = np.exp(min(math.sqrt(weight) * 20, 12.0)) if "asleep but" not in name else 1.0
    own = 40 * float(np.finfo(Wide).eps) * (1 + np.abs(rates).sum() * 20 + 20) * growth
    assert np.all(apart <= found.error + own)
    assert np.abs(found.rates - states[:, 4:]).max() <= found.rates_error.max() + own * (4 + abs(rates[2]))
    assert found.error.max() < 1e-14


@pytest.mark.parametrize("attitude", [UPRIGHT, tilted(2.0, 0.0)])
def test_the_asymptotic_top_rises_for_ever(attitude: Quaternion) -> None:
    """A top without spin with the energy of the upright rest climbs to it, and no arithmetic but a closed form follows."""
    exact = unit(tuple(MP.mpf(part) for part in attitude))
    cosine = 1 - 2 * (exact[1] ** 2 + exact[2] ** 2)
    speed = MP.sqrt(2 * 9 * (1 - cosine))
    zero = MP.mpf(0)
    found = top.follow(Top(MP.mpf(1), MP.mpf("0.3"), MP.mpf(9), exact, (-speed, zero, zero)), np.array([1.0, 50.0]))
    assert abs(float(2 * np.hypot(found.attitude[1, 1], found.attitude[1, 2]))) < 1e-15


def published() -> FormMotion:
    """The heavy top of the literature on multibody integrators."""
    rows = ((0.234375, 0.0, 0.0), (0.0, 0.46875, 0.0), (0.0, 0.0, 0.234375))
    body = JointedBody("top", Tensor(15.0, rows), (0.0, 1.0, 0.0))
    ball = Joint("ball", "spherical", WORLD, 0, start=UPRIGHT, start_velocity=(0.0, 150.0, -4.61538))
    form = form_of(Mechanism((body,), (ball,), (), 9.81))
    assert form is not None
    assert form.name == "Lagrange top"
    return form.follow(np.array([0.2, 1.0]))


def test_the_heavy_top_of_the_literature() -> None:
    found = published()
    expected = [[-0.70827915, 0.43878109, 0.54572840, 0.08939975], [0.73294398, -0.27828572, 0.53182461, -0.32017614]]
    # Eight decimals are published.
    assert np.abs(found.position - np.array(expected)).max() < 0.51e-8
    assert found.error.max() < 2e-15


@pytest.mark.parametrize(
    ("side", "frame", "rates"),
    [(1.0, (1.0, -1.0, 0.0, 0.0), (0.0, 4.61538, 150.0)), (-1.0, (1.0, 1.0, 0.0, 0.0), (0.0, -4.61538, -150.0))],
)
def test_the_frames_of_the_joint_and_of_the_body_do_not_matter(side: float, frame: Quaternion, rates: Vector) -> None:
    """The body's axis of symmetry is its z or -z instead of y, and the joint's axes are turned: the motion is the same."""
    body = JointedBody("top", Tensor(15.0, ((0.234375, 0.0, 0.0), (0.0, 0.234375, 0.0), (0.0, 0.0, 0.46875))), (0.0, 0.0, side))
    joint, back = np.array([2.0, 1.0, -1.0, 0.0]), np.array([2.0, -1.0, 1.0, 0.0])
    w, x, y, z = map(float, multiply(back, np.array(frame)))
    turned = (float(joint[0]), float(joint[1]), float(joint[2]), float(joint[3]))
    ball = Joint("ball", "spherical", WORLD, 0, attitude=turned, start=(w, x, y, z), start_velocity=rates)
    form = form_of(Mechanism((body,), (ball,), (), 9.81))
    assert form is not None
    found, plain = form.follow(np.array([0.2, 1.0])), published()
    world = multiply(np.tile(joint / np.sqrt(6), (2, 1)), found.position.astype(float))
    expected = multiply(plain.position.astype(float), np.tile(np.array(frame) / np.sqrt(2), (2, 1)))
    # Some roundings of a double in the comparison itself.
    assert geodesic_angle(world, expected).max() < 2e-15


def test_a_body_on_a_ball_at_its_centre_turns_freely() -> None:
    rows = ((2.0, 0.1, 0.0), (0.1, 3.0, 0.2), (0.0, 0.2, 4.0))
    attitude, rates = (0.5, 0.5, -0.5, 0.5), (0.1, 2.0, 0.01)
    ball = Joint("ball", "spherical", WORLD, 0, start=attitude, start_velocity=rates)
    form = form_of(Mechanism((JointedBody("body", Tensor(1.0, rows)),), (ball,), (), 9.81))
    assert form is not None
    found = form.follow(TIMES)
    scene = defined_scene(Definition(Tensor(1.0, rows), attitude, rates), None)
    free = flight(scene, TIMES)
    assert np.all(geodesic_angle(found.position.astype(float), free.motion.quaternion) <= found.error)
    assert np.abs(found.velocity - free.motion.angular_velocity).max() <= found.velocity_error.max()


def test_what_is_not_symmetric_or_is_damped_has_no_form() -> None:
    rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0))
    start: dict[str, Any] = {"start": UPRIGHT, "start_velocity": (0.0, 0.0, 0.0)}
    for centre, damping, known in (((0.0, 0.0, 1.0), 0.0, True), ((0.1, 0.0, 1.0), 0.0, False), ((0.0, 0.0, 1.0), 0.1, False)):
        ball = Joint("ball", "spherical", WORLD, 0, damping=damping, **start)
        body = JointedBody("body", Tensor(1.0, rows), centre)
        assert (form_of(Mechanism((body,), (ball,), (), 9.81)) is not None) == known


def test_carlson_s_integral() -> None:
    random = np.random.default_rng(5)
    numbers = 10.0 ** random.uniform([[-12], [-12], [-12], [-12]], [[2], [2], [2], [12]], (4, 60))
    numbers[0, ::5] = 0
    found = third_kind(*numbers.astype(Wide))
    with mpmath.workdps(40):
        for got, (x, y, z, p) in zip(found, numbers.T, strict=True):
            expected = mpmath.elliprj(*(mpmath.mpf(float(v)) for v in (x, y, z, p)))
            ratio = (mpmath.mpf(float(got)) + mpmath.mpf(float(got - Wide(float(got))))) / expected
            assert abs(ratio - 1) < 10 * float(np.finfo(Wide).eps)


def test_sympy_proves_the_reduction() -> None:
    """The rates of phi, psi and theta of the module are those of the Lagrangian of a symmetric top."""
    i1, i3, mu, dphi, dtheta, dpsi, theta = sympy.symbols("I1 I3 mu dphi dtheta dpsi theta", positive=True)
    u = sympy.cos(theta)
    kinetic = i1 / 2 * (dtheta**2 + dphi**2 * sympy.sin(theta) ** 2) + i3 / 2 * (dpsi + dphi * u) ** 2
    vertical, axial = sympy.diff(kinetic, dphi), sympy.diff(kinetic, dpsi)
    drift = axial * (1 / i3 - 1 / i1)
    assert sympy.simplify(dphi + dpsi - drift - (vertical + axial) / (i1 * (1 + u))) == 0
    assert sympy.simplify(dphi - dpsi + drift - (vertical - axial) / (i1 * (1 - u))) == 0
    energy = kinetic + mu * u - axial**2 / (2 * i3)
    cubic = (1 - u**2) * 2 * (energy - mu * u) / i1 - (vertical - axial * u) ** 2 / i1**2
    assert sympy.simplify(cubic - sympy.sin(theta) ** 2 * dtheta**2) == 0
