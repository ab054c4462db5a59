"""The report of the tradeoff study: what an error costs with each method, and how the methods converge, case by case."""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence

from bodycheck.judging.convergence import UNITS
from bodycheck.reports.charts import ZOOMING
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.quantities import Quantity, bound, count, listing, milliseconds, number
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.running.header import Header
from bodycheck.running.key import RunKey
from bodycheck.running.outcome import Unsupported
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff import findings as tradeoff_summary
from bodycheck.studies.tradeoff.diagram import diagram
from bodycheck.studies.tradeoff.findings import falls_short
from bodycheck.studies.tradeoff.measurements import CaseMeasurements, Row
from bodycheck.studies.tradeoff.recommendation import Measured

#: By method with any time step: a curve goes through all time steps.
Lines = Mapping[RunKey, Line]

#: Time steps of one method without figures that are listed.
MOST_STEPS_NAMED = 4

READING = (
    "In each diagram a curve is a method, from its largest time step at the left to its smallest: errors, the largest over the "
    "sampled instants, against the computing time that a simulated second takes. The bars are the least and the most of the "
    "repeated timings, the points their median. Rings mark the Pareto front of the methods shown: no other point is both "
    "cheaper and closer. Below the truth's own error, the grey band, an attitude error says nothing; zeros have no place on a "
    "log scale and are left out.",
    f"{ZOOMING} The legend switches methods on and off in all charts; the front is then that of the others.",
    "An observed order p says that an error shrinks like the p-th power of the time step. It is the median over the asymptotic "
    "range, the steps at which local orders agree, and stands with its least and its most; – where no such range was found. A "
    "floor is an error below which a method does not get with any of its time steps, at the instants that all of them share. A "
    "scheme is named where the engine's trajectory is that of the textbook scheme, stepped with the same time step; the "
    "residual is the largest attitude difference from the nearest one. What is claimed of an integrator is claimed of smooth "
    "motion, and not held against it in contact.",
)


def present(header: Header, rows: Sequence[Row], orders: Sequence[Order]) -> StudyReport:
    """What the study's report says.

    header: as that of results. rows: of the study, one a run. orders: of its methods on its cases.
    """
    by_case: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        by_case[row["case"]].append(row)
    orders_by_case: dict[str, list[Order]] = defaultdict(list)
    for order in orders:
        orders_by_case[order.case].append(order)
    cases = [CaseMeasurements(name, tuple(own), tuple(orders_by_case[name])) for name, own in by_case.items()]
    lines = _lines(rows)
    return StudyReport(
        title="What accuracy costs",
        headline=_headline(cases, lines),
        header=header,
        notices=_notices(header, rows),
        findings=tradeoff_summary.findings(cases, lines),
        parts=tuple(_part(case, lines) for case in cases),
        reading=READING,
    )


def _lines(rows: Sequence[Row]) -> Lines:
    return assign(RunKey.of_method(row["engine"], row["integrator"]) for row in rows)


def _headline(cases: Sequence[CaseMeasurements], lines: Lines) -> str:
    runs = sum(len(case.rows) for case in cases)
    completed = sum(row["status"] == "ok" for case in cases for row in case.rows)
    without = f", {runs - completed} of them without figures" if completed < runs else ""
    return f"{count(len(lines), 'method')} on {count(len(cases), 'case')}, {count(runs, 'run')}{without}"


def _notices(header: Header, rows: Sequence[Row]) -> tuple[str, ...]:
    missing = [f"Without the engine {engine}: {reason}." for engine, reason in header["missing"].items()]
    unsupported = Counter(row["reason"] for row in rows if row["status"] == Unsupported.status)
    return (*missing, *(f"{count(amount, 'run')} unsupported: {reason}." for reason, amount in unsupported.items()))


def _part(case: CaseMeasurements, lines: Lines) -> Part:
    drawn = {name: case.points(name) for name in case.quantities}
    methods = {point.method for points in drawn.values() for point in points}
    tables = []
    if case.orders:
        tables.append(("Orders", _orders(case)))
    if case.primary is not None:
        tables.append((f"Pareto front of the {case.primary}", _front(case, case.primary)))
    return Part(
        name=case.name,
        title=case.name,
        texts=(*_failures(case.rows), *(() if drawn else ("No run of this case has both an error and a cost.",))),
        charts=tuple(_chart(case, name, quantity, lines) for name, quantity in case.quantities.items()),
        tables=tuple(tables),
        lines=tuple(line for key, line in lines.items() if key in methods),
    )


def _failures(rows: Sequence[Row]) -> tuple[str, ...]:
    """Which methods have no figures at which time steps, a sentence a status."""
    steps: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        if row["status"] != "ok":
            steps[row["status"]][f"{row['engine']} {row['integrator']}"].append(row["timestep"])
    return tuple(
        f"Without figures, {status}: " + "; ".join(f"{method} at {_steps(own)}" for method, own in methods.items()) + "."
        for status, methods in steps.items()
    )


