"""The causes of differences in the masses, centres of mass and inertias that an engine reports."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from bodycheck.adapters.robot_reading import ReadBody
from bodycheck.reference.robots.model import RobotLink, RobotModel
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.comparing import Comparison
from bodycheck.studies.parity.diagnosis.fault import Fault
from bodycheck.studies.parity.diagnosis.inertias import (
    SAME,
    Inertial,
    Part,
    frame,
    is_balanced,
    is_dropped,
    is_turned,
    joined_wrongly,
    placed,
    same,
    size_of,
    steiner,
)
from bodycheck.studies.parity.diagnosis.inertias import joined as joined_inertials
from bodycheck.studies.parity.numbers import tensor
from bodycheck.studies.parity.quantities import Cause, Quantity
from bodycheck.studies.parity.rows import Compared

#: The difference of traces, relative to the tensors, up to which it is rounding. It is small as a trace is a single number.
TRACE = 1e-11

#: The quantities of a body, which are attributes of links.
OF_BODIES: tuple[Quantity, ...] = ("mass", "center_of_mass", "inertia")


def faults(comparison: Comparison) -> Iterator[Fault]:
    """Yield a fault for each number of a body that differs from the file."""
    bodies_read = {body.name: body for body in comparison.reading.bodies}
    for link in comparison.match.bodies.links:
        rows = {row.quantity: row for row in comparison.rows if row.subject == link.name and row.quantity in OF_BODIES}
        wrong = [quantity for quantity, row in rows.items() if row.status == "differs" and quantity is not None]
        if wrong:
            yield from of_body(
                comparison.match.model, link, bodies_read[link.name], wrong, set(bodies_read), max(SAME, comparison.tolerance)
            )


def of_body(
    model: RobotModel, link: RobotLink, body: ReadBody, wrong: list[Quantity], kept: set[str], near: float
) -> Iterator[Fault]:
    """Yield the faults of a body.

    Parameters
    ----------
    model
        The model of the file.
    link
        The body as the file has it, with all links that the engine has joined to it.
    body
        The body as the engine has it.
    wrong
        The quantities of the body that differ.
    kept
        The names of the bodies that the engine keeps.
    near
        The relative difference up to which numbers are the same in the engine's precision.
    """
    truth, engine = inertial(link), _read(body, link)
    values, joined = attributes(engine), parts(model, link.name, kept)
    fused = len(joined) > 1 and _is_joined_wrongly(engine, truth, joined, body, near)
    filled = not fused and _is_filled(engine, truth, joined, near)
    turned = None if fused or filled else _turned_part(engine, truth, joined, near)
    for quantity in wrong:
        cause: Cause = "inertia-fused" if fused else "mass" if filled else _cause(quantity, engine, truth, wrong, near)
        row = None
        if turned is not None and quantity == "inertia" and not fused:
            cause = "inertia-turned"
            if turned != link.name:
                row = Compared("differs", "inertia", turned, cause=cause)
        yield Fault(cause, quantity, link.name, link={quantity: values[quantity]}, row=row)


def parts(model: RobotModel, body: str, kept: set[str]) -> tuple[Part, ...]:
    """Return the links of the file that form a body of the engine, the link with the name of the body first.

    kept: the names of the bodies that the engine keeps.
    """
    names = [link.name for link in model.links]
    joined: list[Part] = []
    waiting: list[tuple[int, tuple[tuple[np.ndarray, np.ndarray], ...]]] = [(names.index(body), ())]
    while waiting:
        index, welds = waiting.pop(0)
        joined.append(Part(names[index], inertial(model.links[index]), welds))
        for joint in model.joints:
            if joint.parent == index and joint.type == "fixed" and names[joint.child] not in kept:
                weld = (np.asarray(joint.rotation, np.float64), np.asarray(joint.position, np.float64))
                waiting.append((joint.child, (*welds, weld)))
    return tuple(joined)


def _cause(quantity: Quantity, engine: Inertial, truth: Inertial, wrong: list[Quantity], near: float) -> Cause:
    if engine.mass and not truth.mass:  # the engine adds a mass, such as that of the shape
        return "mass"
    nothing = not engine.mass and not np.any(engine.tensor)
    if nothing and truth.mass and np.any(truth.tensor):
        return "inertia-dropped"
    if quantity == "mass":
        return "mass"
    if quantity == "center_of_mass":
        return "center-of-mass"
    return inertia_cause(engine, truth, "mass" in wrong, "center_of_mass" in wrong, near)


def inertia_cause(engine: Inertial, truth: Inertial, mass_differs: bool, centre_differs: bool, near: float = SAME) -> Cause:
    """Return the cause of a difference in the inertia of a body that is one link or whose links are joined correctly.

    near: the relative difference up to which numbers are the same.
    """
    scaled = [truth.tensor]
    if mass_differs and truth.mass:
        scaled.append(truth.tensor * (engine.mass / truth.mass))
        if same(engine.tensor, scaled[1], size_of(engine.tensor, scaled[1]), near):
            return "mass"
    for expected in scaled:
        if is_dropped(engine.tensor, expected, near):
            return "inertia-dropped"
        if is_turned(engine.tensor, expected, near):
            return "inertia-turned"
        if is_balanced(engine.tensor, expected, near):
            return "inertia-balanced"
    size = size_of(engine.tensor, truth.tensor)
    for mass in {engine.mass, truth.mass}:
        for shift in (steiner(mass, truth.centre), steiner(mass, engine.centre), steiner(mass, engine.centre - truth.centre)):
            for sign in (1, -1):
                if same(engine.tensor, truth.tensor + sign * shift, size, near):
                    return "center-of-mass" if centre_differs else "frame"
    return "unexplained"


def _is_joined_wrongly(engine: Inertial, truth: Inertial, joined: tuple[Part, ...], body: ReadBody, near: float) -> bool:
    """Return whether a body has the numbers that follow from joining its links with a usual mistake.

    Numbers that the engine does not report count as fitting. The tensors of the links may also be rotated, which leaves the
    trace of their sum unchanged.
    """
    reach = max(
        float(np.linalg.norm(part.inertial.centre)) + sum(float(np.linalg.norm(at)) for _, at in part.welds) for part in joined
    )
    for wrong in joined_wrongly(joined):
        size = size_of(wrong.tensor, engine.tensor)
        if (
            (body.mass is None or abs(wrong.mass - engine.mass) <= near * abs(engine.mass))
            and (body.center_of_mass is None or same(wrong.centre, engine.centre, reach, near))
            and (
                body.inertia is None
                or same(wrong.tensor, engine.tensor, size, near)
                or (_same_trace(wrong, engine) and not same(wrong.centre, truth.centre, reach, near))
            )
        ):
            return True
    return _is_moved_and_turned(engine, truth, joined, reach, near)


def _is_moved_and_turned(engine: Inertial, truth: Inertial, joined: tuple[Part, ...], reach: float, near: float) -> bool:
    """Return whether a body consists of its links with one link at a wrong place, and with tensors or this place rotated.

    The wrong place follows from the centre of mass of the body, and the trace of the body's tensor confirms it. If a link is
    misplaced in any other way and its tensor is unchanged, the result is False: its centre of mass differs.
    """
    if same(engine.centre, truth.centre, reach, near) or abs(engine.mass - truth.mass) > near * truth.mass:
        return False
    right = [placed(part) for part in joined]
    for index, part in enumerate(right[1:], start=1):
        if part.mass:
            others = np.sum([other.mass * other.centre for other in right if other is not part], axis=0)
            moved = Inertial(part.mass, (engine.mass * engine.centre - others) / part.mass, part.tensor)
            whole = joined_inertials([*right[:index], moved, *right[index + 1 :]])
            turned = not same(whole.tensor, engine.tensor, size_of(whole.tensor), near)
            if _same_trace(whole, engine) and (turned or _is_turned_place(joined[index], moved.centre, near * reach)):
                return True
    return False


def _is_turned_place(part: Part, centre: Array, limit: float) -> bool:
    """Return whether the centre of mass of a link, or the origin of its weld, is rotated about the origin of its body.

    centre: the centre of mass (3,) of the link in the engine, in the frame of the body. limit: the rounding (m).
    """
    right, (_, weld) = placed(part).centre, frame(part.welds)
    turned = ((right, centre), (weld, centre - right + weld))
    return any(abs(np.linalg.norm(one) - np.linalg.norm(other)) <= limit for one, other in turned)


def _is_filled(engine: Inertial, truth: Inertial, joined: tuple[Part, ...], near: float) -> bool:
    """Return whether an engine has given mass to links that have none in the file, such as the mass of their shapes.

    The excess of mass and inertia is then that of a possible body.
    """
    mass = engine.mass - truth.mass
    if mass <= near * engine.mass or all(part.inertial.mass for part in joined):
        return False
    centre = (engine.mass * engine.centre - truth.mass * truth.centre) / mass
    about = [side.tensor + steiner(side.mass, side.centre) for side in (engine, truth)]
    low, middle, high = np.linalg.eigvalsh(about[0] - about[1] - steiner(mass, centre))
    return bool(low >= -near * high and low + middle >= (1 - near) * high)


def _turned_part(engine: Inertial, truth: Inertial, joined: tuple[Part, ...], near: float) -> str | None:
    """Return the name of the link whose tensor, rotated, explains the inertia of the engine's body; None if there is none.

    If several links are rotated, which leaves the trace of the sum of their tensors unchanged, it is the name of the body.
    """
    if not same(engine.centre, truth.centre, max(1.0, size_of(truth.centre)), near):
        return None
    size = size_of(engine.tensor, truth.tensor)
    for part in joined:
        ours = placed(part).tensor
        theirs = ours + engine.tensor - truth.tensor
        if not same(theirs, ours, size, near) and is_turned(theirs, ours, near) and size_of(ours) > near * size:
            return part.name
    return joined[0].name if len(joined) > 1 and _same_trace(engine, truth) else None


def _same_trace(one: Inertial, other: Inertial) -> bool:
    """Return whether the traces of two tensors are the same, up to rounding."""
    return bool(abs(np.trace(one.tensor) - np.trace(other.tensor)) <= TRACE * size_of(one.tensor, other.tensor))


def inertial(link: RobotLink) -> Inertial:
    """Return the mass, the centre of mass and the inertia of a link in double precision."""
    return Inertial(float(link.mass), np.asarray(link.center_of_mass, np.float64), np.asarray(link.inertia, np.float64))


def _read(body: ReadBody, link: RobotLink) -> Inertial:
    """Return the numbers of an engine, with the file's numbers where the engine reports none."""
    truth = inertial(link)
    return Inertial(
        truth.mass if body.mass is None else body.mass,
        truth.centre if body.center_of_mass is None else np.array(body.center_of_mass),
        truth.tensor if body.inertia is None else tensor(body.inertia),
    )


def attributes(body: Inertial) -> dict[str, Any]:
    """Return the numbers of a body as attributes of a link, by the names of the quantities."""
    centre, tensor_ = (np.asarray(part, np.longdouble) for part in (body.centre, body.tensor))
    return {"mass": body.mass, "center_of_mass": centre, "inertia": tensor_}
