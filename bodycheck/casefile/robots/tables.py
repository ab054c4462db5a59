"""Tables of bodies and joints of a case file, from a robot model: the doubles nearest to the exact numbers of the model."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import chain, count
from typing import Any

from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Quaternion4, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, conjugate, multiply

#: The names of the world and the plane, which no body of a case may have.
RESERVED = ("world", "plane")

#: The name of the joint of a base that floats in the case alone.
BASE = "base"

#: The tables `bodies`, `joints` and `loops` of a document.
Tables = dict[str, list[dict[str, Any]]]


@dataclass(frozen=True, eq=False)
class Pose:
    """The pose of a frame in an outer frame: the origin (m), and the unit quaternion (w, x, y, z) to the outer axes."""

    origin: Vector3
    turn: Quaternion4

    def then(self, inner: "Pose") -> "Pose":
        """Return the pose in the outer frame of a frame that has the pose `inner` in this frame."""
        moved = tuple(a + b for a, b in zip(self.origin, turned(self.turn, inner.origin), strict=True))
        return Pose(vector(moved), multiply(self.turn, inner.turn))

    def inverse(self) -> "Pose":
        """Return the pose of the outer frame in this frame."""
        back = conjugate(self.turn)
        x, y, z = turned(back, self.origin)
        return Pose((-x, -y, -z), back)


#: The pose of a frame that is identical to the other frame.
HERE = Pose(vector((0, 0, 0)), IDENTITY)


def turned(turn: Quaternion4, components: Vector3) -> Vector3:
    """Return the components of a vector after the rotation by a unit quaternion."""
    _, x, y, z = multiply(multiply(turn, (MP.mpf(0), *components)), conjugate(turn))
    return x, y, z


def body(name: str, inertia: MassProperties) -> dict[str, Any]:
    """Return the table of a body, given its mass properties in its frame."""
    xx, yy, zz, xy, xz, yz = map(float, inertia.tensor)
    rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return {"name": name, "mass": float(inertia.mass), "center_of_mass": doubles(inertia.centre), "inertia": rows}


def joint(name: str, kind: str, parent: str, child: str, pose: Pose) -> dict[str, Any]:
    """Return the table of a joint with a pose in the frame of its parent."""
    table: dict[str, Any] = {"name": name, "type": kind, "parent": parent, "child": child, "position": doubles(pose.origin)}
    return table if pose.turn == IDENTITY else {**table, "quaternion": doubles(pose.turn)}


def doubles(values: Sequence[Real]) -> list[float]:
    """Return the doubles nearest to the components of a vector, as an array of a document.

    Components that are only rounding errors of its largest component, or of 1, are zero.
    """
    least = NEGLIGIBLE * max(1, *map(abs, values))
    return [float(value) if abs(value) > least else 0.0 for value in values]


def unique(name: str, taken: Collection[str]) -> str:
    """Return a name that is not taken: the name itself, or with a number behind it."""
    return next(each for each in chain([name], (f"{name}-{number}" for number in count(2))) if each not in taken)
