"""The matrix of a report: cases by methods, one matrix a kind of scene, each with the figure that tells most there."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bodycheck.casefile.case import Case
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.requirements import requirements
from bodycheck.reference.scene import Scene
from bodycheck.reports.lines import Key, Line
from bodycheck.reports.quantities import QUANTITIES, Quantity, bound, milliseconds, number
from bodycheck.reports.runs.findings import within_truth
from bodycheck.reports.runs.summary import key_of

#: engine, integrator, label of the set of results: what a column is of
Method = tuple[str, str, str]


@dataclass(frozen=True)
class Kind:
    """A kind of scene. name: of its anchor. quantity: the column of results that tells most of it. why: that it does."""

    name: str
    title: str
    quantity: str
    why: str


KINDS = (
    Kind(
        "turning",
        "Free flight of a turning body",
        "attitude_error",
        "No torque acts: attitude tells how well the turning is solved.",
    ),
    Kind("translation", "Flight without rotation", "position_error", "Nothing turns: position tells all."),
    Kind("drag", "Flight against drag", "position_error", "Drag acts on the centre of mass and leaves the rotation alone."),
    Kind("contact", "Contact with a plane", "position_error", "Position tells where friction takes the body."),
)


@dataclass(frozen=True)
class Figure:
    """One run. text: its figure or its status. decade: of the figure, from -12 to 0, None where there is none."""

    text: str
    meaning: str
    timestep: float
    decade: int | None = None
    failed: bool = False


@dataclass(frozen=True)
class Cell:
    """The runs of one method on one case. common: at the matrix's common time step. others: the largest step first."""

    common: Figure | None
    others: tuple[Figure, ...]

    @property
    def figures(self) -> tuple[Figure, ...]:
        """All runs, that at the common time step first."""
        return (*((self.common,) if self.common is not None else ()), *self.others)


@dataclass(frozen=True)
class Column:
    """One method, whatever its time step. results: the label of the set that its runs are of, where there are several."""

    engine: str
    integrator: str
    results: str
    colour: str


@dataclass(frozen=True)
class Row:
    """One case. words: what a reader may look for. cells: None where there is no run."""

    case: str
    words: str
    cells: tuple[Cell | None, ...]


@dataclass(frozen=True)
class Matrix:
    """All cases of one kind by the methods that any of them was run with. timestep: the common one (s)."""

    kind: Kind
    timestep: float
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]

    @property
    def quantity(self) -> Quantity:
        """What its figures are the maxima of."""
        return QUANTITIES[self.kind.quantity]

    @property
    def engines(self) -> tuple[tuple[str, int, str], ...]:
        """The engines of neighbouring columns, with the number of these and the engine's colour."""
        amounts = Counter(column.engine for column in self.columns)
        colours = {
            column.engine: column.colour for column in reversed(self.columns) if column.results == self.columns[-1].results
        }
        return tuple((engine, amount, colours[engine]) for engine, amount in amounts.items())

    @property
    def methods(self) -> int:
        """How many there are, of whatever set of results."""
        return len({(column.engine, column.integrator) for column in self.columns})

    @property
    def several_steps(self) -> bool:
        """Whether any run has another time step than the common one."""
        return any(cell.others for row in self.rows for cell in row.cells if cell is not None)


def kind_of(scene: Scene) -> Kind:
    """The kind of a scene, which follows from what it requires."""
    turning, translation, drag, contact = KINDS
    needs = requirements(scene)
    if needs.contact:
        return contact
    if needs.drag:
        return drag
    return translation if needs.rotation == "none" else turning


def matrices(cases: Mapping[str, Case], verdicts: Sequence[Verdict], lines: Mapping[Key, Line]) -> tuple[Matrix, ...]:
    """A matrix for each kind of which any case has a run, in the order of `KINDS`."""
    kinds = {name: kind_of(case.scene) for name, case in cases.items()}
    found = []
    for kind in KINDS:
        own = [verdict for verdict in verdicts if kinds[verdict.run.case] == kind]
        if own:
            found.append(_matrix(kind, {name: case for name, case in cases.items() if kinds[name] == kind}, own, lines))
    return tuple(found)


def _matrix(kind: Kind, cases: Mapping[str, Case], verdicts: Sequence[Verdict], lines: Mapping[Key, Line]) -> Matrix:
    used = {key_of(verdict) for verdict in verdicts}
    columns: dict[Method, Column] = {}
    for key, line in lines.items():
        if key in used:
            columns.setdefault(_method(line), Column(*_method(line), line.colour))
    steps = Counter(verdict.run.method.timestep for verdict in verdicts)
    common = max(steps, key=lambda step: (steps[step], step))
    by_cell: dict[tuple[str, Method], list[Figure]] = {}
    for verdict in verdicts:
        by_cell.setdefault((verdict.run.case, _method(lines[key_of(verdict)])), []).append(_figure(verdict, kind))
    rows = tuple(
        Row(
            name,
            " ".join((name, *case.tags)),
            tuple(_cell(by_cell.get((name, method), ()), common) for method in columns),
        )
        for name, case in cases.items()
    )
    return Matrix(kind, common, tuple(columns.values()), rows)


def _method(line: Line) -> Method:
    return line.engine, line.integrator, line.results


def _cell(figures: Sequence[Figure], common: float) -> Cell | None:
    if not figures:
        return None
    others = sorted((figure for figure in figures if figure.timestep != common), key=lambda figure: -figure.timestep)
    return Cell(next((figure for figure in figures if figure.timestep == common), None), tuple(others))


def _figure(verdict: Verdict, kind: Kind) -> Figure:
    timestep, failed = verdict.run.method.timestep, verdict.passed is False
    at = f"at {milliseconds(timestep)}"
    if verdict.discrepancy is None:
        return Figure(verdict.outcome.status, f"{at}: {verdict.reason}", timestep, None, failed)
    maxima, quantity = verdict.discrepancy.maxima(), QUANTITIES[kind.quantity]
    if quantity.name == "attitude_error" and within_truth(maxima):
        own = maxima["truth_error"]
        return Figure(f"≤ {bound(own, 2)}", f"{at}: within the truth's own error ({bound(own)} rad)", timestep, None, failed)
    error = maxima[quantity.name]
    return Figure(number(error, 2), f"{at}: {quantity.with_unit(error)}", timestep, decade(error), failed)


def decade(error: float) -> int:
    """The exponent of an error, from -12 for all that is smaller, zero too, to 0 for all that is larger."""
    return max(-12, min(0, int(f"{error:e}".partition("e")[2]))) if error else -12
