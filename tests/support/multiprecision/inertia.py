"""Mass and inertia of the body in a case file, from the second moments S = sum of m r r^T about its centre of mass.

With second moments, a solid that is turned is R S R^T, bodies that are joined are added, and the inertia tensor is
tr(S) 1 - S [G 2.29].
"""

from collections.abc import Mapping, Sequence
from typing import Any

from tests.support.multiprecision.arithmetic import MP, Matrix, Real, real, vector
from tests.support.multiprecision.attitudes import from_euler_zxz, from_quaternion

Table = Mapping[str, Any]


def mass_and_inertia(body: Table) -> tuple[Real, Matrix]:
    """The mass (kg) and the inertia tensor (3, 3) about the centre of mass, kg m^2, along the axes of the file's body frame.

    body: the table [body] of a case file.
    """
    if "particles" in body or "parts" in body:
        return _joined(body.get("particles") or body["parts"])
    mass = real(body["mass"])
    if "inertia" not in body:
        return mass, _inertia(_second_moments(body, mass))
    if isinstance(body["inertia"][0], Sequence):
        tensor = MP.matrix([[real(element) for element in row] for row in body["inertia"]])
        return mass, (tensor + tensor.T) / 2
    return mass, MP.diag([real(moment) for moment in body["inertia"]])


def _joined(parts: Sequence[Table]) -> tuple[Real, Matrix]:
    """Mass and inertia of particles, which have no shape, or of solids."""
    masses = [real(part["mass"]) for part in parts]
    places = [vector(map(real, part.get("position", (0.0, 0.0, 0.0)))) for part in parts]
    mass = MP.fsum(masses)
    centre = sum((place * each for each, place in zip(masses, places, strict=True)), MP.zeros(3, 1)) / mass
    total = MP.zeros(3)
    for part, each, place in zip(parts, masses, places, strict=True):
        off = place - centre
        total += off * off.T * each
        if "shape" in part:
            turn = _attitude(part)
            total += turn * _second_moments(part, each) * turn.T
    return mass, _inertia(total)


def _attitude(part: Table) -> Matrix:
    if "quaternion" in part:
        return from_quaternion([real(each) for each in part["quaternion"]])
    return from_euler_zxz([real(angle) for angle in part.get("euler_zxz", (0.0, 0.0, 0.0))])


def _second_moments(solid: Table, mass: Real) -> Matrix:
    """The integrals of x^2, y^2 and z^2 over a homogeneous solid, times its density (kg m^2), as a diagonal matrix."""
    match solid["shape"]:
        case "brick":
            squares = [real(half) ** 2 / 3 for half in solid["semi_axes"]]
        case "ellipsoid":
            squares = [real(half) ** 2 / 5 for half in solid["semi_axes"]]
        case "cylinder":
            squares = [real(solid["radius"]) ** 2 / 4] * 2 + [real(solid["half_length"]) ** 2 / 3]
        case "sphere":
            squares = [real(solid["radius"]) ** 2 / 5] * 3
        case other:
            raise ValueError(f"a solid of the shape {other!r} has no inertia of its own")
    return MP.diag([mass * square for square in squares])


def _inertia(second: Matrix) -> Matrix:
    return MP.eye(3) * (second[0, 0] + second[1, 1] + second[2, 2]) - second