def _steps(timesteps: Sequence[float]) -> str:
    texts = [milliseconds(timestep, 4) for timestep in sorted(timesteps, reverse=True)]
    return listing(texts) if len(texts) <= MOST_STEPS_NAMED else f"{len(texts)} time steps from {texts[0]} to {texts[-1]}"


def _chart(case: CaseMeasurements, name: str, quantity: Quantity, lines: Lines) -> Chart:
    points, front, truth_error = case.points(name), case.front(name), case.truth_error(name)
    by_method = {point.method: lines[point.method] for point in points}
    ends = [_told(point, quantity, lines) for point in (front[0], front[-1])]
    alt = (
        f"{quantity.title} against computing time for a simulated second on log scales, {count(len(by_method), 'method')}. "
        f"The Pareto front has {count(len(front), 'point')}: {' to '.join(dict.fromkeys(ends))}."
    )
    zero = listing(list(dict.fromkeys(by_method[p.method].label for p in points if p.error == 0)))
    return Chart(
        title=quantity.title,
        specification=diagram(quantity, points, by_method, truth_error),
        alt=alt,
        notes=(f"With errors of zero, which are not drawn: {zero}.",) if zero else (),
    )


def _told(point: Measured, quantity: Quantity, lines: Lines) -> str:
    label, step = lines[point.method].label, milliseconds(point.timestep, 4)
    return f"{quantity.with_unit(point.error)} for {number(point.cost, 3)} s with {label} at {step}"


def _orders(case: CaseMeasurements) -> Table:
    """A row a method: its order in each quantity, its floors where it has any, and its scheme where the case tells schemes."""
    methods: dict[RunKey, dict[str, Order]] = defaultdict(dict)
    for order in case.orders:
        methods[order.method][order.quantity] = order
    told = [name for name in UNITS if name in case.quantities]
    floored = [name for name in told if any(name in own and own[name].floor is not None for own in methods.values())]
    schemes = any(order.scheme or (order.scheme_residual or 0.0) > case.truth_error("attitude") for order in case.orders)
    words = ("Engine", "Integrator", *(("Scheme",) if schemes else ()))
    figures = (
        *(("Residual, rad",) if schemes else ()),
        "Claimed",
        *(f"{_title(name)} order" for name in told),
        *(f"{_title(name)} floor, {_unit(name)}" for name in floored),
    )
    rows = []
    for own in methods.values():
        first = next(iter(own.values()))
        scheme, residual = ((Entry(first.scheme or "–"),), (_figure(first.scheme_residual),)) if schemes else ((), ())
        claimed = Entry("–") if first.claimed is None else Entry(str(first.claimed), first.claimed)
        observed = [_observed(own.get(name)) for name in told]
        floors = [_floor(own.get(name), case.truth_error(name)) for name in floored]
        names = Entry(f"{first.engine} {first.version}".rstrip()), Entry(first.integrator)
        rows.append((*names, *scheme, *residual, claimed, *observed, *floors))
    short = tuple(any(falls_short(case, order) for order in own.values()) for own in methods.values())
    return Table(
        columns=words + figures,
        numeric=(False,) * len(words) + (True,) * len(figures),
        rows=tuple(rows),
        failed=short,
        notes=("Coloured: the order observed in attitude or position falls short of what is claimed.",) if any(short) else (),
    )


def _observed(order: Order | None) -> Entry:
    if order is None or order.order is None or order.order_low is None or order.order_high is None:
        return Entry("–")
    median, low, high = (f"{value:.2f}" for value in (order.order, order.order_low, order.order_high))
    return Entry(median if low == high else f"{median} ({low}–{high})", order.order)


def _floor(order: Order | None, truth_error: float) -> Entry:
    floor = None if order is None else order.floor
    if floor is not None and floor <= truth_error:
        return Entry(f"≤ {bound(truth_error, 2)}", None, "within the truth's own error")
    return _figure(floor)


def _figure(value: float | None) -> Entry:
    return Entry(number(value, 3), value)


def _title(quantity: str) -> str:
    return quantity.replace("_", " ").capitalize()


def _unit(quantity: str) -> str:
    return UNITS[quantity] or "relative"


def _front(case: CaseMeasurements, name: str) -> Table:
    """The runs of a Pareto front, the cheapest first."""
    words = ("Engine", "Integrator", "Time step")
    figures = (case.quantities[name].label, "Computing time, s", "at least", "at most", "Times real time", "Evaluations a step")
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
            "No other run is both cheaper and closer. Computing time: for a simulated second, the median of repeated timings, "
            "with the least and the most.",
        ),
    )


def _floored(error: float, truth_error: float) -> Entry:
    """An error as a front has it, that has no smaller ones than the truth's own."""
    if 0 < truth_error >= error:
        return Entry(f"≤ {bound(truth_error)}", None, "within the truth's own error")
    return Entry(number(error), error)
