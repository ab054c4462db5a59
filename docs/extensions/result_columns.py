"""The reference of the columns of results and studies, from what makes the tables."""

from collections.abc import Iterable, Iterator

from bodycheck.figures.column import Column
from bodycheck.figures.columns import (
    CASE_COLUMNS,
    COST_COLUMNS,
    DEPARTURE_COLUMNS,
    ENGINE_COLUMNS,
    FIGURES,
    LIMIT,
    LIMIT_COLUMNS,
    MARGIN,
    ORDER,
    RUN_COLUMNS,
    WORK_COLUMNS,
)
from bodycheck.judging.attribution import PARTS
from bodycheck.studies import registry
from bodycheck.studies.releases.rows import ALLOWANCE_SUFFIX
from docs.extensions.formulas import FORMULAS, NOTATION
from docs.extensions.markdown import code, prose, table

#: The commands of the studies whose folders have other names.
COMMANDS = {"ablation": "ablate"}

#: What stands for all columns of results in the table of a study, and for the allowances of all figures.
OF_RESULTS = ("the columns of `results.csv`", "the run and its figures; those of a run that is not ok are empty")
OF_ALLOWANCES = (
    f"`FIGURE{ALLOWANCE_SUFFIX}`",
    "the difference of a figure that is allowed if nothing has changed, in the unit of the figure",
)


def page() -> str:
    """Return the columns of all tables, each with unit, meaning and, where it is a figure, formula, as Markdown."""
    figures = [figure for figure in FIGURES.values() if not figure.of_truth]
    bounds = [figure for figure in FIGURES.values() if figure.of_truth]
    run = "## The table of runs\n\n`bodycheck run --out DIR` writes these columns into `results.csv` and `results.parquet`."
    return "\n\n".join(
        [
            run,
            "### The run",
            _plain(RUN_COLUMNS),
            "### Figures",
            NOTATION.strip(),
            _with_formulas([*figures, ORDER]),
            "### Bounds of the truth's own errors",
            _with_formulas(bounds),
            "### Costs",
            _plain(COST_COLUMNS),
            "### The case",
            _plain(CASE_COLUMNS),
            "### Limits and margins",
            f"For each figure that a case limits there are the columns `FIGURE{LIMIT}`, the limit, and `FIGURE{MARGIN}`, the "
            "limit divided by the figure.",
            "### Work",
            _plain(WORK_COLUMNS),
            "### Robots whose limits or contacts act from an instant on",
            _plain(DEPARTURE_COLUMNS),
            "### Driven joints, and contact laws given",
            _plain(ENGINE_COLUMNS),
            "## The tables of studies",
            *_studies(),
        ]
    )


def _studies() -> Iterator[str]:
    tables = [("run", PARTS)]
    for study in registry.STUDIES:
        rows = registry.part(study, "rows")
        assert rows is not None, f"the study {study} has no rows"
        tables += [(COMMANDS.get(study, study), described) for described in rows.TABLES]
    for command, described in tables:
        yield f"### {described.file}\n\n`bodycheck {command} --out DIR` writes it: {described.title}."
        yield table(("column", "meaning"), list(dict.fromkeys(map(_described, described.columns))))


def _described(column: Column) -> tuple[str, str]:
    """Return a column of a study with its meaning; the columns of all figures are those of results."""
    if column in FIGURES.values() or column in LIMIT_COLUMNS:
        return OF_RESULTS[0], prose(OF_RESULTS[1])
    if column.name.endswith(ALLOWANCE_SUFFIX):
        return OF_ALLOWANCES[0], prose(OF_ALLOWANCES[1])
    return code(column.name), prose(f"{column.told}{f' ({column.unit})' if column.unit else ''}")


def _plain(columns: Iterable[Column]) -> str:
    rows = [(code(column.name), column.kind, column.unit or column.counts, prose(column.told)) for column in columns]
    return table(("column", "type", "unit", "meaning"), rows)


def _with_formulas(columns: Iterable[Column]) -> str:
    """A list of columns, each with its unit, its meaning and its formula."""
    entries = []
    for column in columns:
        unit = f" ({column.in_unit})" if column.name in FIGURES else ""
        meaning = prose("; ".join(filter(None, (column.told, column.remark))))
        formula = f"\n\n  $$\n  {FORMULAS[column.name]}\n  $$" if column.name in FORMULAS else ""
        entries.append(f"{code(column.name)}{unit}\n: {meaning[:1].upper()}{meaning[1:]}.{formula}")
    return "\n\n".join(entries)
