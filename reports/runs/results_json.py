"""results.json, which has the contents of a report of runs for programs, and its JSON Schema.

Its entry `runs` equals the output of `bodycheck run --json`.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, get_args

from bodycheck.figures.column import Column
from bodycheck.figures.columns import (
    CASE_COLUMNS,
    COLUMNS,
    DEPARTURE_COLUMNS,
    FIGURES,
    FURTHER,
    LIMIT_COLUMNS,
    METHOD_COLUMNS,
    WORK_COLUMNS,
)
from bodycheck.judging import judgement
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.runs.contents import Contents
from bodycheck.results.header import DESCRIPTIONS
from bodycheck.results.outcome import Completed, Outcome

#: The version of the format.
FORMAT = 1

#: The figures that every completed run has.
ALWAYS = tuple(name for name, figure in FIGURES.items() if figure.presence == "every run")

Schema = dict[str, Any]


def render(contents: Contents, sets: Sequence[ResultSet]) -> str:
    """Return the text of results.json. Each run is on one line, since indentation would take several times as long."""
    found = document(contents, sets)
    runs = ",\n  ".join(json.dumps(row, ensure_ascii=False, allow_nan=False) for row in found.pop("runs"))
    others = json.dumps(found, ensure_ascii=False, allow_nan=False, indent=1).removesuffix("\n}")
    return f'{others},\n "runs": [\n  {runs}\n ]\n}}\n'


def document(contents: Contents, sets: Sequence[ResultSet]) -> dict[str, Any]:
    """Return the document of results.json. contents: the contents of the report of these sets."""
    return {
        "format": FORMAT,
        "complete": contents.complete,
        "headline": contents.headline,
        "notices": list(contents.notices),
        "findings": [
            {"subject": finding.subject, "text": finding.text, "case": finding.where or None}
            for finding in (*contents.answers, *contents.findings)
        ],
        "sets": [_set(one) for one in sets],
        "runs": rows([verdict for one in sets for verdict in one.verdicts]),
    }


def rows(verdicts: Sequence[Verdict]) -> list[dict[str, Any]]:
    """Return the entry `runs` of results.json: a row for each verdict, without numbers that are not finite."""
    return [{name: _json_value(value) for name, value in row.items()} for row in judgement.records(verdicts)]


def _set(one: ResultSet) -> dict[str, Any]:
    header, cases = one.results.header, one.results.cases.values()
    return {
        "label": one.label,
        "complete": one.results.complete,
        "header": {name: value for name, value in header.items() if name in DESCRIPTIONS},
        "unchecked": [asdict(lost) for lost in one.results.unchecked],
        "cases": [{"name": case.name, "title": case.title, "source": case.source, "tags": list(case.tags)} for case in cases],
    }


def _json_value(value: Any) -> Any:
    """Return a value, or None for a number that is not finite, which JSON does not allow."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def schema() -> str:
    """Return the JSON Schema (draft 2020-12) of results.json."""
    text: Schema = {"type": "string"}
    versions: Schema = {"type": "object", "additionalProperties": text}
    kinds: dict[str, Schema] = {"bodycheck": text, "command": _list(text), "started": text | {"format": "date-time"}}
    by_engine = ("environments", "demonstrations", "defaults", "soft", "without_method")
    kinds |= {name: {"type": "object", "additionalProperties": versions} for name in by_engine}
    kinds |= {"robots": {"type": "object", "additionalProperties": _list(text)}}
    kinds |= {"departures": {"type": "object", "additionalProperties": {"type": "number", "minimum": 0}}}
    header = {name: kinds.get(name, versions) | {"description": description} for name, description in DESCRIPTIONS.items()}
    finding = {
        "subject": text | {"description": "Subject of the sentence."},
        "text": text | {"description": "A sentence or two, with numbers and units."},
        "case": {"type": ["string", "null"], "description": "The case that the sentence names, or null."},
    }
    case = {
        "name": text | {"description": "Name of the case."},
        "title": text | {"description": "Title of the case."},
        "source": text | {"description": "Source of the case."},
        "tags": _list(text) | {"description": "Tags of the case."},
    }
    unchecked = {
        "case": text | {"description": "Name of the case."},
        "engine": text | {"description": "Name of the engine."},
        "integrator": text | {"description": "Name of the integrator, with its options after a colon."},
        "timestep": {"type": "number", "description": "Time step. Unit: s."},
        "reason": text | {"description": "Why the engine cannot be used."},
        "tolerated": text | {"description": "Why it does not count as failed; empty if it does."},
    }
    complete = {"type": "boolean", "description": "Whether the command came to its end; false if it was interrupted."}
    one = {
        "label": text | {"description": "Label in the column `set` of the runs of this set; empty if there is only one set."},
        "complete": complete,
        "header": _object(header, "Versions, machine and command."),
        "unchecked": _list(_object(unchecked, "Something expected of a method whose engine cannot be used."))
        | {"description": "The expectations that no run could check."},
        "cases": _list(_object(case, "A case that was run.")) | {"description": "The cases that were run."},
    }
    whole: dict[str, Schema] = {
        "format": {"const": FORMAT, "description": "Version of the format of this document."},
        "complete": complete,
        "headline": text | {"description": "The verdict in one line."},
        "notices": _list(text) | {"description": "Sentences on what limits this report."},
        "findings": _list(_object(finding, "A finding."))
        | {"description": "Findings about the runs, the most important first."},
        "sets": _list(_object(one, "A set of results that were made together."))
        | {"minItems": 1, "description": "The sets of results that the runs are from."},
        "runs": {"$ref": "#/$defs/runs"},
    }
    title = f"results.json of bodycheck, format {FORMAT}"
    runs = _list({"$ref": "#/$defs/run"}) | {"description": "All runs, as `bodycheck run --json` prints them."}
    made = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **_object(whole, "A report of runs.")}
    return json.dumps(made | {"$defs": {"runs": runs, "run": _run()}}, indent=2, ensure_ascii=False) + "\n"


