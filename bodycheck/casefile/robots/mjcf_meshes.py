"""The meshes and height fields of an MJCF file."""

from bodycheck.casefile.robots.mjcf_geoms import Fitted
from bodycheck.casefile.robots.mjcf_settings import Settings
from bodycheck.casefile.robots.reading import Files
from bodycheck.reference.exact.numbers import Vector3
from bodycheck.robots.elements import Element, refuse


class MeshesOfFile:
    """The meshes and height fields that geoms of a file name."""

    def __init__(self, root: Element, rules: Settings, files: Files) -> None:
        self.root, self.rules, self.files = root, rules, files

    def mesh(self, geom: Element) -> Fitted:
        """Return the mesh that a geom names. Raises `BadInput` if it cannot be read."""
        refuse(geom, "mesh", "is not read yet")

    def half_lengths(self, geom: Element) -> Vector3:
        """Return the half-lengths (m) of the box that has the mass of the height field that a geom names."""
        refuse(geom, "hfield", "is not read yet")
