"""The report of runs as Markdown."""

from collections.abc import Iterator, Sequence

from bodycheck.reports.markdown import (
    LONGEST_SENTENCE,
    code,
    details,
    escape,
    findings_list,
    fitted,
    grid,
    opening,
    table_with_notes,
)
from bodycheck.reports.quantities import count, milliseconds
from bodycheck.reports.runs.contents import Contents, Failure, Section
from bodycheck.reports.runs.matrix import Cell, Column, Matrix
from bodycheck.reports.runs.run_table import WITHIN_TRUTH
from bodycheck.results.verdicts import FAILED

#: The most failed runs in the table of failures.
MOST_FAILURES = 30

#: The most failed runs for which the report gives the next steps.
MOST_ADVISED = 10

#: The heading and the legend of the matrices.
MATRICES = f"## Cases and methods\n\n{FAILED} marks a failed run. {WITHIN_TRUTH}"


def render(contents: Contents) -> str:
    """Return the text of report.md for runs."""
    return fitted(_parts(contents), contents.header)


def _parts(contents: Contents) -> Iterator[str]:
    tally = " · ".join(f"{name} {amount}" for name, amount in contents.tally)
    yield opening(contents.headline, tally, contents.notices)
    if contents.failures:
        yield _failures(contents.failures)
        if any(failure.steps for failure in contents.failures):
            yield _steps(contents.failures)
    if contents.answers or contents.findings:
        yield findings_list((*contents.answers, *contents.findings))
    if contents.matrices:
        yield MATRICES
    for matrix in contents.matrices:
        yield _matrix(matrix)
    for section in contents.sections:
        yield _section(section)


def _failures(failures: Sequence[Failure]) -> str:
    rows = [(failure.case, failure.method, failure.status, failure.reason) for failure in failures[:MOST_FAILURES]]
    more = len(failures) - len(rows)
    table = grid(("Case", "Method", "Status", "Reason"), rows)
    return f"## Failed runs\n\n{table}" + (f"\n\n*{count(more, 'more run')} failed.*" if more else "")


def _steps(failures: Sequence[Failure]) -> str:
    """Return the next steps for the first failed runs, with commands that can be copied."""
    told = [
        f"- {escape(failure.case)}, {escape(failure.method)}\n"
        + "\n".join(f"  - {escape(step.why)}: {code(step.what)}" for step in failure.steps)
        for failure in failures[:MOST_ADVISED]
        if failure.steps
    ]
    return details("What to do next", "\n".join(told))


def _matrix(matrix: Matrix) -> str:
    title = f"{matrix.kind.title}: largest {matrix.quantity.title.lower()}, {matrix.quantity.unit}"
    amounts = f"{count(len(matrix.rows), 'case')}, {count(matrix.methods, 'method')}."
    steps = any(row.timestep != matrix.timestep for row in matrix.rows) or matrix.several_steps
    unless = ", unless another is given" if steps else ""
    same = " A method marked “= A” is the same algorithm as A." if any(own.same_as for own in matrix.columns) else ""
    size = f"{amounts} The time step is {milliseconds(matrix.timestep)}{unless}.{same}"
    folded = [position for position, column in enumerate(matrix.columns) if column.folded]
    shown = [position for position in range(len(matrix.columns)) if position not in folded]
    parts = [f"### {title}", size, _columns(matrix, shown)]
    if folded:
        others = sum(engine.methods for engine in matrix.engines)
        parts.append(details(count(others, "more method"), _columns(matrix, folded)))
    return "\n\n".join(parts)


def _columns(matrix: Matrix, positions: Sequence[int]) -> str:
    """Return a table with the columns of a matrix at these positions."""
    head = ("Case", *(f"{matrix.columns[position].engine} {_method(matrix.columns[position])}" for position in positions))
    rows = [(row.case, *(_cell(row.cells[position], matrix.timestep) for position in positions)) for row in matrix.rows]
    return grid(head, rows, numeric_from=1)


def _method(column: Column) -> str:
    same = f" (= {column.same_as})" if column.same_as else ""
    return f"{column.integrator}{same} {column.results}".rstrip()


def _cell(cell: Cell | None, common: float) -> str:
    if cell is None:
        return ""
    return ", ".join(
        (f"{FAILED} " if figure.failed else "")
        + figure.text
        + ("" if figure.timestep == common else f" ({milliseconds(figure.timestep)})")
        for figure in cell.figures
    )


def _section(section: Section) -> str:
    facts = [f"- {fact.term}: {escape(fact.text, LONGEST_SENTENCE)}" for fact in section.facts]
    source = [f"- Source: {escape(section.source)}"] if section.source else []
    body = section.absence if section.table is None else table_with_notes(section.table)
    origins = (
        () if section.origins is None else ("Origins of the contact discrepancies:", table_with_notes(section.origins.table))
    )
    return details(f"<b>{section.name}</b>: {escape(section.title)}", "\n".join(source + facts), body, *origins)
