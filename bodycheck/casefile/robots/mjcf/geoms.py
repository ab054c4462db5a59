"""Mass, centre of mass and inertia of the geoms of MJCF, as MuJoCo's compiler computes them, in exact arithmetic."""

from dataclasses import dataclass
from typing import Protocol

from bodycheck.casefile.robots.mjcf import solids
from bodycheck.casefile.robots.mjcf.settings import TRUTHS, Settings, attitude, word
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, matrix, multiply, plus, turned
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.orientations import from_z, turned_inertia

#: The kinds of geoms that are solids, with their numbers of sizes; with `fromto` the last size is half the distance.
SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}

#: MuJoCo's density of geoms, kg/m^3.
DENSITY = 1000.0

#: The largest volume (m^3) of which MuJoCo takes no mass.
NO_VOLUME = 1e-14


@dataclass(frozen=True, eq=False)
class Placed:
    """Centre (m) and attitude of a geom in the frame of the body."""

    centre: Vector3
    attitude: Quaternion4

    def within(self, inner: "Placed") -> "Placed":
        """Return the pose in the frame around this one of what has the pose `inner` in this frame."""
        return Placed(plus(self.centre, turned(matrix(self.attitude), inner.centre)), multiply(self.attitude, inner.attitude))


def placed(geom: Element, rules: Settings) -> Placed:
    """Return the centre and attitude of a geom. Raises `BadInput` if they cannot be read."""
    if "fromto" not in geom.attributes:
        turn = attitude(geom, rules)
        return Placed(vector(numbers(geom, "pos", (3,), (0.0, 0.0, 0.0))), turn)
    first, last = _ends(geom)
    x, y, z = ((one + other) / 2 for one, other in zip(first, last, strict=True))
    dx, dy, dz = (one - other for one, other in zip(first, last, strict=True))
    if not (dx or dy or dz):
        refuse(geom, "fromto", f"read {quoted(geom.attributes['fromto'])}; allowed: two different points")
    return Placed((x, y, z), from_z((dx, dy, dz)))


def shape_of(geom: Element) -> Shape | None:
    """Return the shape of a geom; None if case files do not have it. Raises `BadInput` if its sizes cannot be read."""
    kind = _kind(geom)
    if kind not in SIZES or kind == "capsule" or "fromto" in geom.attributes or "mesh" in geom.attributes:
        return None
    return _solid(kind, tuple(float(size) for size in _sizes(geom, kind)))


@dataclass(frozen=True, eq=False)
class Fitted:
    """A mesh in the frame of its file, in place of which a box or another solid may stand.

    Attributes
    ----------
    volume
        Its volume (m^3), or its area (m^2) if its mass is on its surface.
    placed
        Its centre of mass and its principal axes of inertia, the largest moment first.
    box
        The half-lengths (m) of the box of the same moments.
    bounds
        The smallest and the largest coordinates (m) of its points along these axes.
    """

    volume: Real
    placed: Placed
    box: Vector3
    bounds: tuple[Vector3, Vector3]


class Shapes(Protocol):
    """The meshes and height fields of a file."""

    def mesh(self, geom: Element) -> Fitted:
        """Return the mesh that a geom names. Raises `BadInput` if it cannot be read."""
        ...

    def half_lengths(self, geom: Element) -> Vector3:
        """Return the half-lengths (m) of the box that has the mass of the height field that a geom names."""
        ...


def mass_properties(geom: Element, rules: Settings, shapes: Shapes) -> MassProperties | None:
    """Return the mass properties of a geom in the frame around it; None if it has no mass.

    Raises `BadInput` if they cannot be read exactly.
    """
    kind = _kind(geom)
    if kind == "plane" or ("mass" in geom.attributes and number(geom, "mass") == 0):
        return None
    if kind not in SIZES and kind not in ("mesh", "sdf", "hfield"):
        refuse(geom, "type", f"read {quoted(kind)}; allowed: plane, hfield, mesh, sdf, {', '.join(SIZES)}")
    shell = word(geom, "shellinertia", "false", TRUTHS) == "true"
    at = placed(geom, rules)
    if kind == "hfield":
        kind, sizes = "box", list(shapes.half_lengths(geom))
    elif "mesh" in geom.attributes or kind not in SIZES:
        fitted = shapes.mesh(geom)
        if kind not in SIZES:
            return _of_mesh(geom, fitted, at)
        centre, sizes = _fitted(kind, fitted, rules, MP.mpf(number(geom, "fitscale", 1.0)))
        at = at.within(fitted.placed).within(Placed(centre, IDENTITY))
    else:
        sizes = _sizes(geom, kind)
    volume = solids.extent(kind, sizes, shell)
    mass = _mass(geom, volume)
    if not mass or volume <= NO_VOLUME:
        return None
    along = solids.moments(kind, sizes, shell)
    return _placed_mass(mass, (mass * along[0], mass * along[1], mass * along[2]), at)


