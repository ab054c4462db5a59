"""Compare the numbers that an engine reports of its bodies and joints with the numbers of the file."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from bodycheck.adapters.robot_numbers import components
from bodycheck.adapters.robot_reading import Components, ReadBody, ReadJoint, RobotReading
from bodycheck.reference.robots.model import RobotJoint, RobotLink, RobotModel, Wide
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.matching import Match
from bodycheck.studies.parity.quantities import MODEL, Quantity, Status
from bodycheck.studies.parity.rows import Compared

#: The part of the mass times its squared distance from the link's origin that is added to the size of an inertia: an engine may
#: keep the tensor about the origin, with rounding errors of this size.
OFFSET_PART = 1e-5

#: The size from which on a limit counts as no limit.
NO_LIMIT = 1e9


def tensor(numbers: Components | Array) -> Array:
    """Return the tensor (3, 3) of components xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = numbers
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def text(numbers: Sequence[float] | Array | Wide) -> str:
    """Return numbers as text, with all their digits."""
    return " ".join(repr(float(number)) for number in numbers)


def bodies(match: Match, reading: RobotReading, length: float, tolerance: float) -> Iterator[Compared]:
    """Yield rows for the mass, the centre of mass and the inertia of each body, also of those that the engine does not report.

    A link that the engine knows and has joined to another one is compared as a part of that one. length: the reach of the robot
    (m), to which differences of centres of mass are relative.
    """
    bodies_read = {body.name: body for body in reading.bodies}
    for link in match.bodies.links:
        body = bodies_read.get(link.name, ReadBody(link.name, None))
        # The mass of a root that is welded to the world has no effect, and many engines have no mass or another mass there.
        if link is not match.bodies.links[match.bodies.root] or (link.mass and body.mass):
            yield from _body(link, body, length, tolerance)
        elif link.mass:
            yield Compared("not-modelled", "mass", link.name, "", text([float(link.mass)]))
    known = {*reading.links, *bodies_read, *(link.name for link in match.bodies.links)}
    for link in match.model.links:
        if link.name not in known:
            yield Compared("not-modelled", "mass", link.name, "", text([float(link.mass)]))


def _body(link: RobotLink, body: ReadBody, length: float, tolerance: float) -> Iterator[Compared]:
    massless = not link.mass and not body.mass
    if body.mass is not None:
        yield scalar("mass", link.name, body.mass, float(link.mass), tolerance)
    else:
        yield Compared("not-modelled", "mass", link.name, "", text([float(link.mass)]))
    if body.center_of_mass is not None and not massless:
        yield vector("center_of_mass", link.name, body.center_of_mass, link.center_of_mass, length, tolerance)
    elif not massless:
        yield Compared("not-modelled", "center_of_mass", link.name, "", text(link.center_of_mass))
    expected = components(link.inertia)
    if body.inertia is None and any(expected):
        yield Compared("not-modelled", "inertia", link.name, "", text(expected))
    elif body.inertia is not None:
        offset = OFFSET_PART * abs(float(link.mass)) * float(np.sum(np.asarray(link.center_of_mass, np.float64) ** 2))
        size = max((abs(number) for number in (*expected, *body.inertia) if math.isfinite(number)), default=0.0)
        yield vector("inertia", link.name, body.inertia, expected, size + offset, tolerance)


