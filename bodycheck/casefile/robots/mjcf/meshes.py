"""The meshes and height fields of an MJCF file, as MuJoCo's compiler takes mass and inertia from them.

https://mujoco.readthedocs.io/en/stable/XMLreference.html#asset-mesh-inertia. The sums over triangles are computed in the 80-bit
type. MuJoCo computes them in double precision, and stops the search of principal axes at products of inertia of 1e-12 m^5, so
that it reads meshes of a few centimetres less exactly.
"""

from collections.abc import Sequence
from pathlib import PurePosixPath

import numpy as np
from numpy.typing import NDArray

from bodycheck.casefile.robots.mjcf import mesh_files
from bodycheck.casefile.robots.mjcf.geoms import Fitted, Placed
from bodycheck.casefile.robots.mjcf.mesh_files import Triangles
from bodycheck.casefile.robots.mjcf.settings import Defaults, Settings, word
from bodycheck.casefile.robots.numbers import many, numbers
from bodycheck.casefile.robots.reading import Files
from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import MP, Real, Vector3, exactly, vector, wide
from bodycheck.reference.exact.rotations import matrix
from bodycheck.robots.elements import Element, place, quoted, refuse
from bodycheck.robots.named_files import NotFound
from bodycheck.robots.orientations import principal_axes
from bodycheck.suggestion import did_you_mean

Wide = NDArray[np.longdouble]

#: The rules for the inertia of a mesh.
RULES = ("legacy", "convex", "exact", "shell")

#: The smallest length of the normal of a triangle (m^2) that has an area, and the smallest area or volume of a mesh.
LEAST = 1e-15

#: The pairs of axes of the components XX, YY, ZZ, XY, XZ, YZ.
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class MeshesOfFile:
    """The meshes and height fields that geoms of a file name. Files of meshes are read when they are needed, and once."""

    def __init__(self, root: Element, rules: Settings, files: Files) -> None:
        self.rules, self.files = rules, files
        assets = [asset for section in root.all("asset") for asset in section.children]
        defaults = Defaults(root, "mesh")
        meshes = [defaults.resolved(asset, None) for asset in assets if asset.tag == "mesh"]
        self.meshes = {mesh.attributes.get("name") or _stem(mesh.attributes.get("file", "")): mesh for mesh in meshes}
        self.fields = {asset.attributes.get("name", ""): asset for asset in assets if asset.tag == "hfield"}
        self.fitted: dict[str, Fitted] = {}

    def mesh(self, geom: Element) -> Fitted:
        """Return the mesh that a geom names. Raises `BadInput` if it cannot be read."""
        name = geom.attributes.get("mesh", "")
        if name not in self.meshes:
            refuse(geom, "mesh", f"there is no mesh {quoted(name)}{did_you_mean(name, self.meshes)}")
        if name not in self.fitted:
            self.fitted[name] = _fitted(self.meshes[name], self._triangles(self.meshes[name]))
        return self.fitted[name]

    def half_lengths(self, geom: Element) -> Vector3:
        """Return the half-lengths (m) of the box that has the mass of the height field that a geom names."""
        name = geom.attributes.get("hfield", "")
        if name not in self.fields:
            refuse(geom, "hfield", f"there is no height field {quoted(name)}{did_you_mean(name, self.fields)}")
        x, y, top, base = map(MP.mpf, numbers(self.fields[name], "size", (4,)))
        return x, y, top / 4 + base / 2

    def _triangles(self, mesh: Element) -> Triangles:
        """Return the triangles of a mesh; none if it is the convex hull of its corners."""
        if "builtin" in mesh.attributes or mesh.first("plugin") is not None:
            refuse(mesh, None, "is made by MuJoCo, and its inertia is not computed here; allowed: an <inertial>")
        if "file" in mesh.attributes:
            return self._of_file(mesh, mesh.attributes["file"])
        try:
            return mesh_files.of_numbers(many(mesh, "vertex"), many(mesh, "face", ()))
        except BadInput as error:
            refuse(mesh, "vertex", str(error))

    def _of_file(self, mesh: Element, file: str) -> Triangles:
        name = file.replace("\\", "/")
        name = name.rpartition("/")[2] if self.rules.strippath else name
        path = PurePosixPath(self.rules.meshdir.replace("\\", "/")) / name
        try:
            return mesh_files.triangles(self.files.content(str(path)), path.suffix.lower())
        except NotFound as error:
            refuse(mesh, "file", f"{quoted(file)} {error}, and its shape carries mass")
        except BadInput as error:
            raise BadInput(f"{place(mesh, 'file')}: {quoted(file)} {error}") from error


def _stem(file: str) -> str:
    """Return the default name of a mesh with a file: the name of the file without folder and ending."""
    return file.replace("\\", "/").rpartition("/")[2].rpartition(".")[0]