def _of_mesh(geom: Element, fitted: Fitted, at: Placed) -> MassProperties | None:
    """Return the mass properties of a geom of the type mesh."""
    mass = _mass(geom, fitted.volume)
    if not mass or fitted.volume <= NO_VOLUME:
        return None
    along = solids.moments("box", list(fitted.box), shell=False)
    return _placed_mass(mass, (mass * along[0], mass * along[1], mass * along[2]), at.within(fitted.placed))


def _fitted(kind: str, fitted: Fitted, rules: Settings, scale: Real) -> tuple[Vector3, list[Real]]:
    """Return the centre, along the axes of a mesh, and the sizes of a solid that is fitted to the mesh."""
    centre, (x, y, z) = ORIGIN, fitted.box
    if rules.fitaabb:
        low, high = fitted.bounds
        centre = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2)
        x, y, z = (top - middle for top, middle in zip(high, centre, strict=True))
    match kind, rules.fitaabb:
        case "sphere", whole:
            sizes = [max(x, y, z) if whole else (x + y + z) / 3]
        case (("capsule" | "cylinder"), whole):
            radius = max(x, y) if whole else (x + y) / 2
            cap = 0 if kind == "cylinder" else radius if whole else radius / 2
            sizes = [radius, z - cap if whole else max(MP.mpf(0), z - cap)]
        case _:
            sizes = [x, y, z]
    return centre, [scale * size for size in sizes]


def _mass(geom: Element, volume: Real) -> Real:
    """Return the mass (kg) of a geom of a volume (m^3), or of an area (m^2) with a density of 1/m^2."""
    states_mass = "mass" in geom.attributes
    mass = MP.mpf(number(geom, "mass")) if states_mass else volume * MP.mpf(number(geom, "density", DENSITY))
    if mass < 0:
        refuse(geom, "mass" if states_mass else "density", "is negative; allowed: at least 0")
    return mass


def _placed_mass(mass: Real, along: Vector3, at: Placed) -> MassProperties:
    return MassProperties(mass, at.centre, turned_inertia((*along, 0.0, 0.0, 0.0), at.attitude))


def _solid(kind: str, sizes: tuple[Real, ...]) -> Shape:
    match kind:
        case "box":
            return Brick((sizes[0], sizes[1], sizes[2]))
        case "ellipsoid":
            return Ellipsoid((sizes[0], sizes[1], sizes[2]))
        case "cylinder":
            return Cylinder(sizes[0], sizes[1])
        case _:
            return Sphere(sizes[0])


def _kind(geom: Element) -> str:
    return geom.attributes.get("type", "sphere")


def _sizes(geom: Element, kind: str) -> list[Real]:
    """Return the sizes (m) of a geom, in half-lengths and radii. Raises `BadInput` unless all are positive."""
    count, ends = SIZES[kind], "fromto" in geom.attributes
    if ends and kind == "sphere":
        refuse(geom, "fromto", "a sphere has no ends; allowed: pos")
    needed = 1 if ends else count
    read = numbers(geom, "size", tuple(range(needed, 4)))
    if min(read[:needed]) <= 0:
        refuse(geom, "size", f"read {quoted(geom.attributes['size'])}; allowed: positive lengths")
    if not ends:
        return [MP.mpf(size) for size in read[:count]]
    first, last = _ends(geom)
    half = MP.sqrt(sum((one - other) ** 2 for one, other in zip(first, last, strict=True))) / 2
    return [*[MP.mpf(read[0])] * (count - 1), half]


def _ends(geom: Element) -> tuple[Vector3, Vector3]:
    values = numbers(geom, "fromto", (6,))
    return vector(values[:3]), vector(values[3:])
