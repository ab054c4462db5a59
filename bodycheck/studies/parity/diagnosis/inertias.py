"""The mistakes by which the mass, centre of mass or inertia of an engine's body differs from that of its links in the file."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.trajectory import Array

#: `SAME` is the difference, relative to the size, up to which recomputed numbers are those of an engine in double precision,
#: `PART` the part of a small difference to be explained that may remain, and `ROUNDING` the relative rounding of doubles.
SAME, PART, ROUNDING = 1e-7, 1e-2, 1e-14


@dataclass(frozen=True, eq=False)
class Inertial:
    """A mass (kg), a centre of mass (3,) and an inertia (3, 3) about it, in one frame."""

    mass: float
    centre: Array
    tensor: Array


def same(one: Array, other: Array, size: float, near: float = SAME) -> bool:
    """Return whether two arrays are the same up to rounding, which is `near` times `size`."""
    return within(one, other, near * size)


def within(one: Array, other: Array, limit: float) -> bool:
    """Return whether no component of two arrays differs by more than a limit."""
    return bool(np.all(np.abs(one - other) <= limit))


def _limit(engine: Array, truth: Array, near: float) -> float:
    """Return the difference of tensors that counts as rounding: `near` times their size, but no more than a part of the change.

    It is at least the rounding of doubles.
    """
    change = float(np.max(np.abs(engine - truth)))
    return max(min(near * size_of(engine, truth), PART * change), ROUNDING * size_of(engine, truth))


def size_of(*tensors: Array) -> float:
    """Return the largest absolute entry of all tensors."""
    return float(max((np.max(np.abs(tensor)) for tensor in tensors), default=0.0))


def is_dropped(engine: Array, truth: Array, near: float = SAME) -> bool:
    """Return whether the engine's inertia is zero, or has lost the products of inertia of the truth."""
    limit, diagonal = _limit(engine, truth, near), np.diag(np.diag(truth))
    lost = np.any(np.abs(truth - diagonal) > limit) and within(engine, diagonal, limit)
    return bool(lost or (size_of(truth) > 0 and within(engine, np.zeros((3, 3)), limit)))


def is_turned(engine: Array, truth: Array, near: float = SAME) -> bool:
    """Return whether an inertia has the principal moments of the truth along other axes. Negative ones may have become zero."""
    if not (np.all(np.isfinite(engine)) and np.all(np.isfinite(truth))):
        return False
    moments = [np.asarray(np.linalg.eigvalsh(tensor), float) for tensor in (engine, truth)]
    limit = _limit(engine, truth, near)
    alike = any(within(moments[0], option, limit) for option in (moments[1], np.maximum(moments[1], 0.0)))
    return alike and not within(engine, truth, limit)


def is_balanced(engine: Array, truth: Array, near: float = SAME) -> bool:
    """Return whether an engine has replaced an inertia by one that a body can have, or has raised its moments.

    An engine may replace an inertia that no body can have, such as by the mean of its moments or by the inertia of a ball,
    raise the moments of any inertia to some least value, or add the same number to all of its moments.
    """
    if not (np.all(np.isfinite(engine)) and np.all(np.isfinite(truth))):
        return False
    if not _can_be(truth) and _can_be(engine):
        return True
    moments, axes = np.linalg.eigh(truth)
    along, limit = axes.T @ engine @ axes, _limit(engine, truth, near)
    if within(engine, np.mean(moments) * np.eye(3), limit):
        return True
    if not within(along, np.diag(np.diag(along)), limit):
        return False
    diagonal = np.diag(along)
    options = [np.maximum(moments, np.min(diagonal)), moments + (diagonal[0] - moments[0])]
    return any(within(np.sort(diagonal), np.sort(option), limit) for option in options)


def _can_be(inertia: Array) -> bool:
    """Return whether a body can have an inertia, up to rounding."""
    low, middle, high = np.linalg.eigvalsh(inertia)
    return bool(high > 0 and low >= -SAME * high and low + middle >= (1 - SAME) * high)


def steiner(mass: float, centre: Array) -> Array:
    """Return the inertia (3, 3) that a point mass at a place has about the origin."""
    return mass * (float(centre @ centre) * np.eye(3) - np.outer(centre, centre))


