"""Mass properties of the bodies of an MJCF file, as MuJoCo's compiler computes them from <inertial> or from geoms."""

from collections.abc import Sequence
from dataclasses import replace

from bodycheck.casefile.robots.link import without_rounding
from bodycheck.casefile.robots.mjcf import geoms
from bodycheck.casefile.robots.mjcf.geoms import Shapes
from bodycheck.casefile.robots.mjcf.parts import Part
from bodycheck.casefile.robots.mjcf.settings import Settings, attitude
from bodycheck.casefile.robots.numbers import number, numbers
from bodycheck.casefile.robots.tables import Pose, turned
from bodycheck.reference.exact.inertia import MassProperties, joined
from bodycheck.reference.exact.numbers import MP, Real, vector
from bodycheck.reference.exact.rotations import IDENTITY, ORIGIN, plus
from bodycheck.robots.elements import Element, refuse
from bodycheck.robots.orientations import principal_axes, turned_inertia

#: The largest mass (kg) that MuJoCo ignores in the sum of the geoms of a body.
NO_MASS = 1e-14


def inertia_of(body: Element, parts: Sequence[Part], rules: Settings, shapes: Shapes) -> MassProperties | None:
    """Return the mass properties of a body in its frame; None if it has neither mass nor moments of inertia.

    Parameters
    ----------
    body
        The body.
    parts
        Its elements.
    rules
        The settings of the file.
    shapes
        The meshes and height fields of the file.

    Raises
    ------
    BadInput
        If they cannot be read exactly.
    """
    inertials = [part for part in parts if part.element.tag == "inertial"]
    if len(inertials) > 1:
        refuse(inertials[1].element, None, "a second <inertial> of one <body>; allowed: one")
    geoms_count = rules.inertiafromgeom == "true" or (rules.inertiafromgeom == "auto" and not inertials)
    mass_properties = _of_geoms(parts, rules, shapes) if geoms_count else None
    if inertials and mass_properties is None:
        mass_properties = within(stated(inertials[0].element, rules), inertials[0].frame)
    if mass_properties is not None:
        return _bounded(mass_properties, rules)
    if not (rules.boundmass > 0 or rules.boundinertia > 0):
        return None
    # MuJoCo places the bound of a body without mass at the position of the body in its parent, in the body's own frame.
    nothing = MassProperties(MP.mpf(0), vector(numbers(body, "pos", (3,), (0.0, 0.0, 0.0))), (MP.mpf(0),) * 6)
    return _bounded(nothing, rules)


def stated(inertial: Element, rules: Settings) -> MassProperties:
    """Return the mass properties that an <inertial> states; moments that it does not state are zero."""
    mass, centre = number(inertial, "mass"), vector(numbers(inertial, "pos", (3,)))
    if mass < 0:
        refuse(inertial, "mass", f"read {mass!r}; allowed: at least 0")
    turn = attitude(inertial, rules)
    if "fullinertia" not in inertial.attributes:
        components = (*numbers(inertial, "diaginertia", (3,), (0.0, 0.0, 0.0)), 0.0, 0.0, 0.0)
        return MassProperties(MP.mpf(mass), centre, turned_inertia(components, turn))
    if "diaginertia" in inertial.attributes:
        refuse(inertial, "diaginertia", "fullinertia is given too; allowed: one of them")
    if turn != IDENTITY:
        refuse(inertial, "fullinertia", "an attitude is given too, which MuJoCo refuses")
    return MassProperties(MP.mpf(mass), centre, turned_inertia(numbers(inertial, "fullinertia", (6,)), turn))


def scaled(mass_properties: MassProperties, factor: Real) -> MassProperties:
    """Return mass properties with mass and moments multiplied by a factor."""
    xx, yy, zz, xy, xz, yz = (factor * part for part in mass_properties.tensor)
    return replace(mass_properties, mass=factor * mass_properties.mass, tensor=(xx, yy, zz, xy, xz, yz))


def principal_frame(parts: Sequence[Part], mass_properties: MassProperties, rules: Settings) -> Pose:
    """Return the frame of a body along its principal axes of inertia: as its <inertial> states it, or the largest moment first.

    Axes that the file does not state may differ from those of MuJoCo in their signs, and where moments are equal.
    """
    stated_axes = [
        part.frame.then(Pose(ORIGIN, attitude(part.element, rules)))
        for part in parts
        if part.element.tag == "inertial" and "diaginertia" in part.element.attributes and rules.inertiafromgeom != "true"
    ]
    if stated_axes:
        return Pose(mass_properties.centre, stated_axes[0].turn)
    return Pose(mass_properties.centre, principal_axes(mass_properties.tensor)[1])


def within(inner: MassProperties, pose: Pose) -> MassProperties:
    """Return mass properties of a frame in the frame around it. pose: of the inner frame."""
    centre = plus(pose.origin, turned(pose.turn, inner.centre))
    return MassProperties(inner.mass, centre, turned_inertia(inner.tensor, pose.turn))


def _of_geoms(parts: Sequence[Part], rules: Settings, shapes: Shapes) -> MassProperties | None:
    """Return the total mass properties of the geoms of a body that count; None if none of them has a mass."""
    solids = [
        within(solid, part.frame)
        for part in parts
        if part.element.tag == "geom"
        and rules.counts(number(part.element, "group", 0.0))
        and (solid := geoms.mass_properties(part.element, rules, shapes)) is not None
        and solid.mass > NO_MASS
    ]
    return joined(solids) if solids else None


def _bounded(mass_properties: MassProperties, rules: Settings) -> MassProperties:
    """Return mass properties within the bounds of the file, and balanced if no body has them and the file says so."""
    mass = max(mass_properties.mass, MP.mpf(rules.boundmass))
    if not (rules.boundinertia > 0 or rules.balanceinertia):
        return without_rounding(replace(mass_properties, mass=mass))
    moments, turn = principal_axes(mass_properties.tensor)
    bounded = tuple(max(moment, MP.mpf(rules.boundinertia)) for moment in moments)
    if rules.balanceinertia and 2 * max(bounded) > sum(bounded):
        bounded = (sum(bounded) / 3,) * 3
    if bounded == moments:
        return without_rounding(replace(mass_properties, mass=mass))
    return without_rounding(MassProperties(mass, mass_properties.centre, turned_inertia((*bounded, 0.0, 0.0, 0.0), turn)))
