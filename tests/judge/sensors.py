"""The readings of sensors of trees, from the text of their case file on.

Accelerations are the derivatives of the power series of `maximal`. A wrench is the sum, over a body and all bodies that hang on
it, of mass times specific force, and of the rates of angular momentum, about the origin of the body's frame.
"""

import tomllib
from collections.abc import Sequence
from decimal import Decimal
from typing import Any

from tests.judge.maximal import ORIGIN, Frame, Part, frames_of, reached
from tests.judge.numerals import ZERO, Vector, applied, attitude, cross, exact, minus, plus, times, transposed

#: The components of readings.
Reading = tuple[Decimal, ...]


def readings(text: str, instants: Sequence[Decimal]) -> dict[str, list[Reading]]:
    """Return the readings of each sensor of a case file, by name, at ascending instants (s) >= 0."""
    document = tomllib.loads(text)
    parts, gravity, sampled = reached(text, instants)
    states = [
        ([frame for frame, _ in frames_of(parts, each.numbers)], [frame for frame, _ in frames_of(parts, each.rates)])
        for each in sampled
    ]
    joints = {table["name"]: table for table in document.get("joints", [])}
    return {
        table["name"]: [_reading(table, parts, joints, gravity, own, rates) for own, rates in states]
        for table in document["sensors"]
    }


def _reading(
    table: dict[str, Any],
    parts: Sequence[Part],
    joints: dict[str, dict[str, Any]],
    gravity: Decimal,
    own: Sequence[Frame],
    rates: Sequence[Frame],
) -> Reading:
    if table["type"] == "joint_effort":
        return (exact(joints[table["joint"]].get("effort", 0)),)
    name = joints[table["joint"]]["child"] if "joint" in table else table["body"]
    index = next(k for k, part in enumerate(parts) if part.name == name)
    part, frame, rate = parts[index], own[index], rates[index]
    if table["type"] == "force_torque":
        force, moment = _wrench(index, parts, gravity, own, rates)
        return tuple(
            each
            for vector in (force, moment)
            for each in applied(transposed(part.axes), applied(transposed(frame.turn), vector))
        )
    place = applied(part.axes, exact(table.get("position", (0, 0, 0))))
    match table["type"]:
        case "accelerometer":
            seen = applied(transposed(frame.turn), _specific_force(frame, rate, place, gravity))
        case "velocimeter":
            seen = plus(applied(transposed(frame.turn), frame.velocity), cross(frame.spin, place))
        case _:
            seen = frame.spin
    return applied(transposed(attitude(table)), applied(transposed(part.axes), seen))


def _specific_force(frame: Frame, rate: Frame, place: Vector, gravity: Decimal) -> Vector:
    """Return the acceleration of a place of a body (in its frame) minus that of free fall, in the world."""
    swing = plus(cross(rate.spin, place), cross(frame.spin, cross(frame.spin, place)))
    return plus(plus(rate.velocity, applied(frame.turn, swing)), (ZERO, ZERO, gravity))


def _wrench(
    index: int, parts: Sequence[Part], gravity: Decimal, own: Sequence[Frame], rates: Sequence[Frame]
) -> tuple[Vector, Vector]:
    """Return the force and the moment about its origin that a body is held with, in the world."""
    beyond = [index]
    for k, part in enumerate(parts):  # parents come first
        if part.parent in beyond:
            beyond.append(k)
    force, moment = ORIGIN, ORIGIN
    for k in beyond:
        inertia, frame, rate = parts[k].inertia, own[k], rates[k]
        pushed = times(inertia.mass, _specific_force(frame, rate, inertia.centre, gravity))
        spun = plus(applied(inertia.tensor, rate.spin), cross(frame.spin, applied(inertia.tensor, frame.spin)))
        arm = minus(plus(frame.position, applied(frame.turn, inertia.centre)), own[index].position)
        force, moment = plus(force, pushed), plus(moment, plus(cross(arm, pushed), applied(frame.turn, spun)))
    return force, moment
