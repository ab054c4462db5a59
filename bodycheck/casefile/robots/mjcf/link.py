"""Read one body of an MJCF file as MuJoCo's compiler does: its <inertial>, or the inertia of its geoms.

Settings that could change the meaning of a number are followed (angle, eulerseq, inertiafromgeom, inertiagrouprange, default
classes) or refused with the reason.
"""

from collections.abc import Iterator

from bodycheck.casefile.robots.link import Link, about_centre, chosen, left_out
from bodycheck.casefile.robots.mjcf.geoms import Fitted, placed, shape_of
from bodycheck.casefile.robots.mjcf.inertia import inertia_of
from bodycheck.casefile.robots.mjcf.parts import classes_of, parts_of
from bodycheck.casefile.robots.mjcf.settings import Settings, settings
from bodycheck.casefile.robots.numbers import number
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.reference.exact.numbers import Vector3
from bodycheck.reference.scene import Shape
from bodycheck.robots.elements import Element, place, quoted, refuse
from bodycheck.robots.mjcf_assembly import own

#: Elements of a file that stand for other elements, which are not read here.
WRITERS = ("replicate", "composite", "flexcomp")


def link(root: Element, name: str | None) -> Link:
    """Return a body of an MJCF file; the only one if the name is None. Raises `BadInput` if it cannot be read exactly."""
    inherited: dict[Element, str | None] = {}
    for world in root.all("worldbody"):
        inherited |= dict(_bodies(world, None))
    for compiler in root.all("compiler"):
        _refuse_what_changes_bodies(compiler)
    for element in root.everything():
        if element.tag == "include":
            refuse(element, "file", "names another file, which is not opened; put its content in its place")
    body = chosen(root, list(inherited), name, "body")
    _refuse_what_is_not_followed(body)
    rules = settings(root)
    parts = parts_of(body, inherited[body], rules, classes_of(root))
    if rules.inertiafromgeom == "false" and body.only("inertial") is None:
        refuse(body, None, 'has no <inertial>, and the compiler does not take the inertia from geoms (inertiafromgeom="false")')
    mass_properties = inertia_of(body, parts, rules, NoFiles())
    if mass_properties is None or not mass_properties.mass:
        refuse(body, None, "has no <inertial> and no geom with a mass; a body without mass cannot move by itself")
    geoms = [part.element for part in parts if part.element.tag == "geom"]
    shape, shape_from = _shape(geoms, mass_properties, rules)
    inertia_from = _inertia_from(body, geoms, rules)
    return Link(body.attributes.get("name", ""), mass_properties, inertia_from, shape, shape_from, left_out(len(inherited) - 1))


class NoFiles:
    """The meshes and height fields of a file of which no other file is opened."""

    def mesh(self, geom: Element) -> Fitted:
        """Raise `BadInput`."""
        refuse(geom, "mesh", "names a mesh, which is not opened; allowed: an <inertial>")

    def half_lengths(self, geom: Element) -> Vector3:
        """Raise `BadInput`."""
        refuse(geom, "hfield", "names a height field, which is not read; allowed: an <inertial>")


def _refuse_what_changes_bodies(compiler: Element) -> None:
    """Raise `BadInput` for settings that change masses, inertias or frames, which a single body is not told with."""
    for key in ("fusestatic", "discardvisual", "alignfree", "balanceinertia"):
        if (value := compiler.attributes.get(key, "false")) != "false":
            refuse(compiler, key, f"read {quoted(value)}, which changes bodies and is not followed here; allowed: false")
    for key in ("settotalmass", "boundmass", "boundinertia"):
        if number(compiler, key, 0.0) > 0:
            refuse(compiler, key, f"read {quoted(compiler.attributes[key])}, which changes masses and is not followed here")


def _refuse_what_is_not_followed(body: Element) -> None:
    """Raise `BadInput` for elements of a body that may change its mass or frame; bodies inside it are not checked."""
    for element in own(body):
        if element.tag in WRITERS:
            refuse(
                element, None, f"stands for other elements, which are not read here; allowed: a body without <{element.tag}>"
            )
        if element.tag == "freejoint" and element.attributes.get("align") == "true":
            refuse(element, "align", "read 'true', which gives the body another frame and is not followed here; allowed: false")
        if element.tag in ("geom", "inertial") and element not in body.children:
            refuse(
                element,
                None,
                "is in a <frame>, which is not followed here; put it into the <body>, with the pose that it has there",
            )


def _bodies(parent: Element, inherited: str | None) -> Iterator[tuple[Element, str | None]]:
    """Yield all bodies below an element, each with the name of the default class of its geoms."""
    left = [(parent, inherited)]
    while left:
        element, name = left.pop()
        name = element.attributes.get("childclass", name)
        if element.tag == "body":
            yield element, name
        left += [(child, name) for child in reversed(element.children) if child.tag in ("body", "frame")]


def _inertia_from(body: Element, geoms: list[Element], rules: Settings) -> str:
    """Return a phrase for the place of the mass properties of a body in the file."""
    counted = [geom for geom in geoms if rules.counts(number(geom, "group", 0.0))]
    inertial = body.only("inertial")
    # If no geom counts, MuJoCo keeps the <inertial>, also with inertiafromgeom="true".
    if inertial is not None and (rules.inertiafromgeom != "true" or not counted):
        return place(inertial)
    lines = ", ".join(str(geom.line) for geom in counted[:10]) + (", …" if len(counted) > 10 else "")
    return f"{body.file}: geoms of body {quoted(body.attributes.get('name', ''))}, lines {lines}"


def _shape(geoms: list[Element], mass_properties: MassProperties, rules: Settings) -> tuple[Shape | None, str]:
    """Return the shape of a body and its place in the file; None and the reason if there is none."""
    if len(geoms) != 1:
        return None, f"the body has {len(geoms) or 'no'} geoms; a body has one shape"
    (geom,) = geoms
    shape = shape_of(geom)
    if shape is None:
        return None, f"{place(geom)} is no box, ellipsoid, cylinder or sphere of its own size"
    solid = placed(geom, rules)
    if not about_centre(mass_properties.centre, shape, solid.centre, solid.attitude):
        return None, f"{place(geom)} is not about the centre of mass and along the axes of the body"
    return shape, place(geom)
