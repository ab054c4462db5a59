"""Many scenes in free flight that differ in numbers only, as arrays.

A member of an ensemble is a scene whose body, initial state or gravity has other numbers than a base scene. `vary` makes the
arrays of all members at once, with the same meaning as in a case file: numbers are taken as exact, the moments of a homogeneous
solid follow from its mass and sizes, and only the direction of a quaternion counts. `obstacle` names what prevents a scene from
being a base.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.exact import pairs
from bodycheck.reference.exact.pairs import Pair
from bodycheck.reference.inertia import IDENTITY
from bodycheck.reference.scene import (
    Body,
    Brick,
    Cylinder,
    Ellipsoid,
    EulerRates,
    Scene,
    Shape,
    Solid,
    Sphere,
    State,
    Tensor,
    valid,
)
from bodycheck.reference.trajectory import Array

#: The quantities that can vary, and the number of components of each; 0 for a scalar.
VARIABLES = {
    "mass": 0,
    "semi_axes": 3,
    "radius": 0,
    "half_length": 0,
    "moments": 3,
    "position": 3,
    "quaternion": 4,
    "velocity": 3,
    "angular_velocity": 3,
    "gravity": 0,
}

#: The sizes of each shape, by the names of its attributes.
SIZES: dict[type[Shape], tuple[str, ...]] = {
    Brick: ("semi_axes",),
    Ellipsoid: ("semi_axes",),
    Cylinder: ("radius", "half_length"),
    Sphere: ("radius",),
}


@dataclass(frozen=True, eq=False)
class Scenes:
    """m scenes in free flight without drag, whose body frames are along the principal axes. See `scene.Body` and `scene.State`.

    Attributes
    ----------
    like
        The base scene, which holds everything that the members have in common.
    mass
        (m,) masses (kg).
    moments
        (m, 3) principal moments A, B, C (kg m^2), in the nearest doubles.
    exact_moments
        (m, 3) the same moments as pairs, to some 120 bits.
    homogeneous
        Whether the moments follow from the shape and the mass. Otherwise the doubles are taken as exact.
    sizes
        (m, k) sizes of the shapes (m): three semi-axes, or radius and half length, or a radius. None if no size varies.
    position
        (m, 3) initial positions of the centre of mass, world frame (m).
    quaternion
        (m, 4) initial attitudes: unit quaternions w, x, y, z, body to world, in the nearest doubles.
    velocity
        (m, 3) initial velocities of the centre of mass, world frame (m/s).
    angular_velocity
        (m, 3) initial angular velocities, body frame (rad/s).
    gravity
        (m,) gravitational accelerations, along -z (m/s^2).
    """

    like: Scene
    mass: Array
    moments: Array
    exact_moments: Pair
    homogeneous: bool
    sizes: Array | None
    position: Array
    quaternion: Array
    velocity: Array
    angular_velocity: Array
    gravity: Array

    def __len__(self) -> int:
        return len(self.mass)

    def part(self, places: slice | NDArray[Any]) -> "Scenes":
        """Some of the scenes, selected by a slice, by indices or by a mask (m,)."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        arrays = {name: value[places] for name, value in values.items() if isinstance(value, np.ndarray | Pair)}
        return Scenes(**(values | arrays))

    def shape(self, k: int) -> Shape | None:
        """The shape of the member with the index k."""
        shape = self.like.body.shape
        if shape is None or self.sizes is None:
            return shape
        sizes = self.sizes[k].tolist()
        return type(shape)(tuple(sizes)) if isinstance(shape, Brick | Ellipsoid) else type(shape)(*sizes)

    def scene(self, k: int) -> Scene:
        """The member with the index k as a single scene, in the nearest doubles, without a definition."""
        (a, b, c), (w, p, q, r) = self.moments[k].tolist(), self.quaternion[k].tolist()
        (x, y, z), (u, v, s) = self.position[k].tolist(), self.velocity[k].tolist()
        i, j, n = self.angular_velocity[k].tolist()
        body = Body(self.mass.item(k), (a, b, c), self.shape(k))
        return Scene(body, State((x, y, z), (w, p, q, r), (u, v, s), (i, j, n)), self.gravity.item(k))


def obstacle(base: Scene) -> str | None:
    """Return the reason why a scene cannot be the base of `vary`, or None if it can."""
    definition, holds = base.definition, valid(base)
    if base.plane is not None:
        return "it has a plane"
    if base.drag:
        return "it has drag"
    if base.body.axes != IDENTITY:
        return "its body frame is not along the principal axes"
    if definition is not None and holds.inertia and not isinstance(definition.inertia, Solid | Tensor):
        return "its body consists of several particles or parts"
    if definition is not None and holds.rotation and isinstance(definition.rotation, EulerRates):
        return "its initial rotation is given by the rates of Euler angles"
    return None


def variable(base: Scene) -> bool:
    """Return whether a scene can be the base of `vary`."""
    return obstacle(base) is None


