"""The tables of the report of an ensemble."""

from collections.abc import Sequence

from bodycheck.reports.lines import Line, assign
from bodycheck.reports.quantities import QUANTITIES, milliseconds, number
from bodycheck.reports.tables import Entry, Table
from bodycheck.studies.ensemble.findings.aggregates import Aggregates, Distribution, Figure, Method
from bodycheck.studies.ensemble.findings.sensitivity import FAILURE, RELEVANT, Dependence

#: Most rows of the table of dependences; sensitivity.csv has all.
MOST_DEPENDENCES = 60

#: The columns that identify the method of a row.
KEYS = ("Engine", "Integrator", "Time step")


def percent(share: float, digits: int = 2) -> str:
    """Return a share as a percentage with this number of significant digits."""
    return f"{number(100 * share, digits)} %"


def share_text(method: Method) -> str:
    """Return the share of the members that failed, with its interval, as a phrase."""
    assert method.failed is not None  # because some members failed
    low, high = percent(method.failed.low), percent(method.failed.high)
    return f"{percent(method.failed.value)} of the members (confidence interval {low} to {high})"


def method_lines(ensemble: Aggregates) -> list[Line]:
    """Return the line of each method, in the order of the methods."""
    keys = [method.engine_method.key("") for method in ensemble.methods]
    assigned = assign(keys)
    return [assigned[key] for key in keys]


def method_table(ensemble: Aggregates, lines: Sequence[Line]) -> Table:
    """Return the table of methods, the best first."""
    figure = ensemble.figures.get(ensemble.ranking)
    quantity = QUANTITIES[ensemble.ranking] if figure is not None else None
    heads = (f"Median {quantity.label.lower()}", "99 %", "Largest", "Smallest in") if quantity is not None else ()
    rows = []
    for index in ensemble.ranked:
        method = ensemble.methods[index]
        assert method.failed is not None  # it has members
        cells = [Entry(str(method.members), method.members), _share(method.failed.value)]
        cells += [Entry(f"{percent(method.failed.low)} to {percent(method.failed.high)}", method.failed.high)]
        if figure is not None:
            cells += _quantiles(figure.distributions.get(index), ("q50", "q99"), with_intervals=False)
            cells += [_share(figure.best[index]) if index in figure.best else Entry("–")]
        each = 1e6 * method.wall_time / method.members
        rows.append((*_key(lines[index], method), *cells, Entry(number(each, 3), each)))
    columns = (*KEYS, "Members", "Failed", "Interval", *heads, "Time per member, µs")
    notes = ("“Smallest in” is the share of the members in which the method has the smallest figure of all methods.",)
    return Table(
        columns=columns,
        numeric=(False,) * len(KEYS) + (True,) * (len(columns) - len(KEYS)),
        rows=tuple(rows),
        failed=tuple(bool(ensemble.methods[index].ways) for index in ensemble.ranked),
        notes=notes if figure is not None and figure.best else (),
    )


def ways_table(ensemble: Aggregates, lines: Sequence[Line]) -> Table:
    """Return the table of the ways in which members failed, with the first member of each."""
    rows = [
        (
            *_key(line, method),
            Entry(way.name),
            Entry(str(way.count), way.count),
            _share(way.count / method.members),
            Entry(str(way.first), way.first),
            Entry(way.reason),
        )
        for method, line in zip(ensemble.methods, lines, strict=True)
        for way in method.ways
    ]
    return Table(
        columns=(*KEYS, "How", "Members", "Share", "First member", "Reason"),
        numeric=(False, False, False, False, True, True, True, False),
        rows=tuple(rows),
        failed=(True,) * len(rows),
        notes=("The reason is that of the first member.",),
    )


