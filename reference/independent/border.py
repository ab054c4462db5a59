"""The start of a motion with a hundred digits: inertia tensor, direction cosines, angular velocity."""

import functools
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from bodycheck.reference.independent.inertia import Rows, along_axes, inverse, mass_and_tensor, over_common_denominator
from bodycheck.reference.scene import (
    AlongPlane,
    Attitude,
    Body,
    Definition,
    EulerAngles,
    EulerRates,
    Given,
    Scene,
    Valid,
    valid,
)

#: Decimal digits of the arithmetic.
DIGITS = 100

#: The arithmetic, in a separate context of mpmath.
MP = mpmath.MPContext()
MP.dps = DIGITS

#: A number of this arithmetic.
Number = Any

ZERO, ONE = MP.mpf(0), MP.mpf(1)

#: Three numbers, and a matrix by its rows.
Triple = list[Number]
Matrix = list[Triple]


@dataclass(frozen=True, eq=False)
class Border:
    """A body and the start of its motion, in numbers of `MP`. All components are along the axes of the body or of the world.

    Attributes
    ----------
    mass
        Mass (kg).
    tensor
        Rows of the inertia tensor about the centre of mass, in the frame of the body (kg m^2).
    mobility
        Rows of the inverse of the inertia tensor (1/(kg m^2)).
    cosines
        Rows of the matrix of direction cosines at t = 0, which takes body to world components: its rows are the components of
        the world axes along the body axes.
    rates
        Angular velocity at t = 0, in the frame of the body (rad/s).
    momentum
        Angular momentum about the centre of mass at t = 0, in the frame of the body (kg m^2/s).
    """

    mass: Number
    tensor: Matrix
    mobility: Matrix
    cosines: Matrix
    rates: Triple
    momentum: Triple


def border(scene: Scene) -> Border:
    """Return the start of the motion of a scene.

    The numbers come from the parts of the scene's definition that are valid (see `scene.valid`), and otherwise from the doubles
    of the scene.
    """
    return _border(scene, valid(scene))


@functools.lru_cache(maxsize=64)
def _border(scene: Scene, holds: Valid) -> Border:
    definition, initial = scene.definition, scene.initial
    mass, tensor, mobility = _of_file(definition) if definition and holds.inertia else _of_doubles(scene.body)
    orientation = definition.attitude if definition and holds.attitude else initial.quaternion
    rotation = definition.rotation if definition and holds.rotation else initial.angular_velocity
    if isinstance(rotation, EulerRates):
        assert definition is not None
        rates = euler_velocity(definition.attitude, rotation)
    else:
        rates = [MP.mpf(rate) for rate in rotation]
    return Border(mass, tensor, mobility, attitude(orientation), rates, times(tensor, rates))


def made_of(given: Given) -> tuple[Number, Matrix]:
    """The mass (kg) and the inertia tensor (kg m^2) of a body, in its frame, from its data in a file."""
    mass, tensor = mass_and_tensor(Definition(given), _rational_cosines)
    return _number(mass), _numbers(tensor)


def attitude(orientation: Attitude) -> Matrix:
    """The matrix of direction cosines of an attitude, body to world components."""
    if isinstance(orientation, EulerAngles):
        return _product(_product(about_z(orientation.phi), about_x(orientation.theta)), about_z(orientation.psi))
    if isinstance(orientation, AlongPlane):
        return about_y(orientation.incline)
    return [[_number(entry) for entry in row] for row in _of_quaternion(orientation)]


def euler_velocity(orientation: Attitude, rates: EulerRates) -> Triple:
    """The angular velocity in the frame of the body (rad/s) from the rates of the Euler angles of its attitude.

    With R = Rz(phi) Rx(theta) Rz(psi), its components are entries of the skew matrix R^T dR/dt.
    """
    phi, theta, psi = _angles(orientation)
    first, second, third = about_z(phi), about_x(theta), about_z(psi)
    rotation = _product(_product(first, second), third)
    terms = (
        (rates.dphi, _product(_product(_product(first, TURN_Z), second), third)),
        (rates.dtheta, _product(_product(_product(first, second), TURN_X), third)),
        (rates.dpsi, _product(rotation, TURN_Z)),
    )
    derivative = [[sum(MP.mpf(rate) * term[i][j] for rate, term in terms) for j in range(3)] for i in range(3)]
    skew = _product([list(column) for column in zip(*rotation, strict=True)], derivative)
    return [skew[2][1], skew[0][2], skew[1][0]]


