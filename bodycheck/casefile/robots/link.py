"""One body of a robot model as it was read."""

from dataclasses import dataclass

from bodycheck.errors import BadInput
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, NEGLIGIBLE, Quaternion4, Vector3
from bodycheck.reference.exact.rotations import matrix
from bodycheck.reference.scene import Shape, Sphere
from bodycheck.robots.elements import Element, quoted, refuse
from bodycheck.suggestion import did_you_mean

#: Largest distance of the centre of a shape from the centre of mass, relative to the size of the shape, and largest deviation
#: of the elements of a rotation matrix from the identity: the decimals of the file are rounded.
ALIGNED = MP.mpf(10) ** -12


@dataclass(frozen=True, eq=False)
class Link:
    """A body of a robot model.

    Attributes
    ----------
    name
        Its name in the file.
    mass_properties
        Mass (kg), centre of mass (m) and inertia tensor about it (kg m^2) in the frame of the body.
    inertia_from
        A phrase for the place of mass and inertia in the file.
    shape
        A shape about the centre of mass and along the axes of the frame; None if the file has no such shape.
    shape_from
        A phrase for the place of the shape in the file, or for the reason why there is none.
    left_out
        A phrase for the parts of the file that are not in the case; empty if there are none.
    """

    name: str
    mass_properties: MassProperties
    inertia_from: str
    shape: Shape | None
    shape_from: str
    left_out: str


def chosen(root: Element, bodies: list[Element], name: str | None, tag: str) -> Element:
    """Return the body of this name among all bodies of a file; the only one if the name is None.

    Raises `BadInput` if there is no such body, or several.
    """
    names = [body.attributes.get("name", "") for body in bodies]
    listed = ", ".join(quoted(each) for each in names[:20]) + (", …" if len(names) > 20 else "")
    if not bodies:
        refuse(root, None, f"the file has no <{tag}>")
    if name is None:
        if len(bodies) > 1:
            raise BadInput(f"{root.file}: has {len(bodies)} bodies, of which a case has one; choose one by --body: {listed}")
        return bodies[0]
    if name not in names:
        raise BadInput(f"{root.file}: has no body {quoted(name)}; there are: {listed}{did_you_mean(name, names)}")
    if names.count(name) > 1:
        raise BadInput(f"{root.file}: has {names.count(name)} bodies of the name {quoted(name)}; names must be unique")
    return bodies[names.index(name)]


def left_out(others: int) -> str:
    """Return a phrase for what a case leaves out of a model with a number of other bodies; empty if there are none."""
    return f"{others} other {'body' if others == 1 else 'bodies'}, fixed to it or not, and all joints" if others else ""


def about_centre(centre: Vector3, shape: Shape, at: Vector3, attitude: Quaternion4) -> bool:
    """Return whether a shape at the position `at` is centred on a centre of mass, and along the axes of the frame.

    Every attitude of a sphere counts as along the axes.
    """
    size = max((max(value) if isinstance(value, tuple) else value) for value in vars(shape).values())
    placed = all(abs(one - other) <= ALIGNED * size for one, other in zip(at, centre, strict=True))
    rows = matrix(attitude)
    straight = all(abs(rows[i][j] - (i == j)) <= ALIGNED for i in range(3) for j in range(3))
    return placed and (straight or isinstance(shape, Sphere))


def without_rounding(mass_properties: MassProperties) -> MassProperties:
    """Return mass properties with components that are only rounding errors set to zero."""
    largest, farthest = max(map(abs, mass_properties.tensor)), max(map(abs, mass_properties.centre))
    xx, yy, zz, xy, xz, yz = (part if abs(part) > NEGLIGIBLE * largest else MP.mpf(0) for part in mass_properties.tensor)
    x, y, z = (part if abs(part) > NEGLIGIBLE * farthest else MP.mpf(0) for part in mass_properties.centre)
    return MassProperties(mass_properties.mass, (x, y, z), (xx, yy, zz, xy, xz, yz))
