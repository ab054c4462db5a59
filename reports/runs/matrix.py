"""Matrices of cases by methods: one for each kind of scene, with the quantity that shows discrepancies best.

The rows are cases and the columns are methods, engine by engine. If there are more columns than a page has room for, each
engine shows only its first and its best method, until the reader opens the others.
"""

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from bodycheck.adapters.contract import kind_of as scene_kind
from bodycheck.casefile.content import Case
from bodycheck.judging.judgement import Verdict
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import Quantity, milliseconds, number, within
from bodycheck.reports.runs.commands import curve_anchor
from bodycheck.reports.runs.kinds import KINDS, Kind, kind_of
from bodycheck.reports.same_algorithm import NO_CLASSES, Classes, firsts
from bodycheck.results.key import RunKey

#: The most columns that fit beside the names of the cases in a window of 1280 pixels. If there are more, methods are folded.
MOST_COLUMNS = 12


@dataclass(frozen=True)
class Figure:
    """One run in a cell.

    Parameters
    ----------
    text
        The number, or the status if there is none.
    meaning
        Explanation that appears at the pointer.
    timestep
        Time step (s).
    error
        The error, or the error bound of the truth if that is larger; None if the run has no error.
    decade
        The decimal exponent of the error, limited to -12 to 0, which determines the shade of the cell; None if the error is
        within the error bound of the truth, or if there is none.
    failed
        Whether the run failed.
    link
        The anchor to which the cell links: the curve of the quantity or, if it has no curve, the case.
    run
        The anchor of the command that reproduces the run.
    """

    text: str
    meaning: str
    timestep: float
    error: float | None
    decade: int | None
    failed: bool
    link: str
    run: str


@dataclass(frozen=True)
class Cell:
    """The runs of one method on one case.

    `common` is the run at the time step of the row; `others` are the runs at other time steps, the largest step first.
    """

    common: Figure | None
    others: tuple[Figure, ...]

    @property
    def figures(self) -> tuple[Figure, ...]:
        """Return all runs, first the run at the time step of the row."""
        return (*((self.common,) if self.common is not None else ()), *self.others)


@dataclass(frozen=True)
class Column:
    """One method at all time steps.

    `results` is the label of the set of results; it is empty if there is only one set. `demonstrates` says whether the method
    is a demonstration. `same_as` is the name of the first method with the same algorithm; it is empty for that method itself
    and for methods whose algorithm no other method has. `folded` says whether the column is hidden until the reader opens it.
    """

    engine: str
    integrator: str
    results: str
    colour: str
    demonstrates: bool
    same_as: str = ""
    folded: bool = False


@dataclass(frozen=True)
class Row:
    """One case.

    `timestep` is the time step (s) of most runs, which is that of the matrix if there are any runs with it. `words` is the text
    that the filter of the page searches. A cell is None if the method has no run of the case.
    """

    case: str
    words: str
    timestep: float
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True)
class EngineColumns:
    """The adjacent columns of one engine.

    Parameters
    ----------
    engine, colour
        Name and colour of the engine.
    columns, shown
        The number of all columns, and of those that are not folded.
    methods
        The number of methods whose columns are folded.
    failed
        The number of failed runs in folded columns.
    """

    engine: str
    colour: str
    columns: int
    shown: int
    methods: int
    failed: int


@dataclass(frozen=True)
class Matrix:
    """All cases of one kind by all methods with which any of them was run.

    `timestep` is the most common time step (s), `sets` are the labels of the sets of results in the order of the report.
    """

    kind: Kind
    timestep: float
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    sets: tuple[str, ...]

    @property
    def quantity(self) -> Quantity:
        """Return the quantity whose maxima the cells show."""
        return self.kind.figure

    @property
    def engines(self) -> tuple[EngineColumns, ...]:
        """Return the engines in the order of their columns, each with the colour of its first column in the last set."""
        colours: dict[str, str] = {}
        for column in sorted(self.columns, key=lambda column: -self.sets.index(column.results)):
            colours.setdefault(column.engine, column.colour)
        found = []
        for engine in dict.fromkeys(column.engine for column in self.columns):
            positions = [position for position, column in enumerate(self.columns) if column.engine == engine]
            folded = [position for position in positions if self.columns[position].folded]
            cells = [cell for row in self.rows for position in folded if (cell := row.cells[position]) is not None]
            failed = sum(figure.failed for cell in cells for figure in cell.figures)
            methods = len({self.columns[position].integrator for position in folded})
            found.append(EngineColumns(engine, colours[engine], len(positions), len(positions) - len(folded), methods, failed))
        return tuple(found)

    @property
    def methods(self) -> int:
        """Return the number of methods; a method in several sets of results counts once."""
        return len({(column.engine, column.integrator) for column in self.columns})

    @property
    def several_steps(self) -> bool:
        """Return whether any run has a time step other than that of its row."""
        return any(cell.others for row in self.rows for cell in row.cells if cell is not None)

    @property
    def elsewhere(self) -> bool:
        """Return whether any cell shows a run with a time step other than that of its row."""
        return any(cell.common is None for row in self.rows for cell in row.cells if cell is not None)


def best(methods: Sequence[tuple[Column, Sequence[Cell | None]]]) -> str:
    """Return the integrator, with its options, that completed the most cases and, among equals, has the smallest maximum error.

    If a case was run with several time steps, that of its row counts. A demonstration is the best only if there are no
    other methods. methods: the methods of one engine with their cells, one for each case.
    """
    cells: dict[str, list[Cell | None]] = {}
    for column, own in [one for one in methods if not one[0].demonstrates] or methods:
        cells.setdefault(column.integrator, []).extend(own)

    def rank(integrator: str) -> tuple[int, float]:
        errors = [cell.figures[0].error if cell is not None else None for cell in cells[integrator]]
        return errors.count(None), max((error for error in errors if error is not None), default=math.inf)

    return min(cells, key=rank)