def _angles(orientation: Attitude) -> Triple:
    """phi, theta and psi (rad) of an attitude. Where K is vertical, phi is 0 [G p. 45]."""
    if isinstance(orientation, EulerAngles):
        return [MP.mpf(angle) for angle in (orientation.phi, orientation.theta, orientation.psi)]
    r = attitude(orientation)
    if not (r[0][2] or r[1][2]):
        return [MP.mpf(0), MP.acos(r[2][2]), MP.atan2(-r[0][1], r[0][0])]
    return [MP.atan2(r[0][2], -r[1][2]), MP.atan2(MP.hypot(r[0][2], r[1][2]), r[2][2]), MP.atan2(r[2][0], r[2][1])]


def about_z(angle: Number) -> Matrix:
    """The matrix of a turn about z by an angle (rad)."""
    c, s = MP.cos_sin(angle)
    return [[c, -s, ZERO], [s, c, ZERO], [ZERO, ZERO, ONE]]


def about_x(angle: Number) -> Matrix:
    """The matrix of a turn about x by an angle (rad)."""
    c, s = MP.cos_sin(angle)
    return [[ONE, ZERO, ZERO], [ZERO, c, -s], [ZERO, s, c]]


def about_y(angle: Number) -> Matrix:
    """The matrix of a turn about y by an angle (rad)."""
    c, s = MP.cos_sin(angle)
    return [[c, ZERO, s], [ZERO, ONE, ZERO], [-s, ZERO, c]]


#: The derivatives of `about_x` and `about_z` at the angle 0.
TURN_X: Matrix = [[MP.mpf(value) for value in row] for row in ((0, 0, 0), (0, 0, -1), (0, 1, 0))]
TURN_Z: Matrix = [[MP.mpf(value) for value in row] for row in ((0, -1, 0), (1, 0, 0), (0, 0, 0))]


def times(matrix: Matrix, vector: Triple) -> Triple:
    """A matrix times a vector."""
    return [sum(entry * component for entry, component in zip(row, vector, strict=True)) for row in matrix]


@functools.lru_cache(maxsize=64)
def _of_file(definition: Definition) -> tuple[Number, Matrix, Matrix]:
    """Mass, inertia tensor and inverse inertia tensor of the body that a file defines."""
    mass, tensor = mass_and_tensor(definition, _rational_cosines)
    return _number(mass), _numbers(tensor), _numbers(inverse(tensor))


@functools.lru_cache(maxsize=64)
def _of_doubles(body: Body) -> tuple[Number, Matrix, Matrix]:
    """Mass, inertia tensor and inverse inertia tensor of a body with the moments and axes of a scene."""
    tensor = along_axes(body.moments, _of_quaternion(body.axes))
    return MP.mpf(body.mass), _numbers(tensor), _numbers(inverse(tensor))


def _rational_cosines(orientation: Attitude) -> Rows:
    """The matrix of an attitude in rational numbers; from angles it is rounded to the digits of `MP`."""
    if isinstance(orientation, tuple):
        return _of_quaternion(orientation)
    return [[Fraction(*mpmath.libmp.to_rational(entry._mpf_)) for entry in row] for row in attitude(orientation)]


def _of_quaternion(q: tuple[float, float, float, float]) -> Rows:
    """The matrix of a quaternion w, x, y, z of any length: 1 + 2 (w X + X X) / |q|^2 with the skew matrix X of its vector."""
    (w, x, y, z), _ = over_common_denominator(q)
    skew = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    length, square = w * w + x * x + y * y + z * z, _product(skew, skew)
    return [[Fraction((i == j) * length + 2 * (w * skew[i][j] + square[i][j]), length) for j in range(3)] for i in range(3)]


def _product(one: list[list[Any]], other: list[list[Any]]) -> list[list[Any]]:
    """The product of two matrices."""
    return [[sum(one[i][k] * other[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def _numbers(rows: Rows) -> Matrix:
    return [[_number(entry) for entry in row] for row in rows]


def _number(value: Fraction) -> Number:
    """A rational number as a number of `MP`, rounded to its digits."""
    return MP.mpf(value.numerator) / value.denominator