@dataclass(frozen=True, eq=False)
class Part:
    """A link that an engine has joined to a body: its inertial in its own frame, and the way to this frame.

    welds: the rotations (3, 3) and positions (3,) of the welds from the body to the link, each in the frame before it.
    """

    name: str
    inertial: Inertial
    welds: tuple[tuple[Array, Array], ...]


def frame(welds: tuple[tuple[Array, Array], ...]) -> tuple[Array, Array]:
    """Return the rotation (3, 3) and the position (3,) of a frame at the end of a chain of welds."""
    turn, origin = np.eye(3), np.zeros(3)
    for rotation, position in welds:
        turn, origin = turn @ rotation, origin + turn @ position
    return turn, origin


def joined(placed: list[Inertial]) -> Inertial:
    """Return the inertial of several inertials together, all in the same frame."""
    mass = math.fsum(inertial.mass for inertial in placed)
    if not mass:
        return Inertial(0.0, np.zeros(3), np.sum([inertial.tensor for inertial in placed], axis=0))
    centre = np.sum([inertial.mass * inertial.centre for inertial in placed], axis=0) / mass
    tensors = [inertial.tensor + steiner(inertial.mass, inertial.centre - centre) for inertial in placed]
    return Inertial(mass, centre, np.sum(tensors, axis=0))


def placed(part: Part) -> Inertial:
    """Return the inertial of a part in the frame of the body."""
    turn, origin = frame(part.welds)
    return Inertial(part.inertial.mass, origin + turn @ part.inertial.centre, turn @ part.inertial.tensor @ turn.T)


def joined_wrongly(parts: tuple[Part, ...]) -> Iterator[Inertial]:
    """Yield the inertials of a body whose parts are joined with a usual mistake in one or all welded parts, or in the sum."""
    right = [placed(part) for part in parts]
    welded = [index for index, part in enumerate(parts) if part.welds]
    for ways in zip(*(_mistaken(parts[index]) for index in welded), strict=False):
        yield joined(
            [*(inertial for index, inertial in enumerate(right) if index not in welded), *(way for way in ways if way)]
        )
    for index in welded:
        others = [inertial for other, inertial in enumerate(right) if other != index]
        for way in _mistaken(parts[index]):
            yield joined([*others, way] if way else others)
    yield from _without_shift(right)


def _mistaken(part: Part) -> Iterator[Inertial | None]:
    """Yield the inertial of a part in the frame of its body with each usual mistake; None if the part is left out."""
    inertial, right = part.inertial, placed(part)
    turn, origin = frame(part.welds)
    yield None
    yield Inertial(right.mass, right.centre, np.zeros((3, 3)))
    yield Inertial(right.mass, right.centre, inertial.tensor)
    yield Inertial(right.mass, origin + inertial.centre, right.tensor)
    yield Inertial(right.mass, origin + inertial.centre, inertial.tensor)
    yield Inertial(right.mass, turn @ inertial.centre, right.tensor)
    yield Inertial(right.mass, origin, right.tensor)
    yield Inertial(right.mass, right.centre, turn.T @ inertial.tensor @ turn)
    yield Inertial(right.mass, origin + turn.T @ inertial.centre, turn.T @ inertial.tensor @ turn)
    for lost in range(len(part.welds)):
        rotation, position = part.welds[lost]
        for weld in ((np.eye(3), position), (rotation, np.zeros(3)), (np.eye(3), np.zeros(3)), (rotation.T, position)):
            yield placed(Part(part.name, inertial, (*part.welds[:lost], weld, *part.welds[lost + 1 :])))


def _without_shift(right: list[Inertial]) -> Iterator[Inertial]:
    """Yield inertials with tensors added without a shift, or with the centre of mass or the tensor of the first part alone."""
    whole, first = joined(right), right[0]
    added = np.sum([inertial.tensor for inertial in right], axis=0)
    yield Inertial(whole.mass, whole.centre, added)
    yield Inertial(whole.mass, first.centre, added)
    yield Inertial(whole.mass, first.centre, first.tensor)
    yield Inertial(whole.mass, whole.centre, first.tensor)
    yield Inertial(whole.mass, first.centre, whole.tensor)