def _run() -> Schema:
    """Return the schema of a row of results. Completed runs have numbers; all other runs have none."""
    limits, work = (column.name for column in LIMIT_COLUMNS), [column.name for column in WORK_COLUMNS]
    departure = (column.name for column in DEPARTURE_COLUMNS)
    figures = (*judgement.COLUMNS[judgement.COLUMNS.index("reason") + 1 :], *FURTHER, *limits, *work, *departure)
    properties = {name: _column(column) for name, column in COLUMNS.items()}
    required = [*judgement.COLUMNS, *(column.name for column in (*CASE_COLUMNS, *METHOD_COLUMNS))]
    run = _object(properties, "One engine with one method on one case.") | {"required": required}
    measured = {name: {"type": "number"} for name in (*ALWAYS, "steps", "wall_time")}
    return run | {
        "if": {"properties": {"status": {"const": Completed.status}}},
        "then": {"properties": measured},
        "else": {"properties": {name: {"type": "null"} for name in figures}},
    }


def _column(column: Column) -> Schema:
    """Return the schema of a column. Its value may be null, except for texts and the time step."""
    description = f"{column.told[0].upper()}{column.told[1:]}."
    if column.kind in ("number", "integer"):
        description = f"{description} Unit: {column.in_unit}."
    made: Schema = {"description": description}
    if column.name == "status":
        return made | {"enum": [kind.status for kind in get_args(Outcome)]}
    if column.name == "timestep":
        return made | {"type": "number", "exclusiveMinimum": 0}
    if column.kind == "string":
        return made | {"type": "string"}
    least = {} if column.kind == "boolean" else {"minimum": 0}
    return made | {"type": [column.kind, "null"]} | least


def _object(properties: dict[str, Schema], description: str) -> Schema:
    names = {"properties": properties, "required": list(properties), "additionalProperties": False}
    return {"description": description, "type": "object", **names}


def _list(items: Schema) -> Schema:
    return {"type": "array", "items": items}
