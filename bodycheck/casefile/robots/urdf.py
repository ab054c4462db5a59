"""Read one link of a URDF: its <inertial>, and the shape of its <collision>."""

from bodycheck.casefile.robots import orientations
from bodycheck.casefile.robots.elements import Element, number, numbers, place, positive, refuse
from bodycheck.casefile.robots.link import Link, about, chosen, left_out, turned_inertia, without_rounding
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import MP, Vector3, vector
from bodycheck.reference.scene import Brick, Cylinder, Shape, Sphere

#: The six components of <inertia>, in the order XX, YY, ZZ, XY, XZ, YZ.
COMPONENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def link(root: Element, name: str | None) -> Link:
    """Return a link of a URDF; the only one if the name is None.

    The tensor of <inertia> is about the centre of mass, along the axes of the <origin> of <inertial>. Raises `BadInput`.
    """
    refuse_macros(root)
    links = list(root.all("link"))
    found = chosen(root, links, name, "link")
    inertial = found.only("inertial")
    if inertial is None:
        refuse(found, None, "has no <inertial>: a link without mass is no body that can move by itself")
    made, origin = _stated(inertial), inertial.only("origin")
    shape, shape_from = _shape(found, made.centre)
    turned = " turned by its rpy" if origin is not None and "rpy" in origin.attributes else ""
    return Link(
        found.attributes.get("name", ""),
        made,
        f"{place(inertial)}{turned}",
        shape,
        shape_from,
        left_out(len(links) - 1),
    )


def refuse_macros(root: Element) -> None:
    """Raise `BadInput` if a file has macros of xacro."""
    for element in root.everything():
        if element.tag.startswith("xacro:"):
            refuse(element, None, "is a macro of xacro, which is not expanded here; expand the file first")


def inertial_of(found: Element) -> MassProperties | None:
    """Return the mass properties of a link in its frame; None if it has no mass. Raises `BadInput`."""
    inertial = found.only("inertial")
    mass = None if inertial is None else inertial.only("mass")
    if inertial is None:
        return None
    if mass is None or number(mass, "value") != 0:
        return _stated(inertial)
    inertia = inertial.only("inertia")
    if inertia is not None and any(number(inertia, key, 0.0) for key in COMPONENTS):
        refuse(inertia, None, "a moment of inertia without mass, which no body has")
    return None


def _stated(inertial: Element) -> MassProperties:
    """Return the mass properties that an <inertial> states. Raises `BadInput`."""
    mass, inertia, origin = inertial.only("mass"), inertial.only("inertia"), inertial.only("origin")
    if mass is None or inertia is None:
        refuse(inertial, None, f"has no <{'mass' if mass is None else 'inertia'}>, which URDF requires")
    tensor = turned_inertia([number(inertia, key) for key in COMPONENTS], orientations.urdf(origin))
    return without_rounding(MassProperties(MP.mpf(positive(mass, "value")), place_of(origin), tensor))


def place_of(origin: Element | None) -> Vector3:
    """Return the xyz of an <origin> (m)."""
    return vector((0.0, 0.0, 0.0) if origin is None else numbers(origin, "xyz", (3,), (0.0, 0.0, 0.0)))


def _shape(found: Element, centre: Vector3) -> tuple[Shape | None, str]:
    """Return the shape of a link and where it stands; None and why there is none."""
    collisions = list(found.all("collision"))
    if len(collisions) != 1:
        return None, f"the link has {len(collisions) or 'no'} <collision>; a body has one shape"
    geometry, origin = collisions[0].only("geometry"), collisions[0].only("origin")
    solids = [] if geometry is None else geometry.children
    if len(solids) != 1 or solids[0].tag not in ("box", "cylinder", "sphere"):
        return None, f"{place(collisions[0])} is no box, cylinder or sphere"
    shape: Shape
    match solids[0].tag:
        case "box":
            x, y, z = numbers(solids[0], "size", (3,))
            if min(x, y, z) <= 0:
                refuse(solids[0], "size", f"read {x!r} {y!r} {z!r}; allowed: positive lengths")
            shape = Brick((x / 2, y / 2, z / 2))
        case "cylinder":
            shape = Cylinder(positive(solids[0], "radius"), positive(solids[0], "length") / 2)
        case _:
            shape = Sphere(positive(solids[0], "radius"))
    if not about(centre, shape, place_of(origin), orientations.urdf(origin)):
        return None, f"{place(solids[0])} is not about the centre of mass and along the axes of the link"
    return shape, place(solids[0])
