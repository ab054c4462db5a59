"""Matrices and their angles: SciPy, the chapter's written-out forms and round trips agree."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bodycheck.reference.chapter import orientation
from bodycheck.reference.kinematics import quaternion_from_euler, rotate
from tests.support.rotations import ANGLE, FULL_TURN, UNIT, apart

#: rad from the singularity; nearer to it the angles are worse by 1/sin than the matrix, whatever the method.
AWAY = 0.3
ZXZ = orientation.zxz, orientation.zxz_angles
AERONAUTICAL = orientation.aeronautical, orientation.aeronautical_angles
CONVENTIONS = pytest.mark.parametrize("there_and_back", [ZXZ, AERONAUTICAL], ids=["zxz", "aeronautical"])

ThereAndBack = tuple[Callable[..., np.ndarray], Callable[[np.ndarray], tuple[np.ndarray, ...]]]


def turn(difference: float) -> float:
    """An angle's size without whole turns: pi and -pi are one direction."""
    return abs(math.remainder(difference, math.tau))


@given(ANGLE)
def test_elementary_matrices_are_the_turns_of_scipy_seen_from_the_body(angle: float) -> None:
    for letter, matrix in orientation.ELEMENTARY_ROTATIONS.items():
        expected = Rotation.from_euler(letter, angle).as_matrix().T
        # The rounding of an angle of 20 rad.
        assert apart(matrix(np.asarray(angle)), expected) < 5e-15


@given(ANGLE, ANGLE, ANGLE)
def test_zxz_matrix_is_scipys_and_the_written_out_one(phi: float, theta: float, psi: float) -> None:
    a1 = orientation.zxz(*map(np.asarray, (phi, theta, psi)))
    # SciPy forms half the angles, each of up to 20 rad and rounded by up to 4e-15, in quaternions.
    assert apart(a1, Rotation.from_euler("ZXZ", [phi, theta, psi]).as_matrix()) < 2e-14
    (cf, ct, cp), (sf, st_, sp) = np.cos([phi, theta, psi]), np.sin([phi, theta, psi])
    written_out = [
        [cf * cp - sf * ct * sp, -cf * sp - sf * ct * cp, sf * st_],
        [sf * cp + cf * ct * sp, -sf * sp + cf * ct * cp, -cf * st_],
        [st_ * sp, st_ * cp, ct],
    ]
    # Sums of two products of three sines and cosines: some roundings of numbers of at most 1.
    assert apart(a1, written_out) < 1e-15
    assert apart(a1.T, orientation.inertial_to_body("zxz", *map(np.asarray, (phi, theta, psi)))) == 0


@given(ANGLE, ANGLE, ANGLE)
def test_zxz_matrix_is_the_rotation_of_its_quaternion(phi: float, theta: float, psi: float) -> None:
    angles = [np.asarray(angle) for angle in (phi, theta, psi)]
    turned = rotate(quaternion_from_euler(*angles), np.eye(3))
    # The quaternion has sums and differences of half the angles, of up to 20 rad and rounded by up to 4e-15 each.
    assert apart(orientation.zxz(*angles).T, turned) < 2e-14


@given(ANGLE, ANGLE, ANGLE)
def test_aeronautical_matrix_is_scipys(yaw: float, pitch: float, roll: float) -> None:
    a1 = orientation.aeronautical(*map(np.asarray, (yaw, pitch, roll)))
    # SciPy forms half the angles, each of up to 20 rad and rounded by up to 4e-15, in quaternions.
    assert apart(a1, Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()) < 2e-14


@given(st.lists(st.tuples(st.sampled_from("xyz"), ANGLE), max_size=7))
def test_a_chain_is_the_product_of_its_turns(turns: list[tuple[str, float]]) -> None:
    expected = Rotation.identity()
    for letter, angle in turns:
        expected *= Rotation.from_euler(letter.upper(), angle)
    a1 = orientation.body_to_inertial("".join(letter for letter, _ in turns), *(np.asarray(angle) for _, angle in turns))
    # Seven turns, each rounded by 2e-15.
    assert apart(a1, expected.as_matrix()) < 3e-14


def test_the_inverse_chain_has_the_signs_and_the_order_reversed() -> None:
    angles = [np.asarray(angle) for angle in (0.1, -0.7, 1.3, 2.9)]
    back = orientation.inertial_to_body("zyxz", *(-angle for angle in reversed(angles)))
    # The same sines and cosines, multiplied in the other order: some roundings of numbers of at most 1.
    assert apart(orientation.body_to_inertial("zxyz", *angles), back) < 1e-15


