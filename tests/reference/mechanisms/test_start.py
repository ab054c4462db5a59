"""The start of mechanisms: frames and velocities of bodies, and the inertia of coordinates."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.casefile.case import parse
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.start import coordinates, frames
from tests.support.mechanism_texts import ALL_JOINTS, CART_POLE


def mechanism(text: str) -> Mechanism:
    scene = parse(text, "f").scene
    assert isinstance(scene, Mechanism)
    return scene


def test_the_mass_matrix_by_its_pivots() -> None:
    """The product of the pivots is the determinant of the mass matrix of cart and pole, as a textbook has it."""
    rail, pin = coordinates(mechanism(CART_POLE))
    m, length, about = 0.4, 0.35, 0.017 + 0.4 * 0.35**2
    determinant = (2.3 + m) * about - (m * length * math.cos(0.3)) ** 2
    assert float(rail.loose * pin.loose) == pytest.approx(determinant, rel=1e-14)  # a few roundings of doubles here


def test_frames_at_the_start() -> None:
    """A slide and a hinge by hand: the pole leans by 0.3 about y on a cart that moves with 0.5 m/s."""
    pole = frames(mechanism(CART_POLE))[1]
    end = np.array([0.0, 0.0, 1.0], dtype=np.longdouble)
    np.testing.assert_allclose(pole.point(end).astype(float), [math.sin(0.3), 0.0, 0.1 + math.cos(0.3)], rtol=1e-15)
    np.testing.assert_allclose(pole.speed(end).astype(float), [0.5, 0.0, 0.0], rtol=1e-15)


@pytest.mark.parametrize("joint", ["universal", "sheet", "hinge"])
def test_velocities_are_the_rates_of_places(joint: str) -> None:
    """Of joints whose velocities are the rates of their coordinates, by central differences."""
    made = mechanism(ALL_JOINTS)
    place = next(at for at, each in enumerate(made.joints) if each.name == joint)
    step, body = np.longdouble(1e-6), made.joints[place].child
    start = [np.longdouble(value) for value in made.joints[place].start]
    # Only this joint moves, so that the body is carried by nothing else.
    still = [replace(each, start_velocity=(0.0,) * len(each.start_velocity)) for each in made.joints]
    rates = tuple(0.3 * (index + 1) for index in range(len(start)))

    def at(time: np.longdouble) -> Mechanism:
        moved = tuple(float(value + rate * time) for value, rate in zip(start, rates, strict=True))
        joints = [
            replace(each, start=moved, start_velocity=rates) if index == place else each for index, each in enumerate(still)
        ]
        return replace(made, joints=tuple(joints))

    point = np.array([0.3, -0.2, 0.5], dtype=np.longdouble)
    before, after = (frames(at(time))[body].point(point) for time in (-step, step))
    # The coordinates are doubles, of size 1 here: 1e-16 over a step of 1e-6, and the square of the step.
    rate, speed = (after - before) / (2 * step), frames(at(0 * step))[body].speed(point)
    np.testing.assert_allclose(rate.astype(float), speed.astype(float), atol=3e-10)
