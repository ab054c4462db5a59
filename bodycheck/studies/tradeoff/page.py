"""The report of the tradeoff study: for each case, the error and the cost of each method, and its convergence."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

from bodycheck.judging.schemes.convergence import UNITS
from bodycheck.reports.charts import ZOOMING
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.notices import Asked, not_supported, of_header
from bodycheck.reports.quantities import Quantity, count, listing, milliseconds, number, within
from bodycheck.reports.same_algorithm import NO_CLASSES, Classes
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Unsupported
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff import batch_page
from bodycheck.studies.tradeoff import findings as tradeoff_summary
from bodycheck.studies.tradeoff.diagram import diagram
from bodycheck.studies.tradeoff.findings import falls_short
from bodycheck.studies.tradeoff.measurements import CaseMeasurements, Measured, Row, apart, method_of

#: Lines by method. A key stands for all time steps of a method, because a curve goes through all of them.
Lines = Mapping[RunKey, Line]

#: Most time steps of one method that are listed one by one.
MOST_STEPS_NAMED = 4

#: Explanations for readers.
READING = (
    "In each diagram a curve is a method, from its largest time step on the left to its smallest. It shows the largest error "
    "over the sampled instants against the computing time per simulated second. Points are the medians of repeated timings, "
    "and bars show the shortest and the longest. Rings mark the Pareto front of the methods shown: no other point is both "
    "cheaper and more accurate. Errors below the truth's own error, the grey band, have no meaning. Zeros are left "
    "out, because a log scale cannot show them.",
    f"{ZOOMING} The legend switches methods on and off in all charts; the Pareto front is then that of the other methods.",
    "An observed order p means that the error decreases like the p-th power of the time step. It is the median over the "
    "asymptotic range, which consists of the time steps at which local orders agree, and is given with the smallest and the "
    "largest; – means that no such range was found. A floor is an error that a method does not get below with any of its time "
    "steps, at the instants that all of them share: a limit, to which its runs tend, or rounding in the engine's precision. An "
    "order with a time is that of the beginning of the runs, because the attitude is lost after it at any time step. Claimed "
    "orders are for smooth motion and are not compared with orders in contact.",
    "A scheme is named if the engine's trajectory is that of the textbook scheme with the same time step, but for the rounding "
    "of the engine's precision. A method is near a scheme that leaves at most a hundredth of its error. The residual is the "
    "largest attitude difference from that scheme.",
)


def present(header: Header, rows: Sequence[Row], orders: Sequence[Order], classes: Classes = NO_CLASSES) -> StudyReport:
    """Return the contents of the report.

    Parameters
    ----------
    header
        The header of the results, with versions, machine and command.
    rows
        The rows of the study, one for each run.
    orders
        The observed orders of the methods on the cases.
    classes
        The classes of methods that are the same algorithm.
    """
    single, in_batches = apart(rows)
    by_case: dict[str, list[Row]] = defaultdict(list)
    for row in single:
        by_case[row["case"]].append(row)
    batches_by_case: dict[str, list[Row]] = defaultdict(list)
    for row in in_batches:
        batches_by_case[row["case"]].append(row)
    orders_by_case: dict[str, list[Order]] = defaultdict(list)
    for order in orders:
        orders_by_case[order.case].append(order)
    cases = [
        CaseMeasurements(name, tuple(case_rows), tuple(orders_by_case[name]), tuple(batches_by_case[name]))
        for name, case_rows in by_case.items()
    ]
    lines = assign(method_of(row) for row in rows)
    return StudyReport(
        title="What accuracy costs",
        headline=_headline(cases, lines),
        header=header,
        notices=(*_notices(header, single), *(batch_page.notices(rows) if in_batches else ())),
        findings=tradeoff_summary.findings(cases, lines, classes),
        parts=tuple(_part(case, lines) for case in cases),
        reading=(*READING, *(batch_page.READING if in_batches else ())),
    )


def _headline(cases: Sequence[CaseMeasurements], lines: Lines) -> str:
    runs = sum(len(case.rows) for case in cases)
    completed = sum(row["status"] == "ok" for case in cases for row in case.rows)
    without = f", {runs - completed} of them without results" if completed < runs else ""
    return f"{count(len(lines), 'method')} on {count(len(cases), 'case')}: {count(runs, 'run')}{without}"


def _notices(header: Header, rows: Sequence[Row]) -> tuple[str, ...]:
    asked = (
        Asked(row["case"], row["engine"], row["version"], row["reason"] if row["status"] == Unsupported.status else "")
        for row in rows
    )
    return (*of_header(header), *not_supported(asked))


def _part(case: CaseMeasurements, lines: Lines) -> Part:
    drawn = {name: case.points(name) for name in case.quantities}
    methods = {point.method for points in drawn.values() for point in points}
    tables = []
    if case.orders:
        tables.append(("Orders", _orders(case)))
    if case.primary is not None:
        tables.append((f"Pareto front of the {case.primary}", _front(case, case.primary)))
    if case.batches:
        tables.append(("Batches", batch_page.table(case)))
    return Part(
        name=case.name,
        title=case.name,
        texts=(*_failures(case.rows), *(() if drawn else ("No run of this case has both an error and a cost.",))),
        charts=(
            *(_chart(case, name, quantity, lines) for name, quantity in case.quantities.items()),
            *batch_page.charts(case, lines),
        ),
        tables=tuple(tables),
        lines=tuple(line for key, line in lines.items() if key in methods),
    )


def _failures(rows: Sequence[Row]) -> tuple[str, ...]:
    """Return a sentence for each status other than ok, with the methods and time steps of the runs that have it."""
    steps: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        if row["status"] != "ok":
            steps[row["status"]][f"{row['engine']} {row['integrator']}"].append(row["timestep"])
    return tuple(
        f"Runs with the status {status} have no results: "
        + "; ".join(f"{method} at {_steps(timesteps)}" for method, timesteps in methods.items())
        + "."
        for status, methods in steps.items()
    )


def _steps(timesteps: Sequence[float]) -> str:
    texts = [milliseconds(timestep, 4) for timestep in sorted(timesteps, reverse=True)]
    return listing(texts) if len(texts) <= MOST_STEPS_NAMED else f"{len(texts)} time steps from {texts[0]} to {texts[-1]}"


def _chart(case: CaseMeasurements, name: str, quantity: Quantity, lines: Lines) -> Chart:
    points, front, truth_error = case.points(name), case.front(name), case.truth_error(name)
    by_method = {point.method: lines[point.method] for point in points}
    ends = [_point_text(point, quantity, lines) for point in (front[0], front[-1])]
    alt = (
        f"{quantity.title} against computing time per simulated second on log scales, for {count(len(by_method), 'method')}. "
        f"The Pareto front has {count(len(front), 'point')}: {_range(ends)}."
    )
    zero = listing(list(dict.fromkeys(by_method[p.method].label for p in points if p.error == 0)))
    return Chart(
        title=quantity.title,
        specification=diagram(quantity, points, by_method, truth_error),
        alt=alt,
        notes=(f"Errors of zero, which are not drawn, occur with {zero}.",) if zero else (),
    )


def _point_text(point: Measured, quantity: Quantity, lines: Lines) -> str:
    label = lines[point.method].label
    return f"{quantity.with_unit(point.error)} for {number(point.cost, 3)} s with {label} at {point.setting}"


def _orders(case: CaseMeasurements) -> Table:
    """Return a table with a row of orders for each method, and with columns for floors and schemes if any method has them."""
    methods: dict[RunKey, dict[str, Order]] = defaultdict(dict)
    for order in case.orders:
        methods[order.method][order.quantity] = order
    ordered = [name for name in UNITS if name in case.quantities]
    floored = [
        name
        for name in ordered
        if any(name in by_quantity and by_quantity[name].floor is not None for by_quantity in methods.values())
    ]
    schemes = any(order.nearest_scheme for order in case.orders)
    words = ("Engine", "Integrator", *(("Scheme",) if schemes else ()))
    figures = (
        *(("Residual, rad",) if schemes else ()),
        "Claimed",
        *(f"{_title(name)} order" for name in ordered),
        *(f"{_title(name)} floor, {_unit(name)}" for name in floored),
    )
    rows = []
    for by_quantity in methods.values():
        first = next(iter(by_quantity.values()))
        named = Entry(first.scheme_in_words or "not identified"), _figure(first.scheme_residual)
        scheme, residual = (named[:1], named[1:]) if schemes else ((), ())
        claimed = Entry("–") if first.claimed is None else Entry(str(first.claimed), first.claimed)
        observed = [_observed(by_quantity.get(name)) for name in ordered]
        floors = [_floor(by_quantity.get(name), case.truth_error(name)) for name in floored]
        names = Entry(f"{first.engine} {first.version}".rstrip()), Entry(first.integrator)
        rows.append((*names, *scheme, *residual, claimed, *observed, *floors))
    short = tuple(any(falls_short(case, order) for order in by_quantity.values()) for by_quantity in methods.values())
    return Table(
        columns=words + figures,
        numeric=(False,) * len(words) + (True,) * len(figures),
        rows=tuple(rows),
        failed=short,
        notes=("In coloured rows the observed order of attitude or position is lower than claimed.",) if any(short) else (),
    )


def _observed(order: Order | None) -> Entry:
    if order is None or order.order is None or order.order_low is None or order.order_high is None:
        return Entry("–")
    median, low, high = (f"{value:.2f}" for value in (order.order, order.order_low, order.order_high))
    beginning = "" if order.horizon is None else f" in {number(order.horizon, 3)} s"
    return Entry((median if low == high else f"{median} ({low}–{high})") + beginning, order.order)


def _floor(order: Order | None, truth_error: float) -> Entry:
    floor = None if order is None else order.floor
    if floor is not None and floor <= truth_error:
        return Entry(within(truth_error, 2), None, "within the truth's own error")
    if order is not None and floor is not None and order.floor_cause:
        return Entry(f"{number(floor, 3)} ({order.floor_cause})", floor)
    return _figure(floor)


def _figure(value: float | None) -> Entry:
    return Entry(number(value, 3), value)


def _title(quantity: str) -> str:
    return quantity.replace("_", " ").capitalize()


def _unit(quantity: str) -> str:
    return UNITS[quantity] or "relative"


def _range(ends: Sequence[str]) -> str:
    """Return the first and the last point of a front, or its only point, in words."""
    first, last = ends
    return first if first == last else f"from {first} to {last}"


def _front(case: CaseMeasurements, name: str) -> Table:
    """Return the table of the runs of a Pareto front, the cheapest first."""
    words = ("Engine", "Integrator", "Time step")
    figures = (
        case.quantities[name].label,
        "Computing time, s",
        "Shortest, s",
        "Longest, s",
        "Real-time factor",
        "Evaluations per step",
    )
    truth_error = case.truth_error(name)
    rows = tuple(
        (
            Entry(f"{point.engine} {point.version}".rstrip()),
            Entry(point.integrator),
            Entry(milliseconds(point.timestep, 4)),
            _floored(point.error, truth_error),
            *map(_figure, (point.cost, point.cost_low, point.cost_high, 1 / point.cost, case.row(point).get("evaluations"))),
        )
        for point in case.front(name)
    )
    return Table(
        columns=words + figures,
        numeric=(False,) * len(words) + (True,) * len(figures),
        rows=rows,
        failed=(False,) * len(rows),
        notes=(
            "No other run is both cheaper and more accurate than one of these. The computing time is that of one simulated "
            "second: the median of repeated timings, with the shortest and the longest of them.",
        ),
    )


def _floored(error: float, truth_error: float) -> Entry:
    """Return the cell of an error on a front. An error below the truth's own error is written as lying within it."""
    if 0 < truth_error >= error:
        return Entry(within(truth_error), None, "within the truth's own error")
    return Entry(number(error), error)
