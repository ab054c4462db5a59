"""Read one body of an MJCF file as MuJoCo's compiler does: its <inertial>, or the inertia of its geoms.

Settings that could change the meaning of a number are followed (angle, eulerseq, inertiafromgeom, inertiagrouprange, default
classes) or refused with the reason.
"""

from collections.abc import Iterator

from bodycheck.casefile.robots import mjcf_geoms
from bodycheck.casefile.robots.link import Link, about_centre, chosen, left_out, without_rounding
from bodycheck.casefile.robots.mjcf_settings import Defaults, Settings, attitude, settings
from bodycheck.casefile.robots.numbers import number, numbers, positive
from bodycheck.reference.exact.inertia import MassProperties, joined
from bodycheck.reference.exact.numbers import MP, vector
from bodycheck.reference.exact.rotations import IDENTITY
from bodycheck.reference.scene import Shape
from bodycheck.robots.elements import Element, place, quoted, refuse
from bodycheck.robots.orientations import turned_inertia

#: Elements of a file that stand for other elements, which are not read here.
WRITERS = ("replicate", "composite", "flexcomp")


def link(root: Element, name: str | None) -> Link:
    """Return a body of an MJCF file; the only one if the name is None. Raises `BadInput` if it cannot be read exactly."""
    classes: dict[Element, str | None] = {}
    for world in root.all("worldbody"):
        classes |= dict(_bodies(world, None))
    refuse_includes(root)
    body = chosen(root, list(classes), name, "body")
    refuse_what_is_not_followed(body)
    rules, defaults = settings(root), Defaults(root, "geom")
    geoms = [defaults.resolved(geom, classes[body]) for geom in body.all("geom")]
    mass_properties, inertia_from = _inertia(body, geoms, rules)
    shape, shape_from = _shape(geoms, mass_properties, rules)
    return Link(body.attributes.get("name", ""), mass_properties, inertia_from, shape, shape_from, left_out(len(classes) - 1))


def refuse_includes(root: Element) -> None:
    """Raise `BadInput` for an <include> at any place: the included file may change every number."""
    for element in root.everything():
        if element.tag == "include":
            refuse(element, "file", "names another file, which is not opened; put its content in its place")


def refuse_what_is_not_followed(body: Element) -> None:
    """Raise `BadInput` for elements of a body that may change its mass or frame; bodies inside it are not checked."""
    for element in _own(body):
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


def inertia_of(body: Element, inherited: str | None, rules: Settings, defaults: Defaults) -> MassProperties | None:
    """Return the mass properties of a body in its frame; None if it has no mass.

    Parameters
    ----------
    body
        The body.
    inherited
        The default class of its geoms.
    rules, defaults
        The settings of the file, and its default classes of geoms.
    """
    geoms = [defaults.resolved(geom, inherited) for geom in body.all("geom")]
    if body.only("inertial") is None and not any(
        rules.counts(number(geom, "group", 0.0)) and mjcf_geoms.mass_properties(geom, rules) is not None for geom in geoms
    ):
        return None
    return _inertia(body, geoms, rules)[0]


def _inertia(body: Element, geoms: list[Element], rules: Settings) -> tuple[MassProperties, str]:
    """Return the mass properties of a body with some geoms, and a phrase for their place in the file."""
    inertial = body.only("inertial")
    counted = [geom for geom in geoms if rules.counts(number(geom, "group", 0.0))]
    # If no geom counts, MuJoCo keeps the <inertial>, also with inertiafromgeom="true".
    if inertial is not None and (rules.inertiafromgeom != "true" or not counted):
        mass_properties, inertia_from = _stated(inertial, rules), place(inertial)
    else:
        mass_properties, inertia_from = _of_geoms(body, counted, rules)
    return without_rounding(mass_properties), inertia_from


def _bodies(parent: Element, inherited: str | None) -> Iterator[tuple[Element, str | None]]:
    """Yield all bodies below an element, each with the name of the default class of its geoms."""
    left = [(parent, inherited)]
    while left:
        element, name = left.pop()
        name = element.attributes.get("childclass", name)
        if element.tag == "body":
            yield element, name
        left += [(child, name) for child in reversed(element.children) if child.tag in ("body", "frame")]


def _own(body: Element) -> Iterator[Element]:
    """Yield the elements of a body, also those inside its frames, but not the elements of bodies inside it."""
    left = list(reversed(body.children))
    while left:
        element = left.pop()
        yield element
        if element.tag == "frame":
            left += reversed(element.children)


def _stated(inertial: Element, rules: Settings) -> MassProperties:
    """Return the mass properties that an <inertial> states."""
    mass, centre = positive(inertial, "mass"), vector(numbers(inertial, "pos", (3,)))
    full, diagonal = "fullinertia" in inertial.attributes, "diaginertia" in inertial.attributes
    turn = attitude(inertial, rules)
    if full == diagonal:
        refuse(
            inertial,
            None,
            f"has {'both' if full else 'neither'} diaginertia {'and' if full else 'nor'} fullinertia; allowed: one of them",
        )
    if full:
        if turn != IDENTITY:
            refuse(inertial, "fullinertia", "an attitude is given too, which MuJoCo refuses")
        components = numbers(inertial, "fullinertia", (6,))
    else:
        components = (*numbers(inertial, "diaginertia", (3,)), 0.0, 0.0, 0.0)
    return MassProperties(MP.mpf(mass), centre, turned_inertia(components, turn))


def _of_geoms(body: Element, counted: list[Element], rules: Settings) -> tuple[MassProperties, str]:
    """Return the total mass properties of the geoms that count in a body, and a phrase for their place in the file."""
    if rules.inertiafromgeom == "false":
        refuse(body, None, 'has no <inertial>, and the compiler does not take the inertia from geoms (inertiafromgeom="false")')
    solids = [solid for geom in counted if (solid := mjcf_geoms.mass_properties(geom, rules)) is not None]
    if not solids:
        refuse(body, None, "has no <inertial> and no geom with a mass; a body without mass cannot move by itself")
    lines = ", ".join(str(geom.line) for geom in counted[:10]) + (", …" if len(counted) > 10 else "")
    return joined(solids), f"{body.file}: geoms of body {quoted(body.attributes.get('name', ''))}, lines {lines}"


def _shape(geoms: list[Element], mass_properties: MassProperties, rules: Settings) -> tuple[Shape | None, str]:
    """Return the shape of a body and its place in the file; None and the reason if there is none."""
    if len(geoms) != 1:
        return None, f"the body has {len(geoms) or 'no'} geoms; a body has one shape"
    (geom,) = geoms
    shape = mjcf_geoms.shape(geom)
    if shape is None:
        return None, f"{place(geom)} is no box, ellipsoid, cylinder or sphere of its own size"
    solid = mjcf_geoms.placed(geom, rules)
    if not about_centre(mass_properties.centre, shape, solid.centre, solid.attitude):
        return None, f"{place(geom)} is not about the centre of mass and along the axes of the body"
    return shape, place(geom)