def test_axes_are_moved_turn_by_turn() -> None:
    """The angles of Figs. 2.8-2.10 by the vectors of Tables 2.1 and 2.2, and of Figs. 2.3-2.6 the last."""
    phi, theta, psi = map(np.asarray, (math.pi / 5, math.pi / 3, math.pi / 4))
    first = orientation.body_to_inertial("z", phi)
    second = orientation.body_to_inertial("zx", phi, theta)
    third = orientation.body_to_inertial("zxz", phi, theta, psi)
    (i0, j0, k0), (i1, j1, k1), (i2, j2, k2), (i3, j3, k3) = np.eye(3), first.T, second.T, third.T
    c, s = np.cos(phi), np.sin(phi)
    assert apart([i1, j1, k1], [c * i0 + s * j0, -s * i0 + c * j0, k0]) < 1e-16
    c, s = np.cos(theta), np.sin(theta)
    assert apart([i2, j2, k2], [i1, c * j1 + s * k1, -s * j1 + c * k1]) < 2e-16
    c, s = np.cos(psi), np.sin(psi)
    assert apart([i3, j3, k3], [c * i2 + s * j2, -s * i2 + c * j2, k2]) < 2e-16
    k_in_body = np.array([np.sin(theta) * np.sin(psi), np.sin(theta) * np.cos(psi), np.cos(theta)])
    assert apart(third.T @ k0, k_in_body) < 2e-16
    last = orientation.zxz(*map(np.asarray, (math.pi / 3, math.pi / 4, math.pi / 6)))
    assert apart(last[:, 2], [math.sqrt(6) / 4, -math.sqrt(2) / 4, math.sqrt(2) / 2]) < 2e-16


@pytest.mark.parametrize(("axes", "count"), [("zxz", 2), ("zx", 3), ("zwz", 3), ("ZXZ", 3)])
def test_a_chain_that_makes_no_sense_is_refused(axes: str, count: int) -> None:
    with pytest.raises(ValueError, match="letter x, y or z for each angle"):
        orientation.inertial_to_body(axes, *[np.asarray(0.1)] * count)


@CONVENTIONS
@given(first=FULL_TURN, middle=st.floats(AWAY, math.pi - AWAY), last=FULL_TURN)
def test_angles_to_matrix_to_angles(there_and_back: ThereAndBack, first: float, middle: float, last: float) -> None:
    matrix, angles = there_and_back
    given_angles = first, middle - (0 if there_and_back is ZXZ else math.pi / 2), last
    found = angles(matrix(*map(np.asarray, given_angles)))
    # Some roundings of angles of up to pi, 4e-16 each, divided by the sine of `AWAY`, 0.3.
    assert max(turn(float(x) - y) for x, y in zip(found, given_angles, strict=True)) < 1e-14


@CONVENTIONS
@given(first=ANGLE, size=st.floats(0, 1), exponent=st.integers(-20, 0), side=st.integers(0, 3), last=ANGLE)
def test_matrix_to_angles_to_matrix_at_and_near_the_singularity(
    there_and_back: ThereAndBack, first: float, size: float, exponent: int, side: int, last: float
) -> None:
    """However ill-determined the angles, the orientation that they give is the one that was asked for."""
    matrix, angles = there_and_back
    asked = matrix(*map(np.asarray, (first, side * math.pi / 2 + size * 10.0**exponent, last)))
    assert apart(matrix(*angles(asked)), asked) < 5e-15


@given(UNIT, FULL_TURN)
def test_any_rotation_has_angles(axis: np.ndarray, angle: float) -> None:
    asked = Rotation.from_rotvec(angle * axis).as_matrix()
    for matrix, angles in (ZXZ, AERONAUTICAL):
        # Three angles of up to pi, rounded by up to 4e-16 each, and the matrix made of them twice.
        assert apart(matrix(*angles(asked)), asked) < 5e-15


@given(FULL_TURN, FULL_TURN)
def test_at_the_singularity_the_first_angle_is_zero_and_the_last_turns(first: float, last: float) -> None:
    start, end = np.asarray(first), np.asarray(last)
    for theta, total in ((0.0, first + last), (math.pi, last - first)):
        phi, found, psi = orientation.zxz_angles(orientation.zxz(start, np.asarray(theta), end))
        assert (float(phi), float(found)) == (0.0, theta)
        # Sums of two angles of up to pi, which the matrix has as products of sines and cosines: some roundings of 2 pi, 9e-16.
        assert turn(float(psi) - total) < 3e-15
    for pitch, total in ((math.pi / 2, last - first), (-math.pi / 2, first + last)):
        yaw, found, roll = orientation.aeronautical_angles(orientation.aeronautical(start, np.asarray(pitch), end))
        assert (float(yaw), float(found)) == (0.0, pitch)
        assert turn(float(roll) - total) < 3e-15


def test_arrays_of_angles_give_arrays_of_matrices() -> None:
    phi, theta, psi = np.linspace(0, 1, 12).reshape(4, 3), np.linspace(0.1, 1, 3), np.asarray(0.4)
    matrices = orientation.zxz(phi, theta, psi)
    assert matrices.shape == (4, 3, 3, 3)
    assert apart(matrices[2, 1], orientation.zxz(phi[2, 1], theta[1], psi)) == 0
    found = orientation.zxz_angles(matrices)
    # The smallest theta is 0.1, whose sine makes ten of a rounding.
    assert apart(found[0], phi) < 1e-14
    axis, angle = orientation.axis_and_angle(matrices)
    assert (axis.shape, angle.shape) == ((4, 3, 3), (4, 3))
    assert apart(axis[2, 1], orientation.axis_and_angle(matrices[2, 1])[0]) == 0


