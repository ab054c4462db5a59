"""The report of the study of extremes: first the errors that engines did not report, then the outcomes and the stability."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Any

from bodycheck.casefile.axes import AXES
from bodycheck.reports.finding import Finding
from bodycheck.reports.notices import Asked, not_supported, of_header
from bodycheck.reports.quantities import count, listing, milliseconds, number, verb
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.studies.extremes.outcome_map import outcome_map
from bodycheck.studies.extremes.rows import HEALTHY, STATUSES, Limit, Row

#: Most values that are listed one by one.
MOST_VALUES = 4

#: Statuses of runs that broke down.
BROKEN = ("diverged", "reset", "crashed", "frozen")

#: Anchors of the parts about all cases.
UNREPORTED, STABILITY = "unreported-errors", "stability"

#: Titles of these parts.
UNREPORTED_TITLE, STABILITY_TITLE = "Errors that the engine did not report", "Stability"

#: Explanations for readers.
READING = (
    "The status of a run says how it ended. ok: the attitude is within 1 rad of the truth, the centre of mass within 1 % of "
    "the distance travelled, and the rotational energy within 1 % of its initial value. inaccurate: the motion is bounded, but "
    "one of these limits is exceeded. energy-gain and energy-loss: the rotational energy changes in one direction by more than "
    "1 %. frozen: a value that should change stays the same to the last bit. diverged: a value is not a number or out of all "
    "bounds, or the engine gave up. reset: the engine warned of a bad state, put the body back to a state of its own and "
    "continued. crashed: there was an error, or the process died. timeout: the run did not end in the time allowed. "
    "unsupported: the engine refused the run.",
    "An engine reported no problem if it stepped to the end and signalled nothing; the column engine_said of extremes.csv "
    "is then “healthy”. That file has every run, with what the engine reported and what the states show.",
    "A time step is stable if the run completes 100 turns and the rotational energy never reaches twice its initial "
    "value. A method that gains a little energy in every step has no such limit in the strict sense. The number then "
    "shows how small the time step must be for 100 turns.",
)


def present(header: Header, rows: Sequence[Row], limits: Sequence[Limit]) -> StudyReport:
    """Return the contents of the report, from the header of the results, and the rows and limits in the order of the study."""
    unreported = [row for row in rows if row.believed]
    cases: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        cases[row.case].append(row)
    runs = count(len(rows), "run")
    return StudyReport(
        title="Where engines stop being correct",
        headline=f"In {len(unreported)} of {runs} the engine reported no problem although the result is wrong",
        header=header,
        notices=_notices(header, rows),
        findings=(*_unreported(rows), *_long_runs(rows), *_resets(rows), *_stability(limits), *_killed(rows)),
        parts=(
            *((_unreported_errors(unreported),) if unreported else ()),
            *(_case(name, case_rows) for name, case_rows in cases.items()),
            *((_limits(limits),) if limits else ()),
        ),
        reading=READING,
    )


def _notices(header: Header, rows: Sequence[Row]) -> tuple[str, ...]:
    asked = (Asked(row.case, row.engine, row.version, row.detail if row.status == "unsupported" else "") for row in rows)
    return (*of_header(header), *not_supported(asked))


def _unreported(rows: Sequence[Row]) -> list[Finding]:
    kinds = Counter(row.status for row in rows if row.believed)
    if not kinds:
        return []
    text = listing([f"{amount} with the status {status}" for status, amount in kinds.most_common()])
    runs = count(kinds.total(), "run")
    before = f"In {runs} the engine reported no problem although the result is wrong: {text}. See the part “"
    return [Finding("Unreported errors", before, UNREPORTED, "”.", UNREPORTED_TITLE)]


def _long_runs(rows: Sequence[Row]) -> list[Finding]:
    """Return findings about methods that complete some runs without a warning but break down in longer runs."""
    runs: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        if row.axis == "steps":
            runs[row.case, _method(row)].append(row)
    breaks: dict[tuple[str, str], list[str]] = defaultdict(list)
    for (case, method), method_rows in runs.items():
        ordered = sorted(method_rows, key=lambda row: row.value)
        endured = [row for row in ordered if row.engine_said == HEALTHY and row.status not in BROKEN]
        broken = [row for row in ordered if row.status in BROKEN]
        if endured and broken and broken[0].value > endured[-1].value:
            words = broken[0].engine_said if broken[0].engine_said != HEALTHY else broken[0].detail
            steps = f"{_figure(endured[-1].value)} steps without a warning, but a run of {_figure(broken[0].value)} steps fails"
            breaks[case, f"{steps}: {words}."].append(method)
    return [
        Finding("Long runs", "In ", case, f", a run with {listing(methods)} completes {ends}")
        for (case, ends), methods in breaks.items()
    ]


def _resets(rows: Sequence[Row]) -> list[Finding]:
    resets = [row for row in rows if row.status == "reset"]
    axes: dict[str, list[Row]] = defaultdict(list)
    for row in resets:
        axes[row.axis].append(row)
    if not resets:
        return []
    mildest = [min(axis_rows, key=lambda row: row.value) for axis_rows in axes.values()]
    smallest = verb(len(resets), "the", "the smallest")
    places = [
        f"{smallest} {_axis(row.axis)} is {_value(row)} at a time step of {milliseconds(row.timestep)}" for row in mildest
    ]
    engines = listing(sorted({row.engine for row in resets}))
    runs = count(len(resets), "run")
    where = f"{verb(len(resets), 'In this run', 'Among these runs')}, {listing(places)}."
    return [Finding("Resets", f"{engines} gave a warning in {runs}, reset the simulation and continued. {where}")]


def _stability(limits: Sequence[Limit]) -> list[Finding]:
    """Return findings about the largest stable products of spin and time step, and about spins without a stable time step."""
    products: dict[str, list[str]] = defaultdict(list)
    for method, method_limits in _by_method(limits).items():
        known = sorted(limit.spin_times_step for limit in method_limits if limit.spin_times_step is not None)
        if known:
            ends = dict.fromkeys(number(end, 3) for end in (known[0], known[-1]))
            products[" to ".join(ends)].append(method)
    none = defaultdict(list)
    for limit in limits:
        if limit.spin_times_step is None:
            none[limit.spin].append(_method(limit))
    sentences = []
    if products:
        texts = [f"{product} rad with {listing(methods)}" for product, methods in products.items()]
        before = f"The largest rotation in a stable time step is {'; it is '.join(texts)}. See the part “"
        sentences.append(Finding("Stability", before, STABILITY, "”.", STABILITY_TITLE))
    if none:
        texts = [f"at {_figure(spin)} rad/s with {listing(methods)}" for spin, methods in none.items()]
        sentences.append(Finding("Unstable", f"No time step is stable {listing(texts)}."))
    return sentences


def _killed(rows: Sequence[Row]) -> list[Finding]:
    dead = Counter(row.status for row in rows if row.status in ("crashed", "timeout"))
    methods = sorted({_method(row) for row in rows if row.status in dead})
    if not dead:
        return []
    text = listing([f"{count(amount, 'run')} with the status {status}" for status, amount in dead.items()])
    these = verb(dead.total(), "This was a run", "These were runs")
    return [Finding("No result", f"{text} gave no result. {these} with {listing(methods, MOST_VALUES, 'method')}.")]


def _unreported_errors(rows: Sequence[Row]) -> Part:
    """Return the part about runs whose engine reported no problem.

    Runs are grouped by case, axis, values, status and reason. Methods for which all of these are equal share a row.
    """
    groups: dict[tuple[str, str, str, str], list[Row]] = defaultdict(list)
    for row in rows:
        groups[row.case, row.axis, row.status, _method(row)].append(row)
    merged: dict[tuple[str, str, str, str, str], list[str]] = defaultdict(list)
    for (case, axis, status, method), same in groups.items():
        merged[case, _axis(axis), _values(same), status, same[0].detail].append(method)
    ordered = sorted(merged.items(), key=lambda group: -STATUSES.index(group[0][3]))
    table = Table(
        columns=("Case", "Method", "Axis", "Values", "Status", "Reason"),
        numeric=(False,) * 6,
        rows=tuple(tuple(map(Entry, (case, listing(methods), *seen))) for (case, *seen), methods in ordered),
        failed=(True,) * len(ordered),
        notes=("The reason is that of the first of these runs.",),
    )
    text = "The engine stepped to the end and reported no problem. A caller who does not check the result takes it for correct."
    return Part(UNREPORTED, UNREPORTED_TITLE, (text,), (), (("Runs by outcome", table),))


def _case(name: str, rows: Sequence[Row]) -> Part:
    axes: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        axes[row.axis].append(row)
    maps = axes["spin"] if len({row.timestep for row in axes.get("spin", ())}) > 1 else []
    charts = tuple(_map(methods, axis_rows) for methods, axis_rows in _by_outcomes(maps))
    tables = tuple((f"Outcomes by {_axis(axis)}", _outcomes(axis, axis_rows)) for axis, axis_rows in axes.items() if axis_rows)
    return Part(name, name, (), charts, tables)


def _map(methods: str, rows: Sequence[Row]) -> Chart:
    kinds = Counter(row.status for row in rows)
    outcomes = listing([f"{amount} {status}" for status, amount in kinds.most_common()])
    return Chart(methods, outcome_map(rows), f"The chart shows the outcomes of {methods} by spin and time step: {outcomes}.")


def _outcomes(axis: str, rows: Sequence[Row]) -> Table:
    """Return the table of outcomes by value and method. Methods with the same outcomes at all points share a column."""
    columns = _by_outcomes(rows)
    several = len({row.timestep for row in rows}) > 1 and axis != "timestep"
    places = [(_value(row), milliseconds(row.timestep)) for row in columns[0][1]]
    heads = (_axis(axis).capitalize(), *(("Time step",) if several else ()))
    return Table(
        columns=(*heads, *(methods for methods, _ in columns)),
        numeric=(False,) * (len(heads) + len(columns)),
        rows=tuple(
            tuple(map(Entry, (*point[: len(heads)], *(method_rows[index].status for _, method_rows in columns))))
            for index, point in enumerate(places)
        ),
        failed=(False,) * len(places),
        notes=(),
        keys=len(heads),
    )


def _by_outcomes(rows: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    """Return groups of methods with the same outcomes at all points: their names as a list in words, and the runs of the first.

    The runs of all methods must be at the same points, in the same order.
    """
    groups: dict[tuple[str, ...], list[tuple[str, list[Row]]]] = defaultdict(list)
    for method, method_rows in _by_method(rows).items():
        groups[tuple(row.status for row in method_rows)].append((method, method_rows))
    return [(listing([method for method, _ in group]), group[0][1]) for group in groups.values()]


def _limits(limits: Sequence[Limit]) -> Part:
    spins = list(dict.fromkeys(limit.spin for limit in limits))
    by_method = {key: {limit.spin: limit for limit in method_limits} for key, method_limits in _by_method(limits).items()}
    rows = []
    for method, method_limits in by_method.items():
        figures = [method_limits[spin].spin_times_step if spin in method_limits else None for spin in spins]
        rows.append((Entry(method), *(Entry(number(figure, 3), figure) for figure in figures)))
    table = Table(
        columns=("Method", *(f"{_figure(spin)} rad/s" for spin in spins)),
        numeric=(False, *(True for _ in spins)),
        rows=tuple(rows),
        failed=(False,) * len(rows),
        notes=("– means that no time step that was tried is stable.",),
        keys=1,
    )
    text = "The table shows how far the body turns in the largest stable time step, in rad. The time steps are in limits.csv."
    return Part(STABILITY, STABILITY_TITLE, (text,), (), (("Largest stable product of spin and time step, rad", table),))


def _by_method(rows: Sequence[Any]) -> dict[str, list[Any]]:
    by_method: dict[str, list[Any]] = defaultdict(list)
    for row in rows:
        by_method[_method(row)].append(row)
    return by_method


def _method(row: Row | Limit) -> str:
    return f"{row.engine} {row.integrator}"


def _axis(axis: str) -> str:
    """Return the title of an axis for use inside a sentence: in lower case, unless it begins with a symbol."""
    title = AXES[axis].title
    return title.lower() if title[:2].isalpha() else title


def _unit(axis: str) -> str:
    return AXES[axis].unit.replace("^2", "²")


def _value(row: Row) -> str:
    return f"{_figure(row.value)} {_unit(row.axis)}".rstrip()


def _values(rows: Sequence[Row]) -> str:
    """Return the values of runs in words, and the range of their time steps if there are several."""
    values = sorted({row.value for row in rows})
    unit = _unit(rows[0].axis)
    listed = listing([_figure(value) for value in values]) if len(values) <= MOST_VALUES else _range(values)
    steps = sorted({row.timestep for row in rows})
    at = f", {milliseconds(steps[0])} to {milliseconds(steps[-1])}" if len(steps) > 1 and rows[0].axis != "timestep" else ""
    return f"{listed} {unit}".rstrip() + at


def _range(values: Sequence[float]) -> str:
    return f"{len(values)} from {_figure(values[0])} to {_figure(values[-1])}"


def _figure(value: float) -> str:
    """Return a value of an axis as text, with as many digits as were given."""
    return number(value, 4 if float(f"{value:.4g}") == value else 15)
