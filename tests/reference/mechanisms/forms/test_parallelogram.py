"""The N-four-bar of the IFToMM benchmark A02: published positions, and its equation from its energies."""

from dataclasses import replace

import numpy as np
import pytest
import sympy

from bodycheck.reference.mechanisms import kinematics, observables
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.forms.choice import form_of
from bodycheck.reference.mechanisms.mechanism import Mechanism
from tests.support.linkages import four_bar, n_four_bar, slider_crank

#: Positions of the point B0 at 10 s (m).
PUBLISHED = {
    2: ("0.328458111540815379", "0.944518538178600962"),
    5: ("0.2357891358452558532", "0.9718042413044653312"),
}


@pytest.mark.parametrize("bars", PUBLISHED)
def test_the_benchmark_a02(bars: int) -> None:
    form = form_of(n_four_bar(bars))
    assert form is not None
    found = form.follow(np.array([10.0]))
    angle = found.position[0, 0]
    published = np.array([np.longdouble(value) for value in PUBLISHED[bars]])
    # The doubles nearest to g = 9.81, 1/12 and pi/2 move the published motion by a few of their roundings over eight turns.
    assert np.abs(np.array([np.cos(angle), np.sin(angle)]) - published).max() < 1e-14
    assert found.error.max() < 1e-14


def test_energy_is_conserved_and_the_loops_stay_closed() -> None:
    mechanism, times = n_four_bar(3), np.linspace(0, 5, 51)
    form = form_of(mechanism)
    assert form is not None
    motion = form.follow(times)
    joints = JointMotion(motion.position.astype(float), motion.velocity.astype(float))
    bodies = kinematics.bodies(mechanism, joints, t=times)
    assert kinematics.gaps(mechanism, bodies).max() < 1e-14
    seen = observables.observe(mechanism, bodies)
    # Some roundings of energies of 100 J.
    assert np.ptp(seen.total_energy) < 1e-11
    assert np.ptp(seen.kinetic_energy) > 10


def _with_rate(mechanism: Mechanism, joint: int, rate: float) -> Mechanism:
    joints = list(mechanism.joints)
    joints[joint] = replace(joints[joint], start_velocity=(rate,))
    return replace(mechanism, joints=tuple(joints))


def test_other_linkages_have_no_form() -> None:
    assert form_of(four_bar()) is None
    assert form_of(slider_crank()) is None
    plain = n_four_bar(1)
    assert form_of(plain) is not None
    assert form_of(_with_rate(plain, 2, 0.5)) is None
    damped = replace(plain, joints=(replace(plain.joints[0], damping=0.1), *plain.joints[1:]))
    assert form_of(damped) is None


def test_sympy_proves_the_energies_of_a02() -> None:
    """T and V of the benchmark, from the places of all bars, for N = 2."""
    t, m, length, g = sympy.symbols("t m L g", positive=True)
    theta = sympy.Function("theta")(t)
    end = length * sympy.Matrix([sympy.cos(theta), sympy.sin(theta)])
    across = m * length**2 / 12
    centres = [(end / 2, across)] * 3 + [(end + sympy.Matrix([length / 2, 0]), 0)] * 2
    kinetic = sum(m * c.diff(t).dot(c.diff(t)) / 2 + own * theta.diff(t) ** 2 / 2 for c, own in centres)
    potential = sum(m * g * c[1] for c, _ in centres)
    bars = 2
    expected = (sympy.Rational(bars + 1, 3) + bars) * m * length**2 * theta.diff(t) ** 2 / 2
    assert sympy.simplify(kinetic - expected) == 0
    assert sympy.simplify(potential - (sympy.Rational(bars + 1, 2) + bars) * m * g * length * sympy.sin(theta)) == 0
