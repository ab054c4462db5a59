"""Mass, centre and inertia tensor of the body in a table of a case file, along the axes of the file."""

from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from tests.judge.numerals import ZERO, Matrix, Vector, exact


@dataclass(frozen=True)
class Inertia:
    """Mass (kg), centre of mass (m) and inertia tensor about it (kg m^2)."""

    mass: Decimal
    centre: Vector
    tensor: Matrix


def inertia_of(table: dict[str, Any]) -> Inertia:
    """Return the inertia that a table of a body states by a shape or by moments."""
    mass = exact(table["mass"])
    centre = exact(table.get("center_of_mass", (0, 0, 0)))
    if "inertia" in table:
        rows = exact(table["inertia"])
        return Inertia(mass, centre, rows if isinstance(rows[0], tuple) else _diagonal(*rows))
    match table["shape"]:
        case "brick":
            squares = [mass * edge * edge / 3 for edge in exact(table["semi_axes"])]
        case "ellipsoid":
            squares = [mass * edge * edge / 5 for edge in exact(table["semi_axes"])]
        case "sphere":
            squares = [mass * exact(table["radius"]) ** 2 / 5] * 3
        case _:
            across = mass * exact(table["radius"]) ** 2 / 4
            squares = [across, across, mass * exact(table["half_length"]) ** 2 / 3]
    x, y, z = squares
    return Inertia(mass, centre, _diagonal(y + z, x + z, x + y))


def _diagonal(x: Decimal, y: Decimal, z: Decimal) -> Matrix:
    return ((x, ZERO, ZERO), (ZERO, y, ZERO), (ZERO, ZERO, z))
