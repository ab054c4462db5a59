"""The reference of the columns of results and studies, from what makes the tables."""

import inspect
import re
from collections.abc import Iterable, Iterator, Sequence

from bodycheck.figures.columns import CASE_COLUMNS, COST_COLUMNS, FIGURES, LIMIT, MARGIN, ORDER, RUN_COLUMNS
from bodycheck.figures.definition import Column
from bodycheck.judging.attribution import Attribution
from bodycheck.studies.ablation.rows import ModelRow
from bodycheck.studies.audit.class_rows import ClassRow
from bodycheck.studies.audit.rows import Row as AuditRow
from bodycheck.studies.contact.rows import ContactRow
from bodycheck.studies.ensemble.rows import DependenceRow
from bodycheck.studies.ensemble.rows import Row as EnsembleRow
from bodycheck.studies.extremes.rows import Limit
from bodycheck.studies.extremes.rows import Row as ExtremesRow
from bodycheck.studies.orders import Order
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.recommend.rows import Answer, Probe
from bodycheck.studies.releases.rows import ALLOWANCE_SUFFIX, Change
from bodycheck.studies.tradeoff.columns import BATCHES, COSTS
from docs.extensions.formulas import FORMULAS, NOTATION
from docs.extensions.markdown import code, prose, table

#: A column of a study with its meaning, where no dataclass says it.
Told = tuple[str, str]

OF_RESULTS = ("the columns of `results.csv`", "the run and its figures; those of a run that is not ok are empty")

ABLATION = (
    ("position_change, attitude_change", "the largest difference from the motion of the smallest model, in m and rad"),
    ("position_rounding, attitude_rounding", "the part of it that the rounding of all steps can cause, in m and rad"),
    ("position_time_step, attitude_time_step", "the sum of the time-step errors of both models, in m and rad"),
)

ALLOWANCES = (
    (
        f"FIGURE{ALLOWANCE_SUFFIX}",
        "the difference of a figure that is allowed if nothing has changed, in the unit of the figure",
    ),
)

#: The tables of studies: the command, the file, and where its columns are described.
STUDIES: tuple[tuple[str, str, Sequence[Told | Column | type]], ...] = (
    ("run", "attribution.csv", (Attribution,)),
    ("tradeoff", "tradeoff.csv", (OF_RESULTS, *COSTS, *BATCHES)),
    ("tradeoff", "orders.csv", (Order,)),
    ("recommend", "recommend.csv", (Answer,)),
    ("recommend", "steps.csv", (Probe,)),
    ("extremes", "extremes.csv", (ExtremesRow,)),
    ("extremes", "limits.csv", (Limit,)),
    ("ensemble", "ensemble.csv", (EnsembleRow,)),
    ("ensemble", "sensitivity.csv", (DependenceRow,)),
    ("ablate", "ablation.csv", (ModelRow, *ABLATION)),
    ("audit", "audit.csv", (AuditRow,)),
    ("audit", "classes.csv", (ClassRow,)),
    ("parity", "parity.csv", (("model, engine, version", "the robot model and the engine"), Compared)),
    ("contact", "contact.csv", (ContactRow,)),
    ("releases", "releases.csv", (OF_RESULTS, *ALLOWANCES)),
    ("releases", "changes.csv", (Change,)),
)

#: Names in files that are not those of the fields of a dataclass, and fields that are spread over several columns.
RENAMED = {ClassRow: {"name": "class"}, ModelRow: {"changes": "", "errors": "the columns of errors of `results.csv`"}}


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
            "## The tables of studies",
            *_studies(),
        ]
    )


def _studies() -> Iterator[str]:
    for command, file, sources in STUDIES:
        yield f"### {file}\n\n`bodycheck {command} --out DIR` writes it."
        rows = [row for source in sources for row in _rows(source)]
        yield table(("column", "meaning"), [(_names(names), prose(meaning)) for names, meaning in rows])


def _rows(source: Told | Column | type) -> Iterable[Told]:
    if isinstance(source, Column):
        return [(source.name, f"{source.meaning}{f' ({source.unit})' if source.unit else ''}")]
    if isinstance(source, type):
        renamed = RENAMED.get(source, {})
        told = [(renamed.get(names, names), meaning) for names, meaning in described(source)]
        return [(names, meaning) for names, meaning in told if names]
    return [source]


def described(row: type) -> list[Told]:
    """Return the fields of a dataclass with what its docstring says of each; fields that share a description are together."""
    section = re.split(r"\n(?:Parameters|Attributes)\n-+\n", inspect.getdoc(row) or "")[1]
    entries = re.findall(r"^(\S.*)\n((?:(?:[ ].*)?\n?)+)", section, re.MULTILINE)
    # Files have an empty entry where a row has None.
    return [(names, re.sub(r"\bNone\b", "empty", " ".join(meaning.split()))) for names, meaning in entries]


def _names(names: str) -> str:
    return names if "`" in names else ", ".join(code(name) for name in names.split(", "))


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