def figure_table(figure: Figure, lines: Sequence[Line]) -> Table:
    """Return the table of the quantiles of one figure."""
    rows = tuple(
        (
            *(Entry(text) for text in (lines[index].engine, lines[index].integrator, milliseconds(lines[index].timestep))),
            Entry(str(distribution.count), distribution.count),
            *_quantiles(distribution, ("q05", "q50", "q95", "q99")),
            Entry(str(distribution.worst), distribution.worst),
        )
        for index, distribution in figure.distributions.items()
    )
    return Table(
        columns=(*KEYS, "Members", "5 %", "Median", "95 %", "99 %", "Largest", "In member"),
        numeric=(False,) * len(KEYS) + (True,) * 7,
        rows=rows,
        failed=(False,) * len(rows),
        notes=("Intervals of the median and of the 99 % quantile are in brackets.",),
    )


def dependence_table(dependences: Sequence[Dependence], lines: Sequence[Line]) -> Table:
    """Return the table of the strongest dependences on drawn numbers."""
    relevant = sorted((one for one in dependences if one.share >= RELEVANT), key=lambda one: -one.share)
    shown = relevant[:MOST_DEPENDENCES]
    rows = tuple(
        (
            Entry(lines[one.method].label),
            Entry("failure" if one.figure == FAILURE else QUANTITIES[one.figure].title),
            Entry(one.number),
            Entry(number(one.share, 2), one.share),
            Entry(number(one.rank_correlation, 2), one.rank_correlation),
        )
        for one in shown
    )
    less = len(dependences) - len(shown)
    return Table(
        columns=("Method", "Figure", "Drawn number", "Share of the variance", "Rank correlation"),
        numeric=(False, False, False, True, True),
        rows=rows,
        failed=(False,) * len(rows),
        notes=(f"The file sensitivity.csv also has the {less} weaker ones.",) if less else (),
    )


def worst_table(ensemble: Aggregates, lines: Sequence[Line]) -> Table:
    """Return a table that has, for each method and figure, the member with the largest value."""
    rows = [
        (
            *_key(line, method),
            Entry(QUANTITIES[name].title),
            Entry(QUANTITIES[name].with_unit(distribution.largest), distribution.largest),
            Entry(str(distribution.worst), distribution.worst),
        )
        for index, (method, line) in enumerate(zip(ensemble.methods, lines, strict=True))
        for name, figure in ensemble.figures.items()
        if (distribution := figure.distributions.get(index)) is not None
        and distribution.largest > 0
        and QUANTITIES[name].bounded
    ]
    return Table(
        columns=(*KEYS, "Figure", "Largest", "Member"),
        numeric=(False, False, False, False, True, True),
        rows=tuple(rows),
        failed=(False,) * len(rows),
        notes=("The command bodycheck ensemble CASE --member K --write FILE writes member K as a case file.",),
        keys=3,
    )


def file_table(files: Sequence[tuple[int, str, str]]) -> Table:
    """Return the table of case files of worst members: the number of the member, the name of the file, and the failure."""
    rows = tuple((Entry(name or "–"), Entry(str(member), member), Entry(title)) for member, name, title in files)
    return Table(
        columns=("Case file", "Member", "Reason"),
        numeric=(False, True, False),
        rows=rows,
        failed=(False,) * len(rows),
        notes=(),
        keys=1,
    )


def _key(line: Line, method: Method) -> tuple[Entry, Entry, Entry]:
    engine = f"{line.engine} {method.engine_method.version}".rstrip()
    return Entry(engine), Entry(line.integrator), Entry(milliseconds(line.timestep))


def _share(value: float) -> Entry:
    return Entry(percent(value), value)


def _quantiles(distribution: Distribution | None, names: Sequence[str], with_intervals: bool = True) -> list[Entry]:
    """Return the cells of quantiles, with their intervals where these are known, and of the largest value."""
    if distribution is None:
        return [Entry("–")] * (len(names) + 1)
    cells = []
    for name in names:
        value, interval = distribution.quantiles[name], distribution.intervals.get(name)
        text = number(value, 3)
        if with_intervals and interval is not None and interval[0] < interval[1]:
            text += f" ({number(interval[0], 3)}–{number(interval[1], 3)})"
        cells.append(Entry(text, value))
    return [*cells, Entry(number(distribution.largest, 3), distribution.largest)]
