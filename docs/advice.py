"""Print the table of docs/howto/choose-a-method.md: which method of each engine is accurate enough. Run: python docs/advice.py

The rows are those of the submissions of this repository, in their newest version of each engine.
"""

import csv
import io
import zipfile
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import median

from packaging.version import Version

ROOT = Path(__file__).resolve().parents[1]

#: The largest error that is accurate enough: rad, or m of a body on a plane.
LIMIT = 1e-3

#: The time step, s, of the methods that are compared with the default of an engine, which has its own.
STEP = 0.002

#: The columns of the table, and the figure that counts in each.
KINDS = {
    "a body tumbles": "attitude_error",
    "joints": "attitude_error",
    "closed loops": "attitude_error",
    "on a plane": "position_error",
}

#: Methods of Pinocchio that show what users write by mistake.
MISTAKES = ("body-twist-euler", "rk4-naive")

Row = dict[str, str]
#: The errors of a method by case, and its costs, s of computing for a simulated second.
Method = tuple[dict[str, float], list[float]]


def rows() -> Iterator[Row]:
    """Yield the rows of results of the newest version of each engine."""
    newest: dict[str, list[Row]] = {}
    for path in sorted((ROOT / "submissions").glob("*-[0-9]*.zip")):
        with zipfile.ZipFile(path) as file:
            table = list(csv.DictReader(io.StringIO(file.read("tables/results.csv").decode("utf-8"))))
        engine, version = table[0]["engine"].partition("@")[0], Version(table[0]["version"])
        if engine not in newest or Version(newest[engine][0]["version"]) < version:
            newest[engine] = table
    for table in newest.values():
        yield from table


def kind(row: Row) -> str | None:
    """Return the column of the table to which the case of a row belongs, None for cases of other kinds."""
    if row["kind"] == "mechanism":
        return "closed loops" if "loop" in row["tags"].split(";") else "joints"
    return {"turning": "a body tumbles", "contact": "on a plane"}.get(row["kind"])


def collected(results: Iterator[Row]) -> dict[tuple[str, str], dict[str, Method]]:
    """Return the methods of each engine and kind by their spelling, the engine's default with its own step as "default"."""
    found: dict[tuple[str, str], dict[str, Method]] = defaultdict(lambda: defaultdict(lambda: ({}, [])))
    for row in results:
        column = kind(row)
        if column is None or row["status"] != "ok" or row["integrator"] in MISTAKES or not row[KINDS[column]]:
            continue
        spellings = [row["integrator"]] if float(row["timestep"]) == STEP else []
        spellings += ["default"] if "default" in row.get("role", "") else []
        for spelling in spellings:
            errors, costs = found[row["engine"], column][spelling]
            errors[row["case"]] = float(row[KINDS[column]])
            costs.append(float(row["time_per_step"]) / float(row["timestep"]))
    return found


def cell(methods: dict[str, Method]) -> str:
    """Return how often the default is accurate enough, and the method that is most often, the cheapest of several."""
    scenes = len({case for errors, _ in methods.values() for case in errors})
    enough = {name: sum(error <= LIMIT for error in errors.values()) for name, (errors, _) in methods.items()}
    default = enough.pop("default", 0)
    best = min(enough, key=lambda name: (-enough[name], median(methods[name][1]), name))
    chosen = f"`{best}` {enough[best]}, default {default}" if "default" in methods else f"`{best}` {enough[best]}"
    return f"{chosen if enough[best] > default else f'default {default}'} of {scenes}"


def table(results: Iterator[Row]) -> list[str]:
    """Return the lines of the table."""
    found = collected(results)
    engines: Sequence[str] = sorted({engine for engine, _ in found})
    lines = [f"| engine | {' | '.join(KINDS)} |", f"| --- |{' --- |' * len(KINDS)}"]
    for engine in engines:
        cells = [cell(found[engine, column]) if (engine, column) in found else "–" for column in KINDS]
        lines.append(f"| {engine} | {' | '.join(cells)} |")
    return lines


if __name__ == "__main__":
    print("\n".join(table(rows())))
