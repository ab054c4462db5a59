"""The report of sensors: for each engine, what its sensors read, joined over all scenes, and the rows of each scene."""

from collections.abc import Iterator, Sequence

from bodycheck.judging.sensors.rows import SensorRow
from bodycheck.reports.finding import Finding
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import count, number
from bodycheck.reports.study import Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.studies.sensors.rows import Line, age_text, departures, lines

#: Explanations for readers.
READING = (
    "“Error” is the largest distance of a reading from the truth at the instant that the reading claims, relative to the "
    "largest true reading; it contains the error of the motion. Sign, frame, age and source do not contain it: the readings "
    "after the first steps are compared with what the sensor should read at the engine's own states, for other axes, frames, "
    "delays and sources.",
    "The age is the delay in steps that explains the readings best. The source is the state itself with the accelerations of "
    "the solver, or a difference of velocities or of positions over a step. A field is empty where the scene cannot tell it. "
    "“At reset” is the error of the reading after a reset, before any step: 1 means that it is as large as the reading.",
    "These are conventions of engines. They are named, so that a user can account for them.",
)


def present(header: Header, rows: Sequence[SensorRow]) -> StudyReport:
    """Return the contents of the report.

    header: the header of the results, with versions, machine and command. rows: the rows of the study.
    """
    by_engine: dict[str, list[SensorRow]] = {}
    for row in rows:
        by_engine.setdefault(row.engine, []).append(row)
    scenes = len({row.case for row in rows})
    return StudyReport(
        title="Sensors: what the robot feels",
        headline=f"{count(scenes, 'scene')} with sensors in {count(len(by_engine), 'engine')}",
        header=header,
        notices=tuple(of_header(header)),
        findings=tuple(_findings(rows)),
        parts=tuple(_part(engine, engine_rows) for engine, engine_rows in by_engine.items()),
        reading=READING,
    )


def _findings(rows: Sequence[SensorRow]) -> list[Finding]:
    """Return a finding for each engine, method and departure, with the types of sensors whose readings depart in this way."""
    types: dict[tuple[str, str], list[str]] = {}
    for line in lines(rows):
        after = "a step" if line.read == "step" else "the forward pass"
        for text in _departures(line):
            types.setdefault((f"{line.engine} {line.integrator}, after {after}", text), []).append(line.type)
    return [Finding(subject, f"{', '.join(names)}: {text}.") for (subject, text), names in types.items()]


def _departures(line: Line) -> Iterator[str]:
    """Yield what distinguishes the readings of a type of sensor from its definition, each as a clause."""
    if line.age_steps not in ("", "0"):
        yield "the readings are one step old" if line.age_steps == "1" else f"the readings are {line.age_steps} steps old"
    if line.source not in ("", "solver"):
        yield f"the readings are differences of {line.source}"
    if line.sign not in ("", "+"):
        yield f"the readings have the sign {line.sign}"
    if line.note:
        yield line.note


def _part(engine: str, rows: Sequence[SensorRow]) -> Part:
    """Return the part of one engine: the sheet, and a table of all rows."""
    return Part(
        name=engine,
        title=f"{engine} {rows[0].version}",
        texts=(),
        charts=(),
        tables=(("Over all scenes", _sheet(lines(rows))), ("Each scene", _scenes(rows))),
    )


def _sheet(shown: Sequence[Line]) -> Table:
    return Table(
        columns=("Method", "Type", "After", "Sign", "Frame", "Age, steps", "Source", "Error", "At reset", "Note"),
        numeric=(False,) * 7 + (True, True, False),
        rows=tuple(
            (
                *map(Entry, (line.integrator, line.type, line.read, line.sign, line.frame, line.age_steps, line.source)),
                *(Entry(number(value, 3), value) for value in (line.error, line.reset)),
                Entry(line.note),
            )
            for line in shown
        ),
        failed=(False,) * len(shown),
        notes=("Different conventions in several scenes stand one after another.",),
    )


def _scenes(rows: Sequence[SensorRow]) -> Table:
    return Table(
        columns=("Scene", "Method", "Sensor", "Error", "Relative", "Sign", "Frame", "Age, steps", "Source", "Note"),
        numeric=(False, False, False, True, True, False, False, False, False, False),
        rows=tuple(
            (
                *(Entry(row.case), Entry(row.integrator), Entry(row.sensor)),
                *(Entry(number(value, 3), value) for value in (row.error, row.relative_error)),
                *map(Entry, (row.sign, row.frame, age_text(row), row.source)),
                Entry(departures(row), meaning=row.note),
            )
            for row in rows
        ),
        failed=(False,) * len(rows),
        notes=("An error has the unit of its sensor. The note under the pointer also says what the scene cannot tell.",),
    )
