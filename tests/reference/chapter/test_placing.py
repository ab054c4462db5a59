"""Axes placed along given directions: the chapter's chains and figures, and a wheel on its track."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.reference.chapter import orientation, placing
from tests.support.rotations import ANGLE, FULL_TURN, UNIT, apart

CHAINS: dict[placing.Axis, Callable[[float, float, float], tuple[str, tuple[float, ...]]]] = {
    "I": lambda alpha, beta, turn: ("zxzx", (alpha, -math.pi / 2, beta - math.pi / 2, turn)),
    "J": lambda alpha, beta, turn: ("zxzy", (alpha, math.pi / 2, -beta, turn)),
    "K": lambda alpha, beta, turn: ("zxz", (alpha + math.pi / 2, beta, turn)),
}


def direction(alpha: float, beta: float) -> np.ndarray:
    return placing.direction(np.asarray(alpha), np.asarray(beta))


@pytest.mark.parametrize("axis", CHAINS)
@given(alpha=ANGLE, beta=ANGLE, turn=ANGLE)
def test_placed_axes_are_the_chapters_chains(axis: placing.Axis, alpha: float, beta: float, turn: float) -> None:
    placed = placing.place(axis, *map(np.asarray, (alpha, beta, turn)))
    letters, angles = CHAINS[axis](alpha, beta, turn)
    # Sums of angles such as beta - pi/2 are rounded by up to 2e-15.
    assert apart(placed, orientation.body_to_inertial(letters, *map(np.asarray, angles))) < 1e-14
    assert apart(placed[:, "IJK".index(axis)], direction(alpha, beta)) < 1e-16


@pytest.mark.parametrize(("axis", "turn"), [("I", math.pi / 4), ("J", math.pi / 2), ("K", math.pi)])
def test_placed_axes_of_figures_2_13_to_2_15(axis: placing.Axis, turn: float) -> None:
    alpha, beta = np.asarray(3 * math.pi / 4), np.asarray(math.pi / 3)
    placed = placing.place(axis, alpha, beta, np.asarray(turn))
    # Components below 1, formed in another order: one rounding, at most 1.1e-16.
    assert apart(placed[:, "IJK".index(axis)], [-math.sqrt(6) / 4, math.sqrt(6) / 4, 0.5]) < 2e-16
    other = {
        "I": ("J", [-0.75, -0.25, -math.sqrt(6) / 4]),
        "J": ("I", [-(0.5**0.5), -(0.5**0.5), 0]),
        "K": ("I", [0.5**0.5] * 2 + [0]),
    }
    name, expected = other[axis]
    assert apart(placed[:, "IJK".index(name)], expected) < 2e-16


@given(UNIT, st.floats(-150, 150), FULL_TURN)
def test_an_axis_is_placed_along_any_vector(unit: np.ndarray, logarithm: float, turn: float) -> None:
    for axis in CHAINS:
        placed = placing.place_along(axis, 10.0**logarithm * unit, np.asarray(turn))
        # Columns of sines and cosines that are quotients of lengths: some roundings of numbers of at most 1.
        assert apart(placed[:, "IJK".index(axis)], unit) < 1e-15
        assert apart(placed.T @ placed, np.eye(3)) < 1e-15
        # NumPy factorises the matrix: some tens of roundings.
        assert np.linalg.det(placed) == pytest.approx(1, abs=1e-14)


def test_direction_of_figure_2_12() -> None:
    alpha, beta = placing.longitude_and_colatitude(np.array([2.0, 1.5, -3.0]))
    assert (round(float(alpha), 4), round(float(beta), 4)) == (0.6435, 2.4469)
    # One rounding of components below 1.
    assert apart(direction(float(alpha), float(beta)), np.array([2.0, 1.5, -3.0]) / math.sqrt(15.25)) < 2e-16


def test_vertical_vectors_have_longitude_zero() -> None:
    alpha, beta = placing.longitude_and_colatitude(np.array([[0.0, 0.0, 2.0], [-0.0, 0.0, -3.0]]))
    assert (alpha.tolist(), beta.tolist()) == ([0.0, 0.0], [0.0, math.pi])
    placed = placing.place_along("K", np.array([0.0, 0.0, 1.0]), np.asarray(0.0))
    assert placed[:, 2].tolist() == [0.0, 0.0, 1.0]


@pytest.mark.parametrize("vector", [[0.0, 0.0, 0.0], [math.inf, 0.0, 1.0], [math.nan, 0.0, 1.0]])
def test_a_vector_without_direction_is_refused(vector: list[float]) -> None:
    with pytest.raises(ValueError, match="direction"):
        placing.longitude_and_colatitude(np.array(vector))


def test_placing_broadcasts() -> None:
    placed = placing.place("I", np.zeros((2, 1)), np.linspace(0, 1, 5), np.asarray(0.2))
    assert placed.shape == (2, 5, 3, 3)


@given(ANGLE, ANGLE)
def test_axes_of_a_wheel_are_the_body_axes_before_the_spin(phi: float, theta: float) -> None:
    f, t = np.asarray(phi), np.asarray(theta)
    along, up = placing.wheel_axes(f, t)
    axes = orientation.zxz(f, t, np.asarray(0.0))
    # The same products of the same sines and cosines: less than one rounding of numbers of at most 1.
    assert apart(along, axes[:, 0]) < 1e-16
    assert apart(up, axes[:, 1]) < 1e-16


def test_a_wheel_rolls_backwards_along_its_track() -> None:
    """At Fig. 2.16's angles: the velocity of the hub, K dpsi x J*, is along -I*, and J* points up from the ground."""
    f, t = np.asarray(3.9081), np.asarray(1.2472)
    along, up = placing.wheel_axes(f, t)
    axle = orientation.zxz(f, t, np.asarray(0.0))[:, 2]
    assert apart(np.cross(axle, up), -along) < 2e-16
    assert up[2] > 0
    wheels = placing.wheel_axes(np.linspace(0, 1, 4), np.asarray(1.2))
    assert [axes.shape for axes in wheels] == [(4, 3), (4, 3)]
