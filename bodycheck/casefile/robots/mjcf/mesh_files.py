"""Read the triangles of meshes from files of strangers, with coordinates in single precision as MuJoCo has them.

- STL: https://en.wikipedia.org/wiki/STL_(file_format), binary and text
- OBJ: only the first object or group with faces, as MuJoCo reads it; polygons are divided into triangles
- MSH: https://mujoco.readthedocs.io/en/stable/XMLreference.html#legacy-msh-docs
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bodycheck.errors import BadInput

#: The largest number of triangles of a mesh.
MAX_TRIANGLES = 500_000

#: The record of a triangle in a binary STL file.
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@dataclass(frozen=True, eq=False)
class Triangles:
    """A mesh: the positions of its corners (n, 3), and the indices (m, 3) of the corners of each triangle."""

    corners: NDArray[np.float32]
    faces: NDArray[np.int64]


def triangles(content: bytes, suffix: str) -> Triangles:
    """Return the mesh in the content of a file. Raises `BadInput` if it is no mesh that can be read.

    suffix: the ending of the name of the file, in small letters.
    """
    readers = {".stl": _of_stl, ".obj": _of_obj, ".msh": _of_msh}
    if suffix not in readers:
        raise BadInput("is no STL, OBJ or MSH file")
    try:
        with np.errstate(over="ignore"):  # coordinates beyond single precision, which are refused below
            mesh = readers[suffix](content)
    except (ValueError, IndexError, OverflowError) as error:
        raise BadInput(f"is no {suffix[1:].upper()} file that can be read") from error
    return _checked(mesh)


def of_numbers(corners: Sequence[float], faces: Sequence[float]) -> Triangles:
    """Return the mesh of the coordinates of corners and of the indices of faces. Raises `BadInput` if it is none."""
    if len(corners) % 3 or len(faces) % 3 or any(index != int(index) for index in faces):
        raise BadInput("states no mesh; allowed: three coordinates of each corner, and three corners of each face")
    limited(len(faces) // 3)
    with np.errstate(over="ignore", invalid="ignore"):  # numbers that do not fit, which are refused below
        places = np.array(corners, np.float32).reshape(-1, 3)
        mesh = Triangles(places, np.array(faces, np.float64).astype(np.int64).reshape(-1, 3))
    return _checked(mesh)


def _checked(mesh: Triangles) -> Triangles:
    """Return a mesh. Raises `BadInput` if a coordinate is not finite, or a triangle has a corner that there is not."""
    if not np.isfinite(mesh.corners).all():
        raise BadInput("has a coordinate that is not finite")
    if len(mesh.faces) and not (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.corners)):
        raise BadInput("has a triangle without all of its corners")
    return mesh


def limited(count: int) -> int:
    """Return a number of triangles. Raises `BadInput` if it exceeds `MAX_TRIANGLES`."""
    if count > MAX_TRIANGLES:
        raise BadInput(f"has more than {MAX_TRIANGLES} triangles")
    return count


def _of_stl(content: bytes) -> Triangles:
    count = int.from_bytes(content[80:84], "little")
    if len(content) == 84 + RECORD.itemsize * count:
        corners = np.frombuffer(content, RECORD, limited(count), 84)["corners"].reshape(-1, 3)
    else:
        words = [line.split() for line in content.splitlines() if line.split()[:1] == [b"vertex"]]
        limited(len(words) // 3)
        corners = np.array([[float(word) for word in line[1:4]] for line in words], np.float32)
        if len(words) % 3 or not len(words) or not content.lstrip().startswith(b"solid"):
            raise ValueError
    return Triangles(corners, np.arange(len(corners)).reshape(-1, 3))


def _of_msh(content: bytes) -> Triangles:
    corners, normals, textures, faces = (int(number) for number in np.frombuffer(content, "<i4", 4))
    if len(content) != 16 + 4 * (3 * corners + 3 * normals + 2 * textures + 3 * limited(faces)) or min(corners, faces) < 0:
        raise ValueError
    first = 16 + 4 * (3 * corners + 3 * normals + 2 * textures)
    indices = np.frombuffer(content, "<i4", 3 * faces, first).astype(np.int64)
    return Triangles(np.frombuffer(content, "<f4", 3 * corners, 16).reshape(-1, 3), indices.reshape(-1, 3))


def _of_obj(content: bytes) -> Triangles:
    corners: list[list[float]] = []
    polygons: list[list[int]] = []
    of_first = True
    for line in content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines():
        match line.split():
            case [b"v", x, y, z, *_]:
                corners.append([float(x), float(y), float(z)])
            case [b"f", *indices] if of_first:
                read = [int(index.split(b"/")[0]) for index in indices]
                polygons.append([index - 1 if index > 0 else len(corners) + index for index in read])
                limited(len(polygons))
            case [(b"o" | b"g"), *_] if polygons:
                of_first = False
    places = np.array(corners, np.float32).reshape(-1, 3)
    faces = [face for polygon in polygons for face in _divided(polygon, places)]
    limited(len(faces))
    return Triangles(places, np.array(faces, np.int64).reshape(-1, 3))


def _divided(polygon: list[int], corners: NDArray[np.float32]) -> list[list[int]]:
    """Return the triangles of a polygon: those of a quadrangle along its shorter diagonal, others from the first corner on."""
    if len(polygon) < 3:
        raise ValueError
    if len(polygon) == 4:
        a, b, c, d = polygon
        lengths = [np.square(corners[one].astype(float) - corners[other]).sum() for one, other in ((a, c), (b, d))]
        return [[a, b, c], [a, c, d]] if lengths[0] < lengths[1] else [[a, b, d], [b, c, d]]
    return [[polygon[0], one, other] for one, other in pairwise(polygon[1:])]