def total_mass(match: Match, reading: RobotReading, tolerance: float) -> Iterator[Compared]:
    """Yield the row of the total mass of all bodies.

    An engine's total may lack a base that is welded to the world, which is no difference. If the rest differs too, a second
    row compares the total without the base. A mass that an engine gives to a base without mass in the file does not count.
    """
    known = {link.name for link in match.bodies.links}
    links, root = match.bodies.links, match.bodies.links[match.bodies.root]
    masses = [
        body.mass
        for body in reading.bodies
        if body.mass is not None and body.name in known and (root.mass or body.name != root.name)
    ]
    everything = math.fsum(float(link.mass) for link in links)
    if not masses:
        if everything:
            yield Compared("not-modelled", "total_mass", MODEL, "", text([everything]))
        return
    if not root.mass or _tells_mass(reading, root.name):
        yield scalar("total_mass", MODEL, math.fsum(masses), everything, tolerance)
        return
    missing = scalar("total_mass", MODEL, math.fsum(masses), everything, tolerance)
    yield Compared(
        "agrees", "total_mass", MODEL, missing.engine_value, missing.truth_value, missing.difference, cause="base-welded"
    )
    rest = scalar(
        "total_mass", MODEL, math.fsum(masses), math.fsum(float(link.mass) for link in links if link is not root), tolerance
    )
    if rest.status == "differs":
        yield rest


def _tells_mass(reading: RobotReading, name: str) -> bool:
    return any(body.name == name and body.mass for body in reading.bodies)


def joints(match: Match, model: RobotModel, tolerance: float) -> Iterator[Compared]:
    """Yield rows for the numbers of the joints that the engine has."""
    file_joints = {joint.name: joint for joint in model.joints}
    for name, joint_read in match.joints.items():
        yield from _joint(file_joints[name], joint_read, tolerance)


def _joint(joint: RobotJoint, joint_read: ReadJoint, tolerance: float) -> Iterator[Compared]:
    if joint.type in ("revolute", "prismatic", "planar") and joint_read.axis is not None:
        yield vector("axis", joint.name, joint_read.axis, joint.axis, 1.0, tolerance)
    for quantity in ("armature", "damping", "friction", "stiffness"):
        expected, value = float(getattr(joint, quantity)), getattr(joint_read, quantity)
        if value is not None:
            yield scalar(quantity, joint.name, value, expected, tolerance)
        elif expected:
            yield Compared("not-modelled", quantity, joint.name, "", text([expected]))
    limit, read = (none_if_unlimited(value) for value in (joint.effort_limit, joint_read.effort_limit))
    if limit is None and not read:  # an engine may report 0 for no limit
        return
    if limit is not None and joint_read.effort_limit is None:
        yield Compared("not-modelled", "effort_limit", joint.name, "", text([limit]))
    elif limit is not None and read is not None:
        yield scalar("effort_limit", joint.name, read, limit, tolerance)
    elif limit is not None or read is not None:
        engine, file = ("none" if value is None else text([value]) for value in (read, limit))
        yield Compared("differs", "effort_limit", joint.name, engine, file)


def none_if_unlimited(limit: float | None) -> float | None:
    """Return a limit, or None if it is so large that it counts as no limit."""
    return None if limit is None or not abs(limit) < NO_LIMIT else limit


def scalar(quantity: Quantity, subject: str, engine: float, truth: float, tolerance: float) -> Compared:
    """Return the row that compares one number of both sides, with a difference relative to the larger number."""
    return vector(quantity, subject, [engine], [truth], max(abs(engine), abs(truth)), tolerance)


def vector(
    quantity: Quantity,
    subject: str,
    engine: Sequence[float] | Array,
    truth: Sequence[float] | Wide,
    size: float,
    tolerance: float,
) -> Compared:
    """Return the row that compares numbers of both sides, with a difference relative to `size`. NaN on both sides agrees."""
    ours, theirs = np.asarray(truth, np.float64), np.asarray(engine, np.float64)
    same = (ours == theirs) | (np.isnan(ours) & np.isnan(theirs))
    gaps = np.where(same, 0.0, np.abs(np.where(same, 0.0, theirs) - np.where(same, 0.0, ours)))
    difference = float(np.max(np.where(np.isnan(gaps), np.inf, gaps), initial=0.0))
    relative = 0.0 if not difference else difference / size if size > 0 and math.isfinite(size) else math.inf
    status: Status = "agrees" if relative <= tolerance else "differs"
    return Compared(status, quantity, subject, text(theirs), text(ours), difference, relative)
