"""The table of the study, and the lines of the sheet, each of which joins the rows of a type of sensor over all scenes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bodycheck.adapters.method import Method
from bodycheck.judging.sensors.rows import SENSORS, SensorRow
from bodycheck.studies.sensors.study import READS

#: The tables of the study.
TABLES = (SENSORS,)


@dataclass(frozen=True)
class Line:
    """The readings of a type of sensor in an engine with a method, over all scenes that can tell their convention.

    Attributes
    ----------
    engine, version, integrator
        The engine, its version, and the method without the option that says when sensors are read.
    type
        The type of the sensor; of a wrench with the suffix ".force" or ".moment".
    read
        When sensors are read: "step" or "forward".
    sign, frame, age_steps, source
        The conventions; different ones of several scenes one after another, separated by commas.
    error
        The largest relative error.
    reset
        The largest error after a reset, relative to the largest reading.
    note
        Terms that readings have in excess or lack.
    scenes
        The number of scenes.
    """

    engine: str
    version: str
    integrator: str
    type: str
    read: str
    sign: str
    frame: str
    age_steps: str
    source: str
    error: float | None
    reset: float | None
    note: str
    scenes: int


def lines(rows: Sequence[SensorRow]) -> list[Line]:
    """Return a line for each engine, method and type of sensor, from the rows of all scenes."""
    groups: dict[tuple[str, ...], list[SensorRow]] = {}
    for row in rows:
        groups.setdefault((row.engine, row.version, *_read(row), _type(row)), []).append(row)
    types = list(dict.fromkeys(kind for *_, kind in groups))
    return [
        _line(key, groups[key]) for key in sorted(groups, key=lambda key: (key[:3], types.index(key[-1]), key[3] != "step"))
    ]


def departures(row: SensorRow) -> str:
    """Return the note of a row without what the scene cannot tell."""
    return "; ".join(part for part in row.note.split("; ") if not part.startswith("the scene cannot tell"))


def _line(key: tuple[str, ...], rows: Sequence[SensorRow]) -> Line:
    engine, version, integrator, read, kind = key
    resets = [
        row.reset_error * row.relative_error / row.error
        for row in rows
        if row.reset_error is not None and row.error and row.relative_error is not None
    ]
    return Line(
        *(engine, version, integrator, kind, read),
        sign=_joined(rows, lambda row: row.sign),
        frame=_joined(rows, lambda row: row.frame),
        age_steps=_joined(rows, age_text),
        source=_joined(rows, lambda row: row.source),
        error=max((row.relative_error for row in rows if row.relative_error is not None), default=None),
        reset=max(resets, default=None),
        note=_notes(rows),
        scenes=len({row.case for row in rows}),
    )


def age_text(row: SensorRow) -> str:
    """Return the age of readings with as many digits as its uncertainty has; empty if it is not known."""
    return "" if row.age_steps is None else f"{row.age_steps:.2g}"


def _joined(rows: Sequence[SensorRow], text: Callable[[SensorRow], str], between: str = ", ") -> str:
    """Return the different texts of rows, without empty ones."""
    return between.join(dict.fromkeys(filter(None, map(text, rows))))


def _notes(rows: Sequence[SensorRow]) -> str:
    """Return the notes of rows, each once; a note that not all scenes share names its scenes."""
    scenes: dict[str, list[str]] = {}
    for row in rows:
        if text := departures(row):
            scenes.setdefault(text, []).append(row.case)
    count = len({row.case for row in rows})
    return "; ".join(
        text if len(set(names)) == count else f"{text} ({', '.join(dict.fromkeys(names))})" for text, names in scenes.items()
    )


def _read(row: SensorRow) -> tuple[str, str]:
    """Return the method of a row without the option that says when sensors are read, and the value of this option."""
    method = Method.parse(row.integrator, row.timestep)
    return method.without(READS).name, method.option(READS) or "step"


def _type(row: SensorRow) -> str:
    """Return the type of the sensor of a row, with the part of a wrench."""
    suffix = next((part for part in (".force", ".moment") if row.type == "force_torque" and row.sensor.endswith(part)), "")
    return f"{row.type}{suffix}"
