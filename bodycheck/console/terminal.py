"""Print results to stdout."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from bodycheck.console.options import AS_USUAL, View
from bodycheck.console.output import tell
from bodycheck.console.progress import progress
from bodycheck.console.tables import Column, Row, attribute, chosen, print_table, show
from bodycheck.results.verdicts import WITHIN_ASCII

if TYPE_CHECKING:
    from bodycheck.judging.baselines.difference import Difference
    from bodycheck.judging.expectation_writer import Change

__all__ = ["print_changes", "print_difference", "print_errors", "print_json", "print_requirements", "print_table", "progress"]

#: The columns of `bodycheck cases`.
CASES: tuple[Column[Any], ...] = (
    attribute("case", at="name"),
    attribute("title", wraps=True),
    Column("tags", "tags", lambda case: ", ".join(case.tags), goes=1, wraps=True),
)

#: The columns of `bodycheck engines`, whose rows are texts. On a narrow terminal the pages are left out.
ENGINES = tuple(
    Column(name, name, itemgetter(index), wraps=index > 2, goes=int(name == "pages"))
    for index, name in enumerate(("engine", "version", "installed", "integrators", "default", "recommended", "pages"))
)

#: The columns of `bodycheck expect`.
WRITTEN = (
    attribute("case", at="verdict.run.case"),
    attribute("engine", at="verdict.run.engine", goes=2),
    attribute("integrator", at="verdict.run.method.name"),
    attribute("timestep", "step", "g", at="verdict.run.method.timestep", goes=1),
    attribute("expectations", "its expectations", at="text", wraps=True),
)

#: The columns of `bodycheck diff`.
DIFFERENCES: tuple[Column[Any], ...] = (
    attribute("case"),
    attribute("engine", goes=1),
    attribute("integrator"),
    attribute("timestep", "step", "g", goes=2),
    attribute("what"),
    *(
        Column("base", "base", lambda change: change.figures[0], lambda change: _number(change.base), goes=4),
        Column("now", "now", lambda change: change.figures[1], lambda change: _number(change.now), goes=3),
        Column("explained", "explained", lambda change: change.figures[2], lambda change: change.allowance, goes=5),
        Column("change", "change", lambda change: change.amount, lambda change: change.factor),
    ),
)


def print_json(value: Any) -> None:
    """Print a value as JSON, on one line. Infinities and NaN, which JSON lacks, are printed as null."""
    print(json.dumps(_finite(value), ensure_ascii=False, allow_nan=False))


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def print_errors(columns: Sequence[Column[Row]], rows: Sequence[Row], view: View = AS_USUAL) -> None:
    """Print a table with errors of runs in the form of `error_text`, and explain its sign if any error has it."""
    show(columns, rows, view)
    if any(column.text(row).startswith(WITHIN_ASCII) for column in chosen(columns, view) for row in rows):
        tell(f"{WITHIN_ASCII} marks an error within the truth's own error, which is the number shown")


def print_requirements(needs: Mapping[str, Mapping[str, bool | str | int]], view: View = AS_USUAL) -> None:
    """Print one line per case with its requirements. needs: the requirements by their names, by the names of the cases."""
    show(requirement_columns(next(iter(needs.values()))), [{"case": case, **needed} for case, needed in needs.items()], view)


def requirement_columns(names: Iterable[str]) -> tuple[Column[Mapping[str, bool | str | int]], ...]:
    """Return the table columns for the requirements with some names."""

    def column(name: str, goes: int) -> Column[Mapping[str, bool | str | int]]:
        def text(row: Mapping[str, bool | str | int]) -> str:
            value = row[name]
            return ("yes" if value else "-") if isinstance(value, bool) else str(value)

        return Column(name, name.replace("_", " "), text, lambda row: row[name], goes)

    return tuple(column(name, index) for index, name in enumerate(("case", *names)))


def print_changes(changes: "Sequence[Change]", view: View = AS_USUAL) -> None:
    """Print one line per measurement, saying whether its expectations were written."""
    show(WRITTEN, changes, view)


def print_difference(difference: "Difference", summary: Sequence[str], view: View = AS_USUAL) -> None:
    """Print one line per change, the figures that could not be compared, and the sentences of a summary."""
    if difference.changes:
        show(DIFFERENCES, difference.changes, view)
    if difference.redefined:
        tell(f"not compared, since their definition has changed (save a new baseline): {', '.join(difference.redefined)}")
    for text in summary:
        tell(text)


def _number(value: float | str | None) -> float | None:
    return value if isinstance(value, float) else None
