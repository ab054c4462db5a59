"""One joint with armature, damping, spring, effort and dry friction, against arithmetic of a hundred digits."""

import itertools

import numpy as np
import pytest
import sympy

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import MP, Real
from bodycheck.reference.mechanisms.forms import oscillator
from bodycheck.reference.mechanisms.forms.choice import form_of
from bodycheck.reference.mechanisms.forms.oscillator import Oscillator
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Mechanism
from bodycheck.reference.scene import Tensor

TIMES = np.array([0.0, 1e-9, 1e-3, 0.1, 0.7, 2.0, 9.0, 100.0])


def system(**numbers: float) -> Oscillator:
    """An oscillator of unit inertia from what differs from rest at 0.3 with the velocity -0.8."""
    given = {"inertia": 1.0, "damping": 0.0, "stiffness": 0.0, "rest": 0.0, "force": 0.0, "friction": 0.0, "start": 0.3}
    return Oscillator(**{name: MP.mpf(value) for name, value in ({"velocity": -0.8} | given | numbers).items()})


def exactly(of: Oscillator, t: float) -> tuple[Real, Real]:
    """The motion without friction at a time > 0, from the two complex roots of the characteristic equation."""
    gamma, square = of.damping / (2 * of.inertia), of.stiffness / of.inertia
    # Roots that are equal or zero are moved by 1e-40, which moves the motion by less than 1e-30.
    root = MP.sqrt(gamma**2 - square) or MP.mpf(10) ** -40
    one, other = -gamma + root, (-gamma - root) or MP.mpf(10) ** -41
    one = one or MP.mpf(10) ** -41
    a, tau = (of.force - of.stiffness * (of.start - of.rest)) / of.inertia, MP.mpf(t)
    first, second = MP.exp(one * tau), MP.exp(other * tau)
    b, db = (first - second) / (one - other), (one * first - other * second) / (one - other)
    c = ((first - 1) / one - (second - 1) / other) / (one - other)
    return MP.re(of.start + of.velocity * b + a * c), MP.re(of.velocity * db + a * b)


@pytest.mark.parametrize("damping", [0.0, 1e-12, 0.3, 2.0, 2.0 + 1e-15, 2.0 - 1e-7, 50.0, 1e6])
@pytest.mark.parametrize("stiffness", [0.0, 1e-20, 1e-6, 1.0, 400.0])
def test_the_linear_motion_keeps_its_bound(damping: float, stiffness: float) -> None:
    of = system(damping=damping, stiffness=stiffness, force=0.25, rest=0.1)
    found = oscillator.follow(of, TIMES)
    for row, t in enumerate(TIMES[1:], 1):
        for got, bound, wanted in zip(
            (found.position[row, 0], found.velocity[row, 0]),
            (found.error[row], found.velocity_error[row]),
            exactly(of, float(t)),
            strict=True,
        ):
            error = abs(_exact(got) - wanted)
            assert error <= bound
            # The bound is useful: some roundings of the wide type for each radian.
            assert bound < 1e-16 * (1 + abs(wanted)) * (1 + np.sqrt(stiffness) * t)


def _exact(value: np.longdouble) -> Real:
    high = float(value)
    return MP.mpf(high) + MP.mpf(float(value - np.longdouble(high)))


def test_a_spring_with_dry_friction_loses_two_widths_of_its_dead_zone_each_swing() -> None:
    # From 1.0 at rest, with f/k = 0.0625: 0.875 to the other side, 0.75 back, ..., until |q| <= 0.0625.
    of = system(stiffness=4.0, friction=0.25, start=1.0, velocity=0.0)
    swing = np.pi / 2
    found = oscillator.follow(of, swing * np.arange(12))
    expected = [1.0, -0.875, 0.75, -0.625, 0.5, -0.375, 0.25, -0.125, 0.0, 0.0, 0.0, 0.0]
    # The instants are doubles: the coordinate is stationary there.
    assert np.abs(found.position[:, 0] - expected).max() < 1e-18
    rates = oscillator.rates_of(of)
    assert len(oscillator.phases(of, rates, 100.0)) == 9


@pytest.mark.parametrize(
    ("numbers", "rests"),
    [
        ({"friction": 0.3, "velocity": 2.0}, 0.3 + 2.0 / 0.3),
        ({"friction": 0.3, "velocity": 2.0, "force": 0.1}, 0.3 + 2.0 / 0.2),
        ({"friction": 0.3, "velocity": 0.0, "force": 0.3}, 0.3),
        ({"friction": 0.3, "velocity": 0.0, "stiffness": 0.9}, 0.3),
    ],
)
def test_the_exact_stop(numbers: dict[str, float], rests: float) -> None:
    found = oscillator.follow(system(**numbers), np.array([1e3, 1e5]))
    # The expected place is rounded in doubles.
    assert found.position[:, 0].astype(float) == pytest.approx([rests, rests], rel=1e-15)
    assert not found.velocity.any()


