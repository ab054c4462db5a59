"""The data of the site: JSON for programs, and the same data as scripts for pages, since a page from disk cannot read files.

`data/index.json` lists the content of the site:

- `submissions`: each with its key, date, machine and command, the numbers of rows of its `tables`, and its `runs`: for each
  engine, version and table, the number of rows;
- `engines`: each with its versions, the oldest first, and the address of its `changes`;
- `kinds` of scenes, each with the quantity that is shown;
- `scenes`;
- `tables`: each with the title, unit and meaning of each column;
- `cells`: the content of the front page for each engine and scene; a row is given as key of the submission, table and index.

`data/KEY.json` is a submission: its `header`, `tables` and `cases`. A table has `columns`, a list of values for each column
that is not empty, and the `commands` that reproduce its rows. A row has the same index, from 0, in all lists; `null` is an
empty entry. A table of runs also has `roundings` and `allowances` for the error in the quantity of the scene. A rounding is the
error change that rounding may cause if nothing amplifies it. An allowance is the change that rounding and the truth's error do
cause, if a study of releases has measured it; see `bodycheck.site.changes`. `cases` has the SHA-256 of each case file;
`data/cases.json` has the texts of the case files by SHA-256.

`data/changes/ENGINE.json` has the differences between any two results of an engine; see `bodycheck.site.pages.compare`.
"""

from collections.abc import Iterator
from dataclasses import asdict
from hashlib import sha256
from typing import Any

from bodycheck.reports.quantities import QUANTITIES
from bodycheck.reports.runs.kinds import KINDS
from bodycheck.site import changes, links
from bodycheck.site.catalogue import RUNS, Catalogue, Entry, entries_of, results_of
from bodycheck.site.cells import Cell
from bodycheck.site.commands import command
from bodycheck.site.front import Front
from bodycheck.site.render import FORMAT, File, data_files, json_file, script_file
from bodycheck.site.submissions.submission import Submission
from bodycheck.site.submissions.tables import TABLES


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the files of data."""
    known = index(catalogue)
    found = Front(catalogue)
    cells = [_cell(engine, scene, cell) for (engine, scene), cell in found.cells.items()]
    yield json_file(f"{links.DATA}index", known | {"cells": cells})
    yield script_file(f"{links.DATA}index", "site.index", known)
    texts = {_digest(text): text for source in catalogue.submissions for text in source.cases.values()}
    in_order = dict(sorted(texts.items()))
    yield json_file(f"{links.DATA}cases", {"format": FORMAT, "cases": in_order})
    yield script_file(f"{links.DATA}cases", "site.texts", in_order)
    for source in catalogue.submissions:
        yield from data_files(links.data(source), f'site.data["{source.key}"]', submission(catalogue, source))


def index(catalogue: Catalogue) -> dict[str, Any]:
    """Return the content of data/index.json without `cells`."""
    return {
        "format": FORMAT,
        "submissions": [_listed(source) for source in catalogue.submissions],
        "engines": [
            {
                "name": name,
                "versions": list(catalogue.versions[name]),
                "page": links.engine(name),
                "changes": links.changes(name),
            }
            for name in catalogue.engines
        ],
        "kinds": {
            kind.name: {
                "title": kind.title,
                "quantity": kind.quantity,
                "quantity_title": QUANTITIES[kind.quantity].title,
                "unit": QUANTITIES[kind.quantity].unit,
                "bound": QUANTITIES[kind.quantity].bound_name,
            }
            for kind in KINDS
        },
        "scenes": {
            name: {
                "title": scene.case.title,
                "kind": scene.kind.name,
                "tags": list(scene.case.tags),
                "shipped": scene.shipped,
                "page": links.scene(name),
            }
            for name, scene in catalogue.scenes.items()
        },
        "tables": {
            name: {
                "title": table.title,
                "columns": {
                    one.name: {"title": one.title, "unit": one.unit or one.counts, "meaning": one.told} for one in table.columns
                },
            }
            for name, table in TABLES.items()
        },
    }


def submission(catalogue: Catalogue, source: Submission) -> dict[str, Any]:
    """Return a submission in its JSON form."""
    return {
        "format": FORMAT,
        "key": source.key,
        "date": source.date,
        "machine": source.machine,
        "header": asdict(source.header),
        "tables": {name: _table(catalogue, source, name) for name, rows in source.tables.items() if rows},
        "cases": {name: _digest(text) for name, text in source.cases.items()},
    }


def _table(catalogue: Catalogue, source: Submission, name: str) -> dict[str, Any]:
    """Return a table of a submission, which has at least one row, in its JSON form."""
    rows = source.tables[name]
    there = [column for column in rows[0] if any(row[column] is not None for row in rows)]
    made: dict[str, Any] = {
        "rows": len(rows),
        "columns": {column: [row[column] for row in rows] for column in there},
        "commands": [command(source, name, row) for row in rows],
    }
    if name in RUNS:
        entries = list(entries_of(source, name))
        made["roundings"] = [changes.rounding(entry) for entry in entries]
        made["allowances"] = [_allowance(catalogue, entry) for entry in entries]
    return made


def _allowance(catalogue: Catalogue, entry: Entry) -> float | None:
    """Return by how much rounding and the truth's error change the error of a run; None if no study has measured this."""
    scene = catalogue.scenes.get(entry.row["case"])
    return changes.allowance(catalogue, entry, scene.quantity.name) if scene is not None else None


def _listed(source: Submission) -> dict[str, Any]:
    """Return the entry of a submission in data/index.json."""
    return {
        "key": source.key,
        "date": source.date,
        "started": source.header.started,
        "machine": source.machine,
        "command": source.command,
        "bodycheck": source.header.bodycheck,
        "engines": dict(source.header.engines),
        "tables": {name: len(rows) for name, rows in source.tables.items()},
        "runs": [
            {"engine": results.engine, "version": results.version, "table": results.table, "rows": len(results.runs)}
            for results in results_of(source)
        ],
    }


def _cell(engine: str, scene: str, cell: Cell) -> dict[str, Any]:
    """Return a cell of the front page in its JSON form."""
    best = cell.best
    return {
        "engine": engine,
        "scene": scene,
        "verdict": cell.verdict,
        "value": cell.value,
        "bound": cell.bound,
        "reason": cell.reason,
        "row": _place(cell.run),
        "recommended": _place(cell.recommended),
        "best": _place(best),
        "changes": [
            {
                "before": _place(change.before),
                "after": _place(change.after),
                "quantity": change.quantity,
                "worse": change.worse,
            }
            for change in cell.changes
        ],
    }


def _place(entry: Entry | None) -> list[Any] | None:
    """Return the location of a row: the key of its submission, its table and its index."""
    return None if entry is None else [entry.source.key, entry.table, entry.place]


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()