def vary(base: Scene, values: Mapping[str, Array]) -> Scenes:
    """The scenes that have other numbers than a base scene.

    The moments follow from the sizes and the mass where the definition of the base is a homogeneous solid, unless they vary
    themselves. Otherwise mass and sizes do not change them. The values are not checked: the caller ensures that each member is
    a possible body.

    Parameters
    ----------
    base
        A scene for which `obstacle` returns None.
    values
        The quantities that vary, by the names in `VARIABLES`, as arrays (m,) of numbers or (m, k) of vectors, in SI units. A
        quaternion (w, x, y, z) can have any length but zero.

    Raises
    ------
    ValueError
        If the base has an obstacle, `values` is empty, a name is not in `VARIABLES` or is a size that the shape does not have,
        or an array has the wrong shape.
    """
    if (reason := obstacle(base)) is not None:
        raise ValueError(f"the numbers of this scene cannot vary: {reason}")
    columns = _checked(base, values)
    m = len(next(iter(columns.values())))
    body, initial, definition = base.body, base.initial, base.definition

    def column(name: str, constant: Any) -> Array:
        return (
            columns[name] if name in columns else np.tile(np.asarray(constant, dtype=float), (m, *[1] * (VARIABLES[name] > 0)))
        )

    mass, sizes = column("mass", body.mass), _sizes(body.shape, columns, m)
    solid = definition is not None and valid(base).inertia and isinstance(definition.inertia, Solid)
    homogeneous = solid and "moments" not in columns
    if homogeneous and ("mass" in columns or sizes is not None):
        assert body.shape is not None  # a solid has the shape of its body
        all_sizes = np.tile(sizes_of(body.shape), (m, 1)) if sizes is None else sizes
        exact = _homogeneous(type(body.shape), mass, all_sizes)
    elif homogeneous:
        from bodycheck.reference.exact.start import start  # processes of engines know this type, but need no mpmath

        one = pairs.of_reals(list(start(base).moments))
        exact = Pair(np.tile(one.high, (m, 1)), np.tile(one.low, (m, 1)))
    else:
        exact = pairs.of_wide(column("moments", body.moments))
    quaternion = _unit(columns["quaternion"]) if "quaternion" in columns else column("quaternion", initial.quaternion)
    return Scenes(
        like=base,
        mass=mass,
        moments=pairs.doubles(exact),
        exact_moments=exact,
        homogeneous=homogeneous,
        sizes=sizes,
        position=column("position", initial.position),
        quaternion=quaternion,
        velocity=column("velocity", initial.velocity),
        angular_velocity=column("angular_velocity", initial.angular_velocity),
        gravity=column("gravity", base.gravity),
    )


def _checked(base: Scene, values: Mapping[str, Array]) -> dict[str, Array]:
    """The values as arrays of doubles, after a check of their names and shapes."""
    columns = {name: np.array(array, dtype=float) for name, array in values.items()}
    if not columns:
        raise ValueError("nothing varies")
    shape_sizes = SIZES[type(base.body.shape)] if base.body.shape is not None else ()
    sizes = {name for names in SIZES.values() for name in names}
    m = len(next(iter(columns.values())))
    for name, array in columns.items():
        if name not in VARIABLES or (name in sizes and name not in shape_sizes):
            raise ValueError(f"{name!r} cannot vary in this scene")
        wanted = (m, VARIABLES[name]) if VARIABLES[name] else (m,)
        if array.shape != wanted:
            raise ValueError(f"{name} has the shape {array.shape}; expected {wanted}")
    return columns


def sizes_of(shape: Shape) -> Array:
    """The sizes (k,), m, of a shape."""
    return np.hstack([getattr(shape, name) for name in SIZES[type(shape)]])


def _sizes(shape: Shape | None, columns: dict[str, Array], m: int) -> Array | None:
    """The sizes (m, k), in metres, of the shapes of all members, or None if no size varies."""
    names = SIZES[type(shape)] if shape is not None else ()
    if not any(name in columns for name in names):
        return None
    return np.column_stack([columns[name] if name in columns else np.full(m, getattr(shape, name)) for name in names])


def _homogeneous(kind: type[Shape], mass: Array, sizes: Array) -> Pair:
    """The moments (m, 3), kg m^2, of homogeneous solids of masses (m,), kg, and sizes (m, k), m.

    The formulas are those of `exact.inertia.moments`.
    """
    weight, squares = pairs.of_wide(mass), pairs.squares(sizes)

    def share(divisor: int) -> Pair:
        return weight / pairs.of_wide(np.full(len(mass), divisor))

    if kind in (Brick, Ellipsoid):
        a, b, c = (squares[:, axis] for axis in range(3))
        factor = share(3 if kind is Brick else 5)
        return pairs.stacked([factor * (b + c), factor * (a + c), factor * (a + b)])
    if kind is Cylinder:
        across = share(4) * squares[:, 0] + share(3) * squares[:, 1]
        return pairs.stacked([across, across, share(2) * squares[:, 0]])
    moment = share(5) * (squares[:, 0] + squares[:, 0])
    return pairs.stacked([moment] * 3)


def _unit(quaternion: Array) -> Array:
    """Quaternions (m, 4) of any length, scaled to unit length, in the nearest doubles."""
    # Scaled by a power of two, so that no square overflows.
    _, exponent = np.frexp(np.abs(quaternion).max(axis=1))
    scaled = np.ldexp(quaternion, -exponent[:, None])
    square = pairs.squares(scaled)
    length = pairs.root((square[:, 0] + square[:, 1]) + (square[:, 2] + square[:, 3]))
    parts = [pairs.of_wide(scaled[:, part]) / length for part in range(4)]
    return pairs.doubles(pairs.stacked(parts)) + 0.0  # no negative zeros, which the exact arithmetic does not have
