"""Attitude: SciPy's rotations and the chapter's conventions say the same as ours."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bodycheck.reference import kinematics as k

ANGLE = st.floats(-20, 20)
RATE = st.floats(-100, 100)
UNIT = (
    st.lists(st.floats(-1, 1), min_size=4, max_size=4)
    .filter(lambda q: math.hypot(*q) > 0.1)
    .map(lambda q: k.normalise(np.array(q)))
)


def scalar(x: float) -> np.ndarray:
    return np.asarray(x)


@given(ANGLE, ANGLE, ANGLE)
def test_euler_angles_are_scipys_intrinsic_zxz(phi: float, theta: float, psi: float) -> None:
    ours = k.quaternion_from_euler(scalar(phi), scalar(theta), scalar(psi))
    theirs = Rotation.from_euler("ZXZ", [phi, theta, psi]).as_quat(scalar_first=True)
    # Angles of 20 rad carry a rounding error of 4e-15.
    assert k.geodesic_angle(ours, theirs) < 2e-14


@given(UNIT)
def test_angles_of_a_quaternion_give_the_quaternion(q: np.ndarray) -> None:
    # Half of three angles of up to pi, each rounded by up to 4e-16.
    assert k.geodesic_angle(k.quaternion_from_euler(*k.euler_from_quaternion(q)), q) < 2e-15


@pytest.mark.parametrize("psi", [0.0, 0.3, -2.0, 3.0])
@pytest.mark.parametrize("theta", [0.0, math.pi])
def test_at_the_singularity_only_psi_turns(theta: float, psi: float) -> None:
    q = k.quaternion_from_euler(scalar(0.5), scalar(theta), scalar(psi))
    q[[1, 2] if theta == 0 else [0, 3]] = 0.0
    phi, _, _ = k.euler_from_quaternion(q)
    assert phi == 0
    # Half of an angle of up to pi, rounded by up to 4e-16, and the rounding of a quaternion.
    assert k.geodesic_angle(k.quaternion_from_euler(*k.euler_from_quaternion(q)), q) < 2e-15


@given(UNIT, st.lists(RATE, min_size=3, max_size=3))
def test_rotate_agrees_with_scipy(q: np.ndarray, v: list[float]) -> None:
    theirs = Rotation.from_quat(q, scalar_first=True).apply(v)
    # Some ten products each way; the quaternion is of unit length but for its rounding, which the two treat differently.
    np.testing.assert_allclose(k.rotate(q, np.array(v)), theirs, atol=1e-13 * (1 + math.hypot(*v)), rtol=0)


@pytest.mark.parametrize("kind", [np.float64, np.longdouble])
@pytest.mark.parametrize("shape", [(), (1,), (7,), (5, 7)])
def test_products_of_vectors_are_the_same_whichever_are_beside_them(shape: tuple[int, ...], kind: type[np.floating]) -> None:
    random = np.random.default_rng(3)
    a, b = (random.normal(0, 1, (*shape, 3)).astype(kind) / 3 for _ in range(2))
    q = k.normalise(random.normal(0, 1, (*shape, 4)).astype(kind))
    assert k.rotate(q, b).dtype == k.dot(a, b).dtype == kind
    np.testing.assert_array_equal(k.dot(a, b), (a * b).sum(axis=-1))
    for place in np.ndindex(shape):
        np.testing.assert_array_equal(k.rotate(q, b)[place], k.rotate(q[place], b[place]))
        assert k.dot(a, b)[place] == k.dot(a[place], b[place])


@given(UNIT, UNIT)
def test_product_is_composition(p: np.ndarray, q: np.ndarray) -> None:
    theirs = Rotation.from_quat(p, scalar_first=True) * Rotation.from_quat(q, scalar_first=True)
    # Four products a component, each rounded by up to 1e-16, twice as an angle.
    assert k.geodesic_angle(k.multiply(p, q), theirs.as_quat(scalar_first=True)) < 3e-15


@given(ANGLE, st.floats(0.1, 3.0), ANGLE, RATE, RATE, RATE)
def test_body_rates_are_those_of_the_moving_axes(
    phi: float, theta: float, psi: float, dphi: float, dtheta: float, dpsi: float
) -> None:
    """[G 2.41]: the components of the angular velocity are K.J', I.K', J.I', here by central differences."""
    h = 1e-6 / (1 + abs(dphi) + abs(dtheta) + abs(dpsi))

    def axes(t: float) -> np.ndarray:
        return Rotation.from_euler("ZXZ", [phi + dphi * t, theta + dtheta * t, psi + dpsi * t]).as_matrix()

    (i, j, kk), (di, dj, dk) = axes(0.0).T, (axes(h) - axes(-h)).T / (2 * h)
    expected = [kk @ dj, i @ dk, j @ di]
    ours = k.body_rates(scalar(theta), scalar(psi), scalar(dphi), scalar(dtheta), scalar(dpsi))
    # The difference quotient loses 1e-16 / h, and is wrong by the square of the turn in h.
    np.testing.assert_allclose(ours, expected, atol=1e-8 * (1 + abs(dphi) + abs(dtheta) + abs(dpsi)), rtol=0)


@given(ANGLE, st.floats(0.1, 3.0), ANGLE, RATE, RATE, RATE)
def test_rates_of_rates(phi: float, theta: float, psi: float, dphi: float, dtheta: float, dpsi: float) -> None:
    body = k.body_rates(scalar(theta), scalar(psi), scalar(dphi), scalar(dtheta), scalar(dpsi))
    back = k.euler_rates(scalar(theta), scalar(psi), body)
    # 1 / sin(theta) is at most 10 here.
    np.testing.assert_allclose(back, [dphi, dtheta, dpsi], atol=1e-12, rtol=1e-12)


@given(UNIT, st.floats(1e-12, math.pi))
def test_geodesic_angle_is_exact_for_small_and_large_turns(q: np.ndarray, angle: float) -> None:
    turn = np.array([math.cos(angle / 2), 0.0, math.sin(angle / 2), 0.0])
    # Some roundings of quaternions, 1e-16 each, which no turn is too small for.
    assert k.geodesic_angle(q, k.multiply(q, turn)) == pytest.approx(angle, rel=1e-12, abs=1e-15)
    assert k.geodesic_angle(q, -q) < 1e-15


def test_wide_types_stay_wide() -> None:
    q = k.quaternion_from_euler(*(np.asarray(np.longdouble(x)) for x in (0.1, 0.2, 0.3)))
    assert q.dtype == np.longdouble
    assert k.euler_from_quaternion(q)[0].dtype == np.longdouble
