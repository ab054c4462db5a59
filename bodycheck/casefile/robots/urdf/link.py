"""Read one link of a URDF for a case, with the shape of its <collision>."""

from bodycheck.casefile.robots.link import Link, about_centre, chosen, left_out, without_rounding
from bodycheck.casefile.robots.numbers import numbers, positive
from bodycheck.errors import BadInput
from bodycheck.reference.exact.numbers import Vector3
from bodycheck.reference.scene import Brick, Cylinder, Shape, Sphere
from bodycheck.robots import urdf_parts
from bodycheck.robots.attributes import attitude, position
from bodycheck.robots.elements import Element, place, refuse
from bodycheck.robots.faults import About
from bodycheck.robots.urdf import MACRO, about_file, macros


def link(root: Element, name: str | None) -> Link:
    """Return a link of a URDF; the only link if the name is None.

    The tensor of <inertia> is about the centre of mass, along the axes of the <origin> of <inertial>. Raises `BadInput` if the
    link cannot be read exactly.
    """
    refuse_macros(root)
    links = list(root.all("link"))
    link_element = chosen(root, links, name, "link")
    inertial = link_element.only("inertial")
    if inertial is None:
        refuse(link_element, None, "has no <inertial>: a link without mass is no body that can move by itself")
    about = about_file(root)
    stated, origin = urdf_parts.mass_properties(about, link_element), inertial.first("origin")
    refuse_faults(about)
    mass_properties = without_rounding(stated)
    if mass_properties.mass <= 0:
        refuse(inertial.first("mass") or inertial, "value", f"read {float(mass_properties.mass)!r}; allowed: a positive number")
    shape, shape_from = _shape(about, link_element, mass_properties.centre)
    turned = " turned by its rpy" if origin is not None and "rpy" in origin.attributes else ""
    refuse_faults(about)
    return Link(
        link_element.attributes.get("name", ""),
        mass_properties,
        f"{place(inertial)}{turned}",
        shape,
        shape_from,
        left_out(len(links) - 1),
    )


def refuse_macros(root: Element) -> None:
    """Raise `BadInput` if a file has macros of xacro."""
    for element in macros(root):
        refuse(element, None, MACRO)


def refuse_faults(about: About) -> None:
    """Raise `BadInput` for the first fault of a file, but not for faults of limits, which a case leaves out."""
    for fault in about.faults:
        if fault.quantity != "effort_limit":
            raise BadInput(fault.text)


def _shape(about: About, link_element: Element, centre: Vector3) -> tuple[Shape | None, str]:
    """Return the shape of a link and its place in the file; None and the reason if there is none."""
    collisions = list(link_element.all("collision"))
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
    if not about_centre(centre, shape, position(about, "pose", origin), attitude(about, "pose", origin)):
        return None, f"{place(solids[0])} is not about the centre of mass and along the axes of the link"
    return shape, place(solids[0])
