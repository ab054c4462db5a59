"""Check the rules between keys of sensors, and build the sensors of a case."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bodycheck.casefile.contradictions import start_faults
from bodycheck.casefile.expectation import SENSORS, Limit
from bodycheck.casefile.raw_values import mapping, tables_of
from bodycheck.casefile.scenes import attitude_of
from bodycheck.casefile.sensors.grammar import MountedTable, OfBodyTable, OfJointTable, SensorTable, type_of
from bodycheck.casefile.surroundings import BODY
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_EXPECTATIONS, MAX_SENSORS
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.sensors.errors import parts
from bodycheck.reference.sensors.sensor import SENSOR_TYPES, Sensor
from bodycheck.suggestion import did_you_mean, first_names

#: The types of joints that exert an effort along their coordinate.
WITH_EFFORT = ("revolute", "prismatic")

#: The largest number of bodies or joints of a raw document that are looked at.
MAX_TABLES = 200


def sensor_faults(document: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of sensors of a raw document of either format, as pairs of path and message.

    The document may also have other faults. The names of bodies and joints of a model that could not be read are unknown.
    """
    single = "bodies" not in document and "joints" not in document and "model" not in document
    unread = "model" in document and "bodies" not in document
    bodies = [BODY] if single else _names(document, "bodies")
    joints = {joint["name"]: joint for joint in tables_of(document, "joints", MAX_TABLES) if isinstance(joint.get("name"), str)}
    first: dict[str, int] = {}
    for index, sensor in enumerate(tables_of(document, "sensors", MAX_SENSORS)):
        name, form = sensor.get("name"), SENSOR_TYPES.get(type_of(sensor))  # type: ignore[call-overload]
        if isinstance(name, str) and first.setdefault(name, index) != index:
            yield ("sensors", index, "name"), "stands twice; names of sensors must be unique"
        if form is None or unread:
            continue
        if form.mounted:
            for path, message in start_faults(sensor):
                yield ("sensors", index, *path), message
        fault = _of_joint(sensor, joints) if form.of_joint else _of_body(sensor, bodies)
        if fault is not None:
            yield ("sensors", index, "joint" if form.of_joint else "body"), fault
    for index, expectation in enumerate(tables_of(document, "expect", MAX_EXPECTATIONS)):
        for name in mapping(expectation.get("sensors")):
            if name not in first:
                listed = ", ".join(first_names(list(first))) or "none, as there is no sensor"
                yield (
                    ("expect", index, "sensors", name),
                    f"there is no such sensor; allowed: {listed}{did_you_mean(name, first)}",
                )


def _names(document: Mapping[str, Any], key: str) -> list[str]:
    return [name for table in tables_of(document, key, MAX_TABLES) if isinstance(name := table.get("name"), str)]


def _of_body(sensor: Mapping[str, Any], names: Sequence[str]) -> str | None:
    """Return the fault of the body of a sensor; None if there is none, or the grammar reports it."""
    listed = ", ".join(first_names(names)) or "no body, as there is none"
    if "body" not in sensor:
        return None if len(names) == 1 else f"is missing; allowed: {listed}"
    name = sensor["body"]
    if not isinstance(name, str) or name in names:
        return None
    return f"there is no such body; allowed: {listed}{did_you_mean(name, names)}"


def _of_joint(sensor: Mapping[str, Any], joints: Mapping[str, Mapping[str, Any]]) -> str | None:
    """Return the fault of the joint of a sensor; None if there is none, or the grammar reports it."""
    effort = type_of(sensor) == "joint_effort"
    fit = [name for name, joint in joints.items() if _can_sense(joint, effort)]
    wanted = "revolute or prismatic joint" if effort else "joint other than a free one"
    listed = ", ".join(first_names(fit)) or f"none, as there is no {wanted}"
    name = sensor.get("joint")
    if not isinstance(name, str) or name in fit:
        return None
    if name in joints:
        return f"is of the type {joints[name].get('type')}; a {type_of(sensor)} sensor needs a {wanted}; allowed: {listed}"
    return f"there is no such joint; allowed: {listed}{did_you_mean(name, fit)}"


def _can_sense(joint: Mapping[str, Any], effort: bool) -> bool:
    """Return whether a sensor can belong to a joint. effort: whether it is a joint_effort sensor."""
    return joint.get("type") in WITH_EFFORT if effort else joint.get("type") != "free"


def limits_of(table: Mapping[str, float], sensors: Sequence[Sensor]) -> Iterator[Limit]:
    """Yield the limits of the errors of sensors, by their names: of a wrench those of the force and of the moment."""
    for sensor in sensors:
        if sensor.name in table:
            for name, part in parts(sensor):
                yield Limit(SENSORS + name, None, table[sensor.name], sensor.form.units[part][0])


def build_sensors(tables: Sequence[SensorTable], scene: AnyScene) -> tuple[Sensor, ...]:
    """Return the sensors of a case whose scene is built. The names of bodies and joints exist."""
    return tuple(_sensor(table, scene) for table in tables)


def _sensor(table: SensorTable, scene: AnyScene) -> Sensor:
    kind = getattr(table, "type")  # noqa: B009  (a key of the tables, which are generated from the types)
    mechanism = scene if isinstance(scene, Mechanism) else None
    if isinstance(table, OfJointTable):
        assert mechanism is not None  # a single body has no joints
        joint = next(index for index, each in enumerate(mechanism.joints) if each.name == table.joint)
        return Sensor(table.name, kind, mechanism.joints[joint].child, joint)
    body = 0
    if mechanism is not None and isinstance(table, OfBodyTable) and table.body is not None:
        body = next(index for index, each in enumerate(mechanism.bodies) if each.name == table.body)
    if isinstance(table, MountedTable):
        return Sensor(table.name, kind, body, position=table.position, attitude=attitude_of(table))
    return Sensor(table.name, kind, body)
