"""Write a body of a robot model into the text of a new case file."""

import json
import re
from pathlib import Path

from bodycheck.casefile.case import CaseFaults, parse
from bodycheck.casefile.robots.link import Link
from bodycheck.casefile.robots.mjcf.link import link as mjcf_link
from bodycheck.casefile.robots.urdf.link import link as urdf_link
from bodycheck.casefile.values import MAX_NAME_LENGTH
from bodycheck.errors import BadInput
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape, Sphere
from bodycheck.robots import elements
from bodycheck.robots.elements import quoted

#: The functions that read a body, by the tag of the root of its file.
READERS = {"robot": ("URDF", urdf_link), "mujoco": ("MJCF", mjcf_link)}

#: The table of the body in the template, up to the next table.
BODY = re.compile(r"^\[body\]\n.*?(?=^\[initial\])", re.DOTALL | re.MULTILINE)


def read(path: Path, body: str | None) -> Link:
    """Return a body of a URDF or MJCF file; the only body if the name is None.

    Raises `BadInput` for a file that cannot be read, is no robot model, has no such body, or whose body cannot be read exactly.
    """
    root = elements.read(path)
    if root.tag not in READERS:
        elements.refuse_root(root)
    _, reader = READERS[root.tag]
    return reader(root, body)


def case_name(link: Link) -> str:
    """Return a name for a case, made from the name of a body. Raises `BadInput` if that has no letters or digits."""
    name = re.sub(r"[^a-z0-9]+", "-", link.name.lower()).strip("-")[:MAX_NAME_LENGTH]
    if not name:
        raise BadInput(
            f"the name of the body, {quoted(link.name)}, is no name of a case; give one: bodycheck new NAME --from …"
        )
    return name


def text(template: str, link: Link, file: Path) -> str:
    """Return the text of a case with a body, otherwise the same as a template.

    Raises `BadInput` if no body can have its inertia.
    """
    source = quoted(file.name)[1:-1]
    case_text = BODY.sub(lambda _: _body(link, source), template, count=1)
    title = json.dumps(f"{quoted(link.name)[1:-1]} of {source}", ensure_ascii=False)
    case_text = re.sub(r"^title = .*$", lambda _: f"title = {title}", case_text, count=1, flags=re.MULTILINE)
    case_text = re.sub(
        r'^source = ""', lambda _: f"source = {json.dumps(source, ensure_ascii=False)}", case_text, count=1, flags=re.MULTILINE
    )
    try:
        parse(case_text, source)
    except CaseFaults as error:
        faults = "; ".join(fault.message for fault in error.faults)
        raise BadInput(f"{link.inertia_from}: {faults}") from error
    return case_text


def _body(link: Link, source: str) -> str:
    """Return the table of the body, with comments on the origin of each number."""
    mass_properties = link.mass_properties
    xx, yy, zz, xy, xz, yz = (repr(float(part)) for part in mass_properties.tensor)
    centre = ", ".join(repr(float(part)) for part in mass_properties.centre)
    lines = [
        "[body]",
        f"# The body {quoted(link.name)} of {source}, in the frame that it has there, moved to its centre of mass,",
        f"# which is at [{centre}] m in that frame.",
        *([f"# Left out: {link.left_out}. A case has one body."] if link.left_out else []),
        f"# Mass and inertia: {link.inertia_from}",
        *_shape(link.shape, link.shape_from),
        f"mass = {float(mass_properties.mass)!r}  # kg",
        f"inertia = [[{xx}, {xy}, {xz}], [{xy}, {yy}, {yz}], [{xz}, {yz}, {zz}]]  # kg m^2, about the centre of mass",
    ]
    return "\n".join(lines) + "\n\n"


def _shape(shape: Shape | None, shape_from: str) -> list[str]:
    match shape:
        case None:
            return [f"# No shape: {shape_from}.", 'shape = "none"']
        case Brick(sizes):
            lines = ['shape = "brick"', f"semi_axes = {list(map(float, sizes))}  # m"]
        case Ellipsoid(sizes):
            lines = ['shape = "ellipsoid"', f"semi_axes = {list(map(float, sizes))}  # m"]
        case Cylinder(radius, half_length):
            lines = ['shape = "cylinder"', f"radius = {float(radius)!r}  # m", f"half_length = {float(half_length)!r}  # m"]
        case Sphere(radius):
            lines = ['shape = "sphere"', f"radius = {float(radius)!r}  # m"]
    return [f"# Shape: {shape_from}", *lines]
