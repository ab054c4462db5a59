"""Joints as they move in an engine, in place of what the engine's records tell of them, and the source of each row's value."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from bodycheck.adapters.robot_reading import Behaviour, ReadJoint, RobotReading
from bodycheck.studies.parity.quantities import MODEL, TERMS, Source
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.tree import limits_and_rule


def as_moving(reading: RobotReading) -> RobotReading:
    """Return a reading whose joints have the limits, rules, damping and friction by which they move, as far as tried."""
    return replace(reading, joints=tuple(_as_moving(joint, reading) for joint in reading.joints))


def _as_moving(joint: ReadJoint, reading: RobotReading) -> ReadJoint:
    behaviour = reading.behaviours.get(joint.name, Behaviour())
    if "limits" in behaviour.tried:
        joint = replace(joint, lower=behaviour.lower, upper=behaviour.upper)
    if "mimic" in behaviour.tried:
        joint = replace(joint, mimic=behaviour.mimic)
    if "damping" in behaviour.tried:
        joint = replace(joint, damping=behaviour.damping)
    return replace(joint, friction=behaviour.friction) if "friction" in behaviour.tried else joint


def with_sources(rows: Iterable[Compared], compared: Sequence[Compared], reading: RobotReading) -> Iterator[Compared]:
    """Yield rows with the sources of the engine's values, and with what the engine tells and does not do.

    Parameters
    ----------
    rows
        The rows after the diagnosis.
    compared
        The rows before the diagnosis. The values of all other rows follow from terms that the engine computes.
    reading
        The engine's reading, with what the engine tells.
    """
    told = {(row.quantity, row.subject) for row in compared}
    moving = {joint.name: joint for joint in as_moving(reading).joints}
    joints = {joint.name: joint for joint in reading.joints}
    for row in rows:
        if row.status == "not-modelled":
            yield row
        elif row.quantity in TERMS or (row.quantity, row.subject) not in told:
            yield replace(row, source="behaviour")
        elif row.subject == MODEL or row.subject not in joints:
            yield replace(row, source="told")
        else:
            behaviour = reading.behaviours.get(row.subject, Behaviour())
            yield _of_joint(row, joints[row.subject], moving[row.subject], behaviour)


def _of_joint(row: Compared, joint: ReadJoint, moving: ReadJoint, behaviour: Behaviour) -> Compared:
    """Return the row of a joint with its source. joint: as the engine tells it. moving: as it moves."""
    source: Source = "told"
    value = row.engine_value
    if row.quantity == "joint_type":
        claims = {"limits": joint.lower is not None or joint.upper is not None, "mimic": joint.mimic is not None}
        if behaviour.tried & claims.keys() and all(part in behaviour.tried for part, told in claims.items() if told):
            source = "behaviour"
        if (words := limits_and_rule(joint)) != limits_and_rule(moving):
            source = "behaviour"
            value = f"{value}; not enforced, but told: {words}"
    elif row.quantity in ("damping", "friction") and row.quantity in behaviour.tried:
        source, told = "behaviour", getattr(joint, row.quantity)
        if told != getattr(moving, row.quantity):
            value = f"{value}; not enforced, but told: {told!r}"
    return replace(row, engine_value=value, source=source)
