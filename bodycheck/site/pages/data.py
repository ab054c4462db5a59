"""The data of the site, for programs as JSON, and the same as scripts for pages, since a page from disk may not read files.

`data/index.json` lists what there is:

- `submissions`: each with its key, date, machine and command, the numbers of rows of its `tables`, and the `runs` that it has,
  as the engine, the version, and the table with their rows;
- `engines` with their versions, the oldest first, and the address of their `changes`, `kinds` of scenes
  with the quantity that is shown of each, `scenes`, and the `tables` with the title, unit and meaning of each column;
- `cells`: what the front page shows of each engine and scene, with the address of the row as key, table and place.

`data/KEY.json` is a submission: its `header`, `tables` and `cases`. A table has `columns`, a list of values for each column
that has any, and the `commands` that make its rows again. A row has the same place in all lists, from 0; `null` is an empty
entry. A table of runs also has `roundings` and `allowances` of the error in the quantity of the scene: by how much rounding may
move it if nothing amplifies rounding, and by how much rounding and the truth's error do move it, where a study of releases has
measured that; see `bodycheck.site.changes`. `cases` has the SHA-256 of each case file, under which `data/cases.json` has its
text.

`data/changes/ENGINE.json` has the differences between any two results of an engine; see `bodycheck.site.pages.compare`.
"""

from collections.abc import Iterator
from dataclasses import asdict
from hashlib import sha256
from typing import Any

from bodycheck.reports.quantities import QUANTITIES
from bodycheck.reports.runs.matrix import KINDS
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
    """Return what data/index.json has besides cells."""
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
    """Return a table with rows."""
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
    """Return by how much rounding and the truth's error move the error of a run, in the quantity of its scene."""
    scene = catalogue.scenes.get(entry.row["case"])
    return changes.allowance(catalogue, entry, scene.quantity.name) if scene is not None else None


def _listed(source: Submission) -> dict[str, Any]:
    """Return what the list says of a submission."""
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
    """Return a cell of the front page."""
    best = cell.best
    return {
        "engine": engine,
        "scene": scene,
        "verdict": cell.verdict,
        "value": cell.value,
        "bound": cell.bound,
        "reason": cell.reason,
        "row": _place(cell.run),
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
    """Return where a row is: the key of its submission, its table and its place."""
    return None if entry is None else [entry.source.key, entry.table, entry.place]


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()
