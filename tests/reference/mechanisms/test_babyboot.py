"""Kane's babyboot at 10 s: published values of four codes, and its two equations as the textbook writes them, in 80 bits."""

from typing import Any

import numpy as np
import pytest

from bodycheck.casefile.case import load
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.truths import Truth

#: qA and qB (degrees), and their rates (rad/s), after 10 s.
PUBLISHED, PUBLISHED_RATES = (-61.312983340691, -929.47789677244), (-6.7440081040646, -2.7795690128833)


@pytest.fixture(scope="module")
def truth() -> Truth:
    mechanism = load("babyboot").scene
    assert isinstance(mechanism, Mechanism)
    return mechanism_truth(mechanism, np.array([0.0, 5.0, 10.0]))


def textbook(number: Any) -> np.ndarray:
    """qA, qB (rad) and their rates at 10 s; number: what makes numbers of the decimals of the published problem."""
    heyoka = pytest.importorskip("heyoka")
    a, b, u, v = heyoka.make_vars("a", "b", "u", "v")
    values = ("5e-6", "0.01", "0.075", "0.1", "0.2", "2.5e-4", "5e-5", "2e-4", "9.81")
    rod, rod_mass, rod_arm, plate_mass, plate_arm, x, y, z, gravity = map(number, values)
    fixed = rod + rod_mass * rod_arm**2 + plate_mass * plate_arm**2
    weight = (rod_mass * rod_arm + plate_mass * plate_arm) * gravity
    sine, cosine = heyoka.sin(b), heyoka.cos(b)
    swing = (-weight * heyoka.sin(a) - Wide(2) * (y - x) * sine * cosine * u * v) / (fixed + x * cosine**2 + y * sine**2)
    system = [(a, u), (b, v), (u, swing), (v, (y - x) / z * sine * cosine * u * u)]
    pi = 4 * np.arctan(Wide(1))
    start = [number(pi / 2), number(pi / 180), Wide(0), Wide(0)]
    solver = heyoka.taylor_adaptive(system, start, fp_type=Wide)
    solver.propagate_until(Wide(10))
    return np.array(solver.state)


def test_the_equations_of_the_textbook_are_within_the_bound(truth: Truth) -> None:
    assert truth.joints is not None
    state = textbook(lambda value: Wide(float(value)))
    bound = float(truth.bounds.error[-1])
    # Both round in 80 bits, which the motion magnifies a hundred million times: the bound of the truth is for one of them.
    assert np.abs(truth.joints.position[-1] - state[:2]).max() < 2 * bound
    assert bound < 1e-9


def test_the_published_values_have_seven_digits_and_more(truth: Truth) -> None:
    """The published angles are wrong in their ninth digit, and the rates in their eighth."""
    assert truth.joints is not None
    angles, rates = np.degrees(truth.joints.position[-1]), truth.joints.velocity[-1]
    off = [*np.abs(angles / PUBLISHED - 1), *np.abs(rates / PUBLISHED_RATES - 1)]
    assert np.all(np.array(off) < (5e-9, 5e-9, 1e-8, 5e-7))
    # It is not the rounding of the decimals of the problem to doubles, which moves the motion much less.
    exact, narrow = textbook(Wide), textbook(lambda value: Wide(float(value)))
    moved = np.abs(exact[:2] - narrow[:2]).max()
    assert moved < np.abs(np.radians(np.array(PUBLISHED)) - exact[:2]).max() / 100
