"""results.json: what a report of runs says, for programs, and the JSON Schema of it.

Its `runs` are what `bodycheck run --json` prints.
"""

import json
import math
from collections.abc import Sequence
from typing import Any, get_args

from bodycheck.figures.columns import COLUMNS, FIGURES, FURTHER
from bodycheck.figures.definition import Column
from bodycheck.judging import judgement
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.runs.contents import Contents
from bodycheck.running.outcome import Completed, Outcome

FORMAT = 1

#: What is told of a set's header, in words.
HEADER = {
    "bodycheck": "Version of bodycheck.",
    "command": "The command that made the results, word by word.",
    "started": "When it was started: date and time with the zone's offset.",
    "machine": "System, processor, number of cores and version of Python.",
    "packages": "Versions of packages that figures depend on.",
    "engines": "Versions of the engines.",
    "missing": "Engines that could not be used, and why.",
}

#: Figures that every run that is ok has.
ALWAYS = tuple(name for name, figure in FIGURES.items() if figure.presence == "every run")

Schema = dict[str, Any]


def render(contents: Contents, sets: Sequence[ResultSet]) -> str:
    """The text of results.json."""
    return json.dumps(document(contents, sets), ensure_ascii=False, allow_nan=False, indent=1) + "\n"


def document(contents: Contents, sets: Sequence[ResultSet]) -> dict[str, Any]:
    """What results.json holds. contents: of the report of these sets."""
    rows = judgement.records(verdict for one in sets for verdict in one.verdicts)
    return {
        "format": FORMAT,
        "complete": contents.complete,
        "headline": contents.headline,
        "notices": list(contents.notices),
        "findings": [
            {"subject": finding.subject, "text": finding.text, "case": finding.where or None} for finding in contents.findings
        ],
        "sets": [_set(one) for one in sets],
        "runs": [{name: _there(value) for name, value in row.items()} for row in rows],
    }


def _set(one: ResultSet) -> dict[str, Any]:
    header, cases = one.results.header, one.results.cases.values()
    return {
        "label": one.label,
        "complete": one.results.complete,
        "header": {name: header[name] for name in HEADER},
        "cases": [{"name": case.name, "title": case.title, "source": case.source, "tags": list(case.tags)} for case in cases],
    }


def _there(value: Any) -> Any:
    """A value, None in place of a number that JSON has not."""
    return None if isinstance(value, float) and not math.isfinite(value) else value


def schema() -> str:
    """The JSON Schema of results.json, draft 2020-12."""
    text: Schema = {"type": "string"}
    versions: Schema = {"type": "object", "additionalProperties": text}
    kinds: dict[str, Schema] = {"bodycheck": text, "command": _list(text), "started": text | {"format": "date-time"}}
    header = {name: kinds.get(name, versions) | {"description": told} for name, told in HEADER.items()}
    finding = {
        "subject": text | {"description": "What the sentence is about."},
        "text": text | {"description": "A sentence or two, with numbers and units."},
        "case": {"type": ["string", "null"], "description": "The case that it points to, null where it points to none."},
    }
    case = {
        "name": text | {"description": "The case's name."},
        "title": text | {"description": "Its title."},
        "source": text | {"description": "Where it is from."},
        "tags": _list(text) | {"description": "Its tags."},
    }
    complete = {"type": "boolean", "description": "Whether the run came to its end."}
    one = {
        "label": text
        | {"description": "What the runs of this set have in their column `set`; empty where it is the only one."},
        "complete": complete,
        "header": _object(header, "Versions, machine and command."),
        "cases": _list(_object(case, "A case that was run.")) | {"description": "The cases that were run."},
    }
    whole: dict[str, Schema] = {
        "format": {"const": FORMAT, "description": "Of this document."},
        "complete": complete,
        "headline": text | {"description": "The verdict in one line."},
        "notices": _list(text) | {"description": "What limits what is said here."},
        "findings": _list(_object(finding, "A finding.")) | {"description": "What the runs show, the most telling first."},
        "sets": _list(_object(one, "Results that were made together."))
        | {"minItems": 1, "description": "Where the runs are from."},
        "runs": {"$ref": "#/$defs/runs"},
    }
    title = f"results.json of bodycheck, format {FORMAT}"
    runs = _list({"$ref": "#/$defs/run"}) | {"description": "All runs, as `bodycheck run --json` prints them."}
    made = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **_object(whole, "A report of runs.")}
    return json.dumps(made | {"$defs": {"runs": runs, "run": _run()}}, indent=2, ensure_ascii=False) + "\n"


def _run() -> Schema:
    """A row of results: a run that is ok has its errors, one that is not has no figures."""
    figures = (*judgement.COLUMNS[judgement.COLUMNS.index("reason") + 1 :], *FURTHER)
    properties = {name: _column(column) for name, column in COLUMNS.items()}
    run = _object(properties, "One engine with one method on one case.") | {"required": list(judgement.COLUMNS)}
    measured = {name: {"type": "number"} for name in (*ALWAYS, "steps", "wall_time")}
    return run | {
        "if": {"properties": {"status": {"const": Completed.status}}},
        "then": {"properties": measured},
        "else": {"properties": {name: {"type": "null"} for name in figures}},
    }


def _column(column: Column) -> Schema:
    """A column; what a run does not have is null."""
    told = f"{column.told[0].upper()}{column.told[1:]}."
    if column.kind in ("number", "integer"):
        told = f"{told} Unit: {column.in_unit}."
    made: Schema = {"description": told}
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