def _fitted(mesh: Element, read: Triangles) -> Fitted:
    """Return a mesh by the rule of its element. Raises `BadInput` if it has no mass by this rule."""
    rule = word(mesh, "inertia", "legacy", RULES)
    corners = read.corners.astype(np.longdouble)
    hull = _hull(mesh, read.corners) if rule == "convex" or not len(read.faces) else read.faces
    scale = numbers(mesh, "scale", (3,), (1.0, 1.0, 1.0))
    if not all(scale):
        refuse(mesh, "scale", f"read {quoted(mesh.attributes['scale'])}; allowed: numbers that are not 0")
    corners = _placed(mesh, corners) * np.array(scale, np.longdouble)
    if np.prod(np.sign(scale)) < 0:
        hull = hull[:, [0, 2, 1]]
    extent, centre, tensor = _sums(mesh, corners, hull, read.faces if len(read.faces) else hull, rule)
    xx, yy, zz, xy, xz, yz = map(exactly, tensor)
    (a, b, c), turn = principal_axes((xx, yy, zz, xy, xz, yz))
    volume = exactly(extent)
    squares = [6 * (b + c - a) / volume, 6 * (a + c - b) / volume, 6 * (a + b - c) / volume]
    box = vector([MP.sqrt(max(square, 0)) / 2 for square in squares])
    return Fitted(volume, Placed(vector(list(map(exactly, centre))), turn), box, _bounds(corners - centre, turn))


def _placed(mesh: Element, corners: Wide) -> Wide:
    """Return the corners (n, 3) of a mesh in the frame that `refpos` and `refquat` give."""
    moved = corners - np.array(numbers(mesh, "refpos", (3,), (0.0, 0.0, 0.0)), np.longdouble)
    w, x, y, z = numbers(mesh, "refquat", (4,), (1.0, 0.0, 0.0, 0.0))
    if not (w or x or y or z):
        refuse(mesh, "refquat", "read zeros; allowed: a quaternion that is not 0")
    rows = matrix((MP.mpf(w), MP.mpf(x), MP.mpf(y), MP.mpf(z)))
    return np.asarray(moved @ np.array([[wide(part) for part in row] for row in rows]))


def _hull(mesh: Element, corners: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return the triangles (m, 3) of the convex hull of points, with their corners in the order that faces outwards."""
    from scipy.spatial import ConvexHull, QhullError  # heavy, and few files need it

    try:
        hull = ConvexHull(corners.astype(float), qhull_options="Qt")
    except (QhullError, ValueError):
        refuse(mesh, None, "has corners without a convex hull")
    faces = hull.simplices.astype(np.int64)
    a, b, c = (hull.points[faces[:, index]] for index in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces[inwards] = faces[inwards][:, [0, 2, 1]]
    return faces


def _sums(
    mesh: Element, corners: Wide, faces: NDArray[np.int64], all_faces: NDArray[np.int64], rule: str
) -> tuple[np.longdouble, Wide, Sequence[np.longdouble]]:
    """Return the volume (m^3) or area (m^2) of a mesh, its centre (m), and its tensor about it with the density 1.

    faces: that carry the mass. all_faces: of the mesh, whose centroid is the point from which the volume is summed first.
    """
    _, areas, centres = _of_triangles(corners[all_faces])
    if (area := areas.sum()) < LEAST:
        refuse(mesh, None, "has no surface")
    centroid = (areas[:, None] * centres).sum(axis=0) / area
    normals, areas, centres = _of_triangles(corners[faces])
    parts = _extents(normals, areas, centres - centroid, rule)
    total = parts.sum()
    if total < LEAST:
        refuse(mesh, None, f"has {'a negative' if total < 0 else 'no'} volume; allowed: triangles that face outwards")
    centre = (parts[:, None] * (centres * 3 / 4 + centroid / 4)).sum(axis=0) / total
    about = corners[faces] - centre
    normals, areas, centres = _of_triangles(about)
    parts = _extents(normals, areas, centres, rule)
    weights = parts / (12 if rule == "shell" else 20)
    d, e, f = about[:, 0], about[:, 1], about[:, 2]
    products = [
        (
            weights
            * (
                2 * (d[:, i] * d[:, j] + e[:, i] * e[:, j] + f[:, i] * f[:, j])
                + (d[:, i] * e[:, j] + d[:, j] * e[:, i] + d[:, i] * f[:, j])
                + (d[:, j] * f[:, i] + e[:, i] * f[:, j] + e[:, j] * f[:, i])
            )
        ).sum()
        for i, j in PAIRS
    ]
    xx, yy, zz, xy, xz, yz = products
    return parts.sum(), centre, (yy + zz, xx + zz, xx + yy, -xy, -xz, -yz)


def _of_triangles(corners: Wide) -> tuple[Wide, Wide, Wide]:
    """Return the normals of the lengths of twice the areas (m, 3), the areas (m,) and the centres (m, 3) of triangles."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.sqrt(np.square(normals).sum(axis=1))
    return normals, np.where(lengths < LEAST, 0, lengths / 2), corners.mean(axis=1)


def _extents(normals: Wide, areas: Wide, arms: Wide, rule: str) -> Wide:
    """Return the areas (m,) of triangles, or the volumes of the pyramids that they form with a point.

    arms: (m, 3), from the point to the centres of the triangles.
    """
    if rule == "shell":
        return areas
    volumes = np.where(areas > 0, np.einsum("ij,ij->i", arms, normals) / 6, 0)
    return np.abs(volumes) if rule == "legacy" else volumes


def _bounds(corners: Wide, turn: Sequence[Real]) -> tuple[Vector3, Vector3]:
    """Return the smallest and the largest coordinates of points (n, 3) along axes with an attitude."""
    rows = matrix((turn[0], turn[1], turn[2], turn[3]))
    along = corners @ np.array([[wide(part) for part in row] for row in rows])
    low, high = along.min(axis=0), along.max(axis=0)
    return vector(list(map(exactly, low))), vector(list(map(exactly, high)))