def test_wide_types_stay_wide() -> None:
    angles = [np.asarray(np.longdouble(x)) for x in (0.1, 0.2, 0.3)]
    matrix = orientation.zxz(*angles)
    assert matrix.dtype == np.longdouble
    assert (
        max(abs(x - y) for x, y in zip(orientation.zxz_angles(matrix), angles, strict=True)) < 20 * np.finfo(np.longdouble).eps
    )


@pytest.mark.parametrize(
    "matrix",
    [np.diag([1.0, 1.0, -1.0]), 2 * np.eye(3), np.zeros((3, 3)), np.full((3, 3), np.nan), np.eye(4), np.ones((3, 3))],
    ids=["reflection", "scaled", "zero", "not a number", "4 x 4", "ones"],
)
def test_what_is_no_rotation_has_no_angles(matrix: np.ndarray) -> None:
    for function in (orientation.zxz_angles, orientation.aeronautical_angles, orientation.axis_and_angle):
        with pytest.raises(ValueError, match="rotation matrices"):
            function(matrix)


def test_single_rotation_of_figure_2_17() -> None:
    axis, angle = orientation.axis_and_angle(orientation.zxz(*map(np.asarray, (math.pi / 4, math.pi / 4, math.pi / 2))))
    # Printed as 0.770 pi; exactly, cos(Omega / 2) = cos(theta / 2) cos((phi + psi) / 2).
    assert round(float(angle) / math.pi, 3) == 0.770
    assert float(angle) == pytest.approx(2 * math.acos(math.sqrt(2) / 4), rel=1e-15, abs=0)
    phi, theta, psi = math.pi / 4, math.pi / 4, math.pi / 2
    eigenvector = [
        math.cos((phi - psi) / 2) / math.sin((phi + psi) / 2) * math.tan(theta / 2),
        math.sin(phi - psi) * math.tan(theta / 2) / (math.sin(phi) + math.sin(psi)),
        1.0,
    ]
    assert apart(axis / axis[2], eigenvector) < 1e-15


@given(UNIT, st.floats(1e-3, math.pi - 1e-3))
def test_single_rotation_is_that_of_the_eigenvector_and_the_trace(axis: np.ndarray, angle: float) -> None:
    matrix = Rotation.from_rotvec(angle * axis).as_matrix()
    found, total = orientation.axis_and_angle(matrix)
    assert apart(matrix @ found, found) < 1e-15
    # The arccos of the trace loses by 1 / sin(Omega), up to 1000 here.
    assert float(total) == pytest.approx(math.acos((np.trace(matrix) - 1) / 2), abs=1e-12)
    assert apart(found, axis) < 1e-12


@given(UNIT, st.floats(-290, 0))
def test_single_rotation_is_accurate_near_zero(axis: np.ndarray, logarithm: float) -> None:
    angle = 10.0**logarithm
    found, total = orientation.axis_and_angle(Rotation.from_rotvec(angle * axis).as_matrix())
    # Relative: some roundings each way, however small the angle.
    assert float(total) == pytest.approx(angle, rel=2e-15, abs=0)
    assert apart(found, axis) < 2e-15


@given(UNIT, st.floats(-15, -1))
def test_single_rotation_is_accurate_near_a_half_turn(axis: np.ndarray, logarithm: float) -> None:
    angle = math.pi - 10.0**logarithm
    found, total = orientation.axis_and_angle(Rotation.from_rotvec(angle * axis).as_matrix())
    # Some roundings of pi, 4e-16 each, and of the components of a unit vector.
    assert abs(float(total) - angle) < 2e-15
    assert apart(found, axis if float(found @ axis) > 0 else -axis) < 2e-15
    if angle < math.pi - 1e-14:
        assert found @ axis > 0


def test_single_rotation_where_the_axis_is_a_matter_of_choice() -> None:
    """Without rotation it is K; of a half turn the one whose last component other than 0 is positive."""
    axis, angle = orientation.axis_and_angle(np.eye(3))
    assert (axis.tolist(), float(angle)) == ([0.0, 0.0, 1.0], 0.0)
    for sign in (1, -1):
        for expected in ([0.6, -0.8, 0.0], [-1.0, 0.0, 0.0], [-2 / 3, -2 / 3, 1 / 3]):
            chosen = np.array(expected) if np.array(expected)[np.flatnonzero(expected)[-1]] > 0 else -np.array(expected)
            half_turn = Rotation.from_rotvec(sign * math.pi * np.array(expected)).as_matrix()
            axis, angle = orientation.axis_and_angle(half_turn)
            assert apart(axis, chosen) < 1e-15
            assert float(angle) == pytest.approx(math.pi, rel=1e-15, abs=0)
