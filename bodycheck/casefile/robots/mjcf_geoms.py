"""Mass, centre of mass and inertia of the geoms of MJCF, as MuJoCo's compiler computes them, in exact arithmetic."""

from dataclasses import dataclass

from bodycheck.casefile.robots.mjcf_settings import Settings, attitude
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.reference.exact.inertia import MassProperties, moments
from bodycheck.reference.exact.numbers import MP, Quaternion4, Real, Vector3, vector
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.robots.orientations import from_z, turned_inertia

#: The kinds of geoms that are solids, with their numbers of sizes; with `fromto` the last size is half the distance.
SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}

#: MuJoCo's density of geoms, kg/m^3.
DENSITY = 1000.0


@dataclass(frozen=True, eq=False)
class Placed:
    """Centre (m) and attitude of a geom in the frame of the body."""

    centre: Vector3
    attitude: Quaternion4


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


def shape(geom: Element) -> Shape | None:
    """Return the shape of a geom; None if case files do not have it. Raises `BadInput` if its sizes cannot be read."""
    kind = _kind(geom)
    if kind not in SIZES or kind == "capsule" or "fromto" in geom.attributes or "mesh" in geom.attributes:
        return None
    return _solid(kind, tuple(float(size) for size in _sizes(geom, kind)))


def mass_properties(geom: Element, rules: Settings) -> MassProperties | None:
    """Return the mass properties of a geom in the frame of the body; None if it has no mass.

    Raises `BadInput` for a geom whose mass is not the mass of a solid of `SIZES`.
    """
    kind = _kind(geom)
    if kind in ("plane", "hfield") or ("mass" in geom.attributes and number(geom, "mass") == 0):
        return None
    if kind not in SIZES:
        refuse(geom, "type", f"read {quoted(kind)}, whose mass is in another file, which is not opened; allowed: an <inertial>")
    if "mesh" in geom.attributes:
        refuse(geom, "mesh", "the size is that of a mesh, which is not opened; allowed: an <inertial>")
    if geom.attributes.get("shellinertia", "false") != "false":
        refuse(geom, "shellinertia", "the inertia of a surface is not computed here; allowed: an <inertial>")
    mass_and_moments = _own(geom, kind)
    if mass_and_moments is None:
        return None
    at = placed(geom, rules)
    return MassProperties(mass_and_moments[0], at.centre, turned_inertia((*mass_and_moments[1], 0.0, 0.0, 0.0), at.attitude))


def _own(geom: Element, kind: str) -> tuple[Real, Vector3] | None:
    """Return the mass (kg) of a geom and its moments (kg m^2) along its own axes; None if its density is 0."""
    sizes = _sizes(geom, kind)
    volume = _volume(kind, sizes)
    states_mass = "mass" in geom.attributes
    mass = MP.mpf(number(geom, "mass")) if states_mass else volume * MP.mpf(number(geom, "density", DENSITY))
    if mass < 0:
        refuse(geom, "mass" if states_mass else "density", "is negative; allowed: at least 0")
    if not mass:
        return None
    if kind != "capsule":
        unit_moments = moments(_solid(kind, tuple(sizes)), 1.0)
        return mass, (mass * unit_moments[0], mass * unit_moments[1], mass * unit_moments[2])
    radius, half = sizes
    ball = mass * (4 * radius**3 / 3) * MP.pi / volume
    rod = mass - ball
    along = rod * radius**2 / 2 + 2 * ball * radius**2 / 5
    # Each half ball has its centre of mass 3/8 of the radius above its flat face.
    across = rod * (radius**2 / 4 + half**2 / 3) + ball * (2 * radius**2 / 5 + half**2 + 3 * radius * half / 4)
    return mass, (across, across, along)


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


def _volume(kind: str, sizes: list[Real]) -> Real:
    match kind:
        case "box":
            return 8 * sizes[0] * sizes[1] * sizes[2]
        case "ellipsoid":
            return 4 * MP.pi * sizes[0] * sizes[1] * sizes[2] / 3
        case "cylinder":
            return 2 * MP.pi * sizes[0] ** 2 * sizes[1]
        case "capsule":
            return 2 * MP.pi * sizes[0] ** 2 * sizes[1] + 4 * MP.pi * sizes[0] ** 3 / 3
        case _:
            return 4 * MP.pi * sizes[0] ** 3 / 3


def _kind(geom: Element) -> str:
    return geom.attributes.get("type", "mesh" if "mesh" in geom.attributes else "sphere")


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
