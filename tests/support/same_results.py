"""Comparison of two folders of results, digit by digit, as before and after a change of the code that must change no result.

    python -m tests.support.same_results BEFORE AFTER

compares every table (`*.csv`) that either folder has, at any depth, and prints each difference. The exit code is 1 if there is
one. Only measured times, numbers that follow from them, versions, and the origin in comments are left out.
"""

import csv
import math
import re
import sys
from collections.abc import Iterator, Mapping
from itertools import zip_longest
from pathlib import Path

#: Columns with measured times or what follows from them, with versions, or with the folder of the results.
VARYING = re.compile(
    r"wall_time|.*time_per_step.*|setup_time|(relative_)?cost(_low|_high)?|engine_share|evaluations|real_?time_factor|version|.*_version|loaded|started"
)


def rows_of(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table without the varying columns."""
    with path.open(encoding="utf-8", newline="") as file:
        lines = (line for line in file if not line.startswith("#"))
        return [{name: value for name, value in row.items() if not VARYING.fullmatch(name)} for row in csv.DictReader(lines)]


def tables_of(folder: Path) -> dict[str, Path]:
    """Return the tables in a folder, by their paths in it."""
    return {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*.csv"))}


def differences(before: Path, after: Path, relative: float = 0.0, absolute: float = 0.0) -> Iterator[str]:
    """Yield a line for each table, row and value that is in one of two folders alone, or differs.

    relative, absolute: how much numbers may differ, relative to their size and in their unit.
    """
    old_tables, new_tables = tables_of(before), tables_of(after)
    if not old_tables and not new_tables:
        yield f"neither {before} nor {after} has a table"
    for name in sorted({*old_tables, *new_tables}):
        if name not in old_tables or name not in new_tables:
            yield f"{name}: only in {before if name in old_tables else after}"
            continue
        for number, (old, new) in enumerate(zip_longest(rows_of(old_tables[name]), rows_of(new_tables[name])), start=1):
            yield from (f"{name}, row {number}: {text}" for text in _of_rows(old, new, relative, absolute))


def _of_rows(old: Mapping[str, str] | None, new: Mapping[str, str] | None, relative: float, absolute: float) -> Iterator[str]:
    if old is None or new is None:
        yield "only after" if old is None else "only before"
        return
    for column in dict.fromkeys((*old, *new)):
        if not _same(old.get(column), new.get(column), relative, absolute):
            yield f"{column}: {old.get(column)} before, {new.get(column)} after"


def _same(old: str | None, new: str | None, relative: float, absolute: float) -> bool:
    if old == new or old is None or new is None:
        return old == new
    try:
        return math.isclose(float(old), float(new), rel_tol=relative, abs_tol=absolute)
    except ValueError:
        return False


if __name__ == "__main__":
    seen = list(differences(*map(Path, sys.argv[1:3])))
    print("\n".join(seen) or "the same rows")
    sys.exit(1 if seen else 0)
