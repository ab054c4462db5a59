"""A block that lies flat: the face on which it lies, and the extent of this face."""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.problem import NONE, ContactBody
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector2, Vector3, real
from bodycheck.reference.exact.rotations import matrix, turned
from bodycheck.reference.scene import Brick, Cylinder
from bodycheck.reference.witness import WideArray

#: The distance, as a fraction of a half-length, by which a load may be outside a face because of rounding to the wide type.
_ROUNDING = 16 * MP.mpf(float(np.finfo(np.longdouble).eps))


@dataclass(frozen=True)
class Face:
    """The face of a block on a plane, about the foot of its centre of mass.

    Attributes
    ----------
    height
        Height (m) of the centre of mass.
    edges
        For a brick, the two unit vectors along the edges, each with the half-length (m) along it.
    radius
        For a cylinder that stands, the radius of the disk (m).
    """

    height: Real
    edges: tuple[tuple[Vector2, Real], ...] = ()
    radius: Real = MP.inf

    def bears(self, x: Real, y: Real) -> bool:
        """Return whether a point of the plane (m), from the foot of the centre of mass, is in the face or on its border."""
        more = 1 + _ROUNDING
        held = all(abs(x * a + y * b) <= half * more for (a, b), half in self.edges)
        return held and bool(MP.hypot(x, y) <= self.radius * more)

    def leaves(self, reach: Real, begin: Real, end: Real) -> Real | None:
        """The first direction (rad) in which a point at a distance from the foot is at the border of the face and leaves it.

        Returns None if there is no such direction.

        Parameters
        ----------
        reach
            The distance (m).
        begin, end
            The directions (rad, from x) between which the point turns. In the first direction it is in the face.
        """
        sense = 1 if end > begin else -1
        angles_ahead = []
        for (a, b), half in self.edges:
            if reach > half * (1 + _ROUNDING):
                border, at = MP.acos(half / reach), MP.atan2(b, a)
                for way in (at - border, at + border, at + MP.pi - border, at + MP.pi + border):
                    ahead = (sense * (way - begin)) % (2 * MP.pi)
                    if ahead <= abs(end - begin):
                        angles_ahead.append(ahead)
        return begin + sense * min(angles_ahead) if angles_ahead else None


def face_of(body: ContactBody) -> Face | None:
    """The face on which a body lies, or None for a body that does not lie flat on the plane."""
    quaternion = exact_quaternion(body.quaternion)
    columns = tuple(zip(*matrix(quaternion), strict=True))
    match body.shape:
        case Brick(semi_axes):
            halves = tuple(MP.mpf(half) for half in semi_axes)
            places: tuple[int, ...] = (0, 1, 2)
        case Cylinder(radius, half_length):
            halves = MP.mpf(radius), MP.mpf(radius), MP.mpf(half_length)
            places = (2,)
        case _:
            return None
    up = next((axis for axis in places if MP.hypot(columns[axis][0], columns[axis][1]) <= NONE), None)
    if up is None or abs(real(body.position[2]) - halves[up]) > NONE * halves[up]:
        return None
    if isinstance(body.shape, Cylinder):
        return Face(halves[2], radius=halves[0])
    return Face(halves[up], tuple((columns[axis][:2], halves[axis]) for axis in (0, 1, 2) if axis != up))


def exact_quaternion(quaternion: WideArray) -> Quaternion4:
    """The components w, x, y, z of a quaternion (4,) of the wide type, converted to `MP` without rounding."""
    w, x, y, z = (real(part) for part in quaternion)
    return w, x, y, z


def along_plane(quaternion: Quaternion4, vector: tuple[float, float, float]) -> Vector3:
    """Convert a vector from the axes of a body to the axes of the plane, with an attitude from body to plane."""
    x, y, z = vector
    return turned(matrix(quaternion), (MP.mpf(x), MP.mpf(y), MP.mpf(z)))
