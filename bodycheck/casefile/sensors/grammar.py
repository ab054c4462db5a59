"""The grammar of sensors in case files of both formats."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, cast

from pydantic import Field, create_model

from bodycheck.casefile.values import MAX_SENSORS, Label, Quaternion, Table, Vector
from bodycheck.reference.sensors.sensor import SENSOR_TYPES, SensorForm


class SensorTable(Table):
    """The keys of every sensor."""

    name: Label = Field(description="unique among the sensors")


class OfBodyTable(SensorTable):
    """The keys of sensors of a body."""

    body: Label | None = Field(default=None, description="name of the body; default the only body")


class MountedTable(OfBodyTable):
    """The keys of sensors with a place and axes on a body."""

    position: Vector = Field(default=(0.0, 0.0, 0.0), description="in the frame of the body, m")
    euler_zxz: Vector | None = Field(default=None, description="of its axes in the frame of the body, rad")
    quaternion: Quaternion | None = Field(default=None, description="w, x, y, z, its axes to the frame of the body")


class OfJointTable(SensorTable):
    """The keys of sensors of a joint."""

    joint: Label = Field(description="name of the joint")


def _table(form: SensorForm) -> type[SensorTable]:
    """Return the grammar of the table of a type of sensor."""
    base = OfJointTable if form.of_joint else MountedTable if form.mounted else OfBodyTable
    keys: dict[str, Any] = {"type": (cast(Any, Literal)[form.name], ...)}
    name = f"{''.join(word.capitalize() for word in form.name.split('_'))}Table"
    return create_model(name, __base__=base, __doc__=form.meaning, **keys)


#: The grammar of each type of sensor.
SENSOR_TABLES: dict[str, type[SensorTable]] = {form.name: _table(form) for form in SENSOR_TYPES.values()}

if TYPE_CHECKING:  # type checkers cannot see the keys of tables that are made while the program runs
    AnySensor = SensorTable
else:
    AnySensor = Annotated[Union[tuple(SENSOR_TABLES.values())], Field(discriminator="type")]  # noqa: UP007

#: The key `sensors` of a case file.
Sensors = Annotated[tuple[AnySensor, ...], Field(max_length=MAX_SENSORS)]


def type_of(sensor: Any) -> str:
    """Return the type that a raw table of a sensor states; empty if it states none."""
    kind = sensor.get("type") if isinstance(sensor, dict) else None
    return kind if isinstance(kind, str) else ""