def matrices(
    cases: Mapping[str, Case],
    verdicts: Sequence[Verdict],
    lines: Mapping[RunKey, Line],
    anchors: Mapping[RunKey, str],
    drawn: Mapping[str, Collection[str]],
    demonstrations: Collection[RunKey] = (),
    classes: Classes = NO_CLASSES,
) -> tuple[Matrix, ...]:
    """Return a matrix for each kind of scene that has runs, in the order of `KINDS`.

    anchors: the anchors of the commands that reproduce the runs; drawn: the quantities that have curves, by case;
    demonstrations: the methods that are demonstrations; classes: the classes of methods that are the same algorithm, by kind of
    scene.
    """
    kinds = {name: kind_of(case.scene) for name, case in cases.items()}
    found = []
    for kind in KINDS:
        own = [verdict for verdict in verdicts if kinds[verdict.run.case] == kind]
        if own:
            members = {name: case for name, case in cases.items() if kinds[name] == kind}
            figures: dict[RunKey, list[Figure]] = {}
            for verdict in own:
                curved = kind.quantity in drawn[verdict.run.case] and verdict.discrepancy is not None
                link = curve_anchor(verdict.run.case, kind.quantity) if curved else f"case-{verdict.run.case}"
                figures.setdefault(verdict.key.over_steps, []).append(_figure(verdict, kind, link, anchors[verdict.key]))
            same = firsts([one for case in members.values() for one in classes.get(scene_kind(case.scene), ())])
            found.append(_matrix(kind, members, own, lines, figures, demonstrations, same))
    return tuple(found)


def _matrix(
    kind: Kind,
    cases: Mapping[str, Case],
    verdicts: Sequence[Verdict],
    lines: Mapping[RunKey, Line],
    by_cell: Mapping[RunKey, Sequence[Figure]],
    demonstrations: Collection[RunKey],
    same: Mapping[RunKey, str],
) -> Matrix:
    used = {verdict.key.over_cases for verdict in verdicts}
    columns: dict[RunKey, Column] = {}
    for key, line in lines.items():
        if key in used:
            named = (line.engine, line.integrator, line.results)
            column = Column(*named, line.colour, key in demonstrations, same.get(key.over_steps, ""))
            columns.setdefault(key.over_steps, column)
    common = _common(verdicts)
    by_case: dict[str, list[Verdict]] = {name: [] for name in cases}
    for verdict in verdicts:
        by_case[verdict.run.case].append(verdict)
    rows = []
    for name, case in cases.items():
        runs = by_case[name]
        step = common if not runs or any(one.run.method.timestep == common for one in runs) else _common(runs)
        cells = tuple(_cell(by_cell.get(replace(key, case=name), ()), step) for key in columns)
        rows.append(Row(name, " ".join((name, *case.tags)), step, cells))
    sets = tuple(dict.fromkeys(line.results for line in lines.values()))
    return Matrix(kind, common, _folded(tuple(columns.values()), rows), tuple(rows), sets)


def _common(verdicts: Sequence[Verdict]) -> float:
    """Return the most frequent time step (s) of runs, the largest of equally frequent ones."""
    steps = Counter(verdict.run.method.timestep for verdict in verdicts)
    return max(steps, key=lambda step: (steps[step], step))


def _folded(columns: tuple[Column, ...], rows: Sequence[Row]) -> tuple[Column, ...]:
    """Return the columns, of which only the first and the best method of each engine are shown if there are too many."""
    if len(columns) <= MOST_COLUMNS:
        return columns
    shown = set()
    for engine in {column.engine for column in columns}:
        methods = [
            (column, tuple(row.cells[position] for row in rows))
            for position, column in enumerate(columns)
            if column.engine == engine
        ]
        shown |= {(engine, methods[0][0].integrator), (engine, best(methods))}
    return tuple(replace(column, folded=(column.engine, column.integrator) not in shown) for column in columns)


def _cell(figures: Sequence[Figure], step: float) -> Cell | None:
    if not figures:
        return None
    others = sorted((figure for figure in figures if figure.timestep != step), key=lambda figure: -figure.timestep)
    return Cell(next((figure for figure in figures if figure.timestep == step), None), tuple(others))


def _figure(verdict: Verdict, kind: Kind, link: str, run: str) -> Figure:
    timestep, failed = verdict.run.method.timestep, verdict.passed is False
    at, shade, size = f"at {milliseconds(timestep)}", None, None
    if verdict.discrepancy is None:
        text, meaning = verdict.outcome.status, verdict.reason
    else:
        maxima, quantity = verdict.discrepancy.maxima(), kind.figure
        error, own = maxima[quantity.name], quantity.within_truth(maxima)
        size = error if own is None else own
        if own is not None:
            text, meaning = within(own, 2), quantity.told_within(own)
        else:
            text, meaning, shade = number(error, 2), quantity.with_unit(error), decade(error)
    return Figure(text, f"{at}: {meaning}", timestep, size, shade, failed, link, run)


def decade(error: float) -> int:
    """Return the decimal exponent of an error, limited to the range from -12 to 0.

    The result is -12 for an error of zero, and 0 for an error that is not finite.
    """
    if not math.isfinite(error):
        return 0
    return max(-12, min(0, int(f"{error:e}".partition("e")[2]))) if error else -12