def test_energy_pays_for_damping_and_friction() -> None:
    of = system(damping=0.05, stiffness=3.0, friction=0.02, force=0.2, velocity=1.4, inertia=0.7)
    times = np.linspace(0, 60, 120001)
    found = oscillator.follow(of, times)
    q, v = (found.position[:, 0].astype(float), found.velocity[:, 0].astype(float))
    energy = 0.7 / 2 * v * v + 1.5 * q * q - 0.2 * q
    power = 0.05 * v * v + 0.02 * np.abs(v)
    lost = np.concatenate(([0.0], np.cumsum((power[1:] + power[:-1]) / 2) * (times[1] - times[0])))
    # The trapezoidal rule with a step h errs by h^2 / 12 times the change of the derivative of the power, and some h^2 a kink.
    assert np.abs(energy[0] - energy - lost).max() < 1e-6
    assert v[-1] == 0


def test_friction_too_small_for_its_reversals_is_out_of_reach() -> None:
    of = system(stiffness=1e8, friction=1e-9)
    with pytest.raises(OutOfReach, match="changes its sign more than"):
        oscillator.follow(of, np.array([1e4]))


def test_what_a_slider_and_a_hinge_carry() -> None:
    """Gravity along an inclined rail, and bodies that fixed joints make one."""
    rows = ((0.2, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))
    bodies = (JointedBody("a", Tensor(2.0, rows)), JointedBody("b", Tensor(3.0, rows), (0.5, 0.0, 0.0)))
    weld = Joint("weld", "fixed", 0, 1, position=(0.0, 2.0, 0.0))
    rail = Joint("rail", "prismatic", WORLD, 0, axis=(3.0, 0.0, 4.0), armature=1.0, start=(0.0,), start_velocity=(0.0,))
    form = form_of(Mechanism(bodies, (rail, weld), (), 10.0))
    assert form is not None
    slid = form.follow(np.array([2.0]))
    # 5 kg of 6 kg fall along 0.8 of the axis: a = -10 * 0.8 * 5 / 6; one rounding of a double is left by 0.8.
    assert float(slid.position[0, 0]) == pytest.approx(-10 * 0.8 * 5 / 6 * 2, rel=1e-15)
    pin = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 0.0, 2.0), effort=1.0, start=(0.0,), start_velocity=(0.0,))
    form = form_of(Mechanism(bodies, (pin, weld), (), 10.0))
    assert form is not None
    moment = 0.4 + 0.4 + 3 * (0.25 + 4)
    assert float(form.follow(np.array([2.0])).velocity[0, 0]) == pytest.approx(2 / moment, rel=1e-15)


def test_sympy_proves_the_response() -> None:
    """B, C and their derivatives solve the equation, for real and complex rates alike."""
    tau, slow, gap, v0, a = sympy.symbols("tau lambda_1 s v_0 a")
    fast = slow + 2 * gap
    b = sympy.exp(-slow * tau) * (1 - sympy.exp(-2 * gap * tau)) / (2 * gap)
    c = (1 - sympy.exp(-slow * tau) - slow * b) / (slow * fast)
    q = v0 * b + a * c
    equation = sympy.diff(q, tau, 2) + (slow + fast) * sympy.diff(q, tau) + slow * fast * q
    assert sympy.simplify(equation - a) == 0
    assert q.subs(tau, 0) == 0
    assert sympy.simplify(sympy.diff(q, tau).subs(tau, 0) - v0) == 0


def test_random_phases_join() -> None:
    """Across each reversal the coordinate and the velocity are continuous."""
    for damping, stiffness in itertools.product((0.0, 0.1), (0.0, 2.0, 0.5)):
        of = system(damping=damping, stiffness=stiffness, friction=0.05, force=0.3, velocity=-3.0)
        rates = oscillator.rates_of(of)
        for phase in oscillator.phases(of, rates, 50.0)[1:]:
            at = float(phase.time)
            found = oscillator.follow(of, np.array([np.nextafter(at, 0), np.nextafter(at, np.inf)]))
            # The two instants are two roundings of the time apart, and the velocity is zero between them.
            assert abs(found.position[1, 0] - found.position[0, 0]) < 1e-18
            assert np.abs(found.velocity).max() < 1e-13
