"""Volume and moments of inertia of the solids and shells that geoms of MJCF are, as MuJoCo computes them, in exact arithmetic.

A shell has its mass on its surface. The extent of a solid is its volume (m^3), that of a shell its area (m^2).
"""

from collections.abc import Sequence

from bodycheck.reference.exact.numbers import MP, Real, Vector3

#: The exponent of Thomsen's approximation of the area of an ellipsoid.
THOMSEN = MP.mpf(1.6075)

#: The thickness (m) of the layer by which MuJoCo replaces the surface of an ellipsoid.
LAYER = MP.mpf(1e-6)


def extent(kind: str, sizes: Sequence[Real], shell: bool) -> Real:
    """Return the volume of a solid, or the area of a shell. sizes: half-lengths and radii (m)."""
    match kind, shell:
        case "box", False:
            return 8 * sizes[0] * sizes[1] * sizes[2]
        case "box", True:
            return 8 * (sizes[0] * sizes[1] + sizes[1] * sizes[2] + sizes[2] * sizes[0])
        case "ellipsoid", False:
            return 4 * MP.pi * sizes[0] * sizes[1] * sizes[2] / 3
        case "ellipsoid", True:
            a, b, c = sizes
            mean = ((a * b) ** THOMSEN + (b * c) ** THOMSEN + (c * a) ** THOMSEN) / 3
            return 4 * MP.pi * mean ** (1 / THOMSEN)
        case "cylinder", False:
            return 2 * MP.pi * sizes[0] ** 2 * sizes[1]
        case "cylinder", True:
            return 2 * MP.pi * sizes[0] ** 2 + 4 * MP.pi * sizes[0] * sizes[1]
        case "capsule", False:
            return 2 * MP.pi * sizes[0] ** 2 * sizes[1] + 4 * MP.pi * sizes[0] ** 3 / 3
        case "capsule", True:
            return 4 * MP.pi * sizes[0] ** 2 + 4 * MP.pi * sizes[0] * sizes[1]
        case _, False:
            return 4 * MP.pi * sizes[0] ** 3 / 3
        case _, _:
            return 4 * MP.pi * sizes[0] ** 2


def moments(kind: str, sizes: Sequence[Real], shell: bool) -> Vector3:
    """Return the moments (m^2) of a solid or a shell of the mass 1 along its axes."""
    match kind, shell:
        case "box", False:
            return _across([size**2 / 3 for size in sizes])
        case "box", True:
            return _of_faces(sizes)
        case "ellipsoid", False:
            return _across([size**2 / 5 for size in sizes])
        case "ellipsoid", True:
            return _of_layer(sizes)
        case (("cylinder" | "capsule"), _):
            return _round(kind, sizes[0], sizes[1], shell)
        case _, _:
            moment = sizes[0] ** 2 * (MP.mpf(2) / 3 if shell else MP.mpf(2) / 5)
            return moment, moment, moment


def _across(squares: Sequence[Real]) -> Vector3:
    """Return the moments of a body whose mean squares of the coordinates are given."""
    return squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]


def _of_faces(sizes: Sequence[Real]) -> Vector3:
    """Return the moments of the surface of a box of the mass 1."""
    a, b, c = sizes
    areas = (b * c, a * c, a * b)  # of the faces across each axis; their pairs have twice these parts of the whole
    whole = sum(areas)
    squares = [
        sum(area * (size**2 if across == axis else size**2 / 3) for across, area in enumerate(areas)) / whole
        for axis, size in enumerate(sizes)
    ]
    return _across(squares)


def _of_layer(sizes: Sequence[Real]) -> Vector3:
    """Return the moments of a layer of the mass 1 about an ellipsoid."""
    outer = [size + LAYER for size in sizes]
    inside, whole = sizes[0] * sizes[1] * sizes[2], outer[0] * outer[1] * outer[2]
    squares = [(whole * far**2 - inside * near**2) / (5 * (whole - inside)) for near, far in zip(sizes, outer, strict=True)]
    return _across(squares)


def _round(kind: str, radius: Real, half: Real, shell: bool) -> Vector3:
    """Return the moments of a cylinder or capsule of the mass 1 along z."""
    whole = extent(kind, (radius, half), shell)
    ends = (2 * MP.pi * radius**2 if shell else MP.mpf(0)) if kind == "cylinder" else extent("sphere", (radius,), shell)
    end, side = ends / whole, 1 - ends / whole
    # The mean squares of the coordinate x of the side, and of the ends; and of the coordinate z of the ends.
    of_side = radius**2 / (2 if shell else 4)
    if kind == "cylinder":
        of_ends, along = radius**2 / 4, half**2
    elif shell:
        # The centre of mass of a hemisphere is half of its radius above its edge.
        of_ends, along = radius**2 / 3, radius**2 / 3 + half**2 + radius * half
    else:
        # The centre of mass of each half ball is 3/8 of the radius above its flat face.
        of_ends, along = radius**2 / 5, radius**2 / 5 + half**2 + 3 * radius * half / 4
    x, z = side * of_side + end * of_ends, side * half**2 / 3 + end * along
    return x + z, x + z, 2 * x
