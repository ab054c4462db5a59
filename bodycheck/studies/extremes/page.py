"""The report of the study of extremes: first what engines take for healthy and is not, then how far every method goes."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Any

from bodycheck.casefile.axes import AXES
from bodycheck.reports.finding import Finding
from bodycheck.reports.quantities import count, listing, milliseconds, number
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.running.header import Header
from bodycheck.studies.extremes.outcome_map import outcome_map
from bodycheck.studies.extremes.rows import HEALTHY, STATUSES, Limit, Row

#: Values that are listed one by one.
MOST_VALUES = 4

GONE = ("diverged", "silent-reset", "crashed", "frozen")

#: Anchors of the parts that are of no single case.
BELIEVED, STABILITY = "said-healthy", "stability"

READING = (
    "ok: attitude within 1 rad of the truth, centre of mass within 1 % of the way travelled, energy of rotation within 1 % of "
    "the initial one. inaccurate: bounded, but one of these is lost. energy-gain, energy-loss: the energy of rotation goes one "
    "way, by more than 1 %. frozen: what should move stands still to the last bit. diverged: not a number, out of all bounds, "
    "or the engine gave up. silent-reset: the engine went on from a state of its own, which only its warning counters tell. "
    "crashed: an error, or the death of the process. timeout: no end in the time allowed. unsupported: the engine refuses.",
    "An engine says “healthy” where it steps to the end and signals nothing. extremes.csv has every run with its engine's "
    "words and what was seen of it.",
    "Stable is called a step with which the body still turns after 100 turns, its energy of rotation never twice the initial "
    "one. A method that gains a little energy in every step has no such limit in the strict sense; the figure then says how "
    "small a step 100 turns need.",
)


def present(header: Header, rows: Sequence[Row], limits: Sequence[Limit]) -> StudyReport:
    """What the study's report says. header: as that of results. rows, limits: in the order of the study."""
    believed = [row for row in rows if row.believed]
    cases: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        cases[row.case].append(row)
    return StudyReport(
        title="Where engines stop being right",
        headline=f"{len(believed)} of {count(len(rows), 'run')} are healthy to their engine and are not",
        header=header,
        notices=_notices(header, rows),
        findings=(*_believed(rows), *_long_runs(rows), *_resets(rows), *_stability(limits), *_killed(rows)),
        parts=(
            *((_healthy_and_not(believed),) if believed else ()),
            *(_case(name, own) for name, own in cases.items()),
            *((_limits(limits),) if limits else ()),
        ),
        reading=READING,
    )


def _notices(header: Header, rows: Sequence[Row]) -> tuple[str, ...]:
    missing = [f"Without the engine {engine}: {reason}." for engine, reason in header["missing"].items()]
    refused = Counter(row.detail for row in rows if row.status == "unsupported")
    return (*missing, *(f"{count(amount, 'run')} unsupported: {reason}." for reason, amount in refused.items()))


def _believed(rows: Sequence[Row]) -> list[Finding]:
    kinds = Counter(row.status for row in rows if row.believed)
    if not kinds:
        return []
    text = listing([f"{amount} {status}" for status, amount in kinds.most_common()])
    before = f"{count(kinds.total(), 'run')} went to the end without a word from the engine, and are not right: {text}. See "
    return [Finding("Said healthy", before, BELIEVED, ".")]


def _long_runs(rows: Sequence[Row]) -> list[Finding]:
    """Methods that break after more steps than they had gone without a word; those of which the same is to be said together."""
    runs: dict[tuple[str, str], list[Row]] = defaultdict(list)
    for row in rows:
        if row.axis == "steps":
            runs[row.case, _method(row)].append(row)
    breaks: dict[tuple[str, str], list[str]] = defaultdict(list)
    for (case, method), own in runs.items():
        ordered = sorted(own, key=lambda row: row.value)
        endured = [row for row in ordered if row.engine_said == HEALTHY and row.status not in GONE]
        broken = [row for row in ordered if row.status in GONE]
        if endured and broken and broken[0].value > endured[-1].value:
            words = broken[0].engine_said if broken[0].engine_said != HEALTHY else broken[0].detail
            ends = (
                f"{_figure(endured[-1].value)} steps without a word and does not survive {_figure(broken[0].value)}: {words}."
            )
            breaks[case, ends].append(method)
    return [
        Finding("Long runs", "In ", case, f" a run with {listing(methods)} goes {ends}")
        for (case, ends), methods in breaks.items()
    ]


def _resets(rows: Sequence[Row]) -> list[Finding]:
    resets = [row for row in rows if row.status == "silent-reset"]
    axes: dict[str, list[Row]] = defaultdict(list)
    for row in resets:
        axes[row.axis].append(row)
    if not resets:
        return []
    mildest = [min(own, key=lambda row: row.value) for own in axes.values()]
    places = listing([f"{_axis(row.axis)} from {_value(row)} at {milliseconds(row.timestep)}" for row in mildest])
    engines = listing(sorted({row.engine for row in resets}))
    runs = count(len(resets), "run")
    return [Finding("Silent resets", f"{engines} started over in {runs}, with no error to the caller: {places}.")]


def _stability(limits: Sequence[Limit]) -> list[Finding]:
    """The largest products of spin and step, methods of the same one together; then where there is none at all."""
    products: dict[str, list[str]] = defaultdict(list)
    for method, own in _by_method(limits).items():
        known = {number(limit.spin_times_step, 3) for limit in own if limit.spin_times_step is not None}
        if known:
            products[" to ".join(sorted(known, key=float))].append(method)
    none = defaultdict(list)
    for limit in limits:
        if limit.spin_times_step is None:
            none[limit.spin].append(_method(limit))
    found = []
    if products:
        texts = [f"{product} rad with {listing(methods)}" for product, methods in products.items()]
        found.append(
            Finding("Stability", f"The most that a body may turn in one step: {'; '.join(texts)}. See ", STABILITY, ".")
        )
    if none:
        texts = [f"at {_figure(spin)} rad/s with {listing(methods)}" for spin, methods in none.items()]
        found.append(Finding("Unstable", f"No step at all is stable {'; '.join(texts)}."))
    return found


def _killed(rows: Sequence[Row]) -> list[Finding]:
    dead = Counter(row.status for row in rows if row.status in ("crashed", "timeout"))
    methods = sorted({_method(row) for row in rows if row.status in dead})
    if not dead:
        return []
    text = listing([f"{count(amount, 'run')} {status}" for status, amount in dead.items()])
    return [Finding("No end", f"{text}, with {listing(methods, MOST_VALUES, 'method')}.")]


def _healthy_and_not(rows: Sequence[Row]) -> Part:
    """A row for all runs along an axis that end alike, of methods that do so at the same points; the first is told of."""
    groups: dict[tuple[str, str, str, str], list[Row]] = defaultdict(list)
    for row in rows:
        groups[row.case, row.axis, row.status, _method(row)].append(row)
    merged: dict[tuple[str, str, str, str, str], list[str]] = defaultdict(list)
    for (case, axis, status, method), own in groups.items():
        merged[case, _axis(axis), _values(own), status, own[0].detail].append(method)
    ordered = sorted(merged.items(), key=lambda group: -STATUSES.index(group[0][3]))
    table = Table(
        columns=("Case", "Method", "Axis", "Values", "Status", "Reason"),
        numeric=(False,) * 6,
        rows=tuple(tuple(map(Entry, (case, listing(methods), *seen))) for (case, *seen), methods in ordered),
        failed=(True,) * len(ordered),
        notes=("The reason is what was seen of the first of these runs.",),
    )
    text = "The engine stepped to the end and signalled nothing. A caller who does not check sees a result."
    return Part(BELIEVED, "Said healthy, and not", (text,), (), (("Runs that end alike", table),))


def _case(name: str, rows: Sequence[Row]) -> Part:
    axes: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        axes[row.axis].append(row)
    maps = axes["spin"] if len({row.timestep for row in axes.get("spin", ())}) > 1 else []
    charts = tuple(_map(methods, own) for methods, own in _alike(maps))
    tables = tuple((f"Along {_axis(axis)}", _outcomes(axis, own)) for axis, own in axes.items() if own)
    return Part(name, name, (), charts, tables)


def _map(methods: str, rows: Sequence[Row]) -> Chart:
    kinds = Counter(row.status for row in rows)
    alt = (
        f"How runs of {methods} end, by spin and time step: {listing([f'{n} {status}' for status, n in kinds.most_common()])}."
    )
    return Chart(methods, outcome_map(rows), alt)


def _outcomes(axis: str, rows: Sequence[Row]) -> Table:
    """Values by methods, those that end alike everywhere in one column."""
    columns = _alike(rows)
    several = len({row.timestep for row in rows}) > 1 and axis != "timestep"
    places = [(_value(row), milliseconds(row.timestep)) for row in columns[0][1]]
    heads = (_axis(axis).capitalize(), *(("Time step",) if several else ()))
    return Table(
        columns=(*heads, *(methods for methods, _ in columns)),
        numeric=(False,) * (len(heads) + len(columns)),
        rows=tuple(
            tuple(map(Entry, (*place[: len(heads)], *(own[index].status for _, own in columns))))
            for index, place in enumerate(places)
        ),
        failed=(False,) * len(places),
        notes=(),
    )


def _alike(rows: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    """The runs of one method for all that end alike at all points, under the names of them all; points in one order."""
    groups: dict[tuple[str, ...], list[tuple[str, list[Row]]]] = defaultdict(list)
    for method, own in _by_method(rows).items():
        groups[tuple(row.status for row in own)].append((method, own))
    return [(listing([method for method, _ in group]), group[0][1]) for group in groups.values()]


def _limits(limits: Sequence[Limit]) -> Part:
    spins = list(dict.fromkeys(limit.spin for limit in limits))
    by_method = {key: {limit.spin: limit for limit in own} for key, own in _by_method(limits).items()}
    rows = []
    for method, own in by_method.items():
        figures = [own[spin].spin_times_step if spin in own else None for spin in spins]
        rows.append((Entry(method), *(Entry(number(figure, 3), figure) for figure in figures)))
    table = Table(
        columns=("Method", *(f"{_figure(spin)} rad/s" for spin in spins)),
        numeric=(False, *(True for _ in spins)),
        rows=tuple(rows),
        failed=(False,) * len(rows),
        notes=("–: no step that was tried is stable.",),
    )
    text = "How far the body turns in the largest stable step, rad. limits.csv has the steps themselves."
    return Part(STABILITY, "Stability", (text,), (), (("Largest stable product of spin and step, rad", table),))


def _by_method(rows: Sequence[Any]) -> dict[str, list[Any]]:
    found: dict[str, list[Any]] = defaultdict(list)
    for row in rows:
        found[_method(row)].append(row)
    return found


def _method(row: Row | Limit) -> str:
    return f"{row.engine} {row.integrator}"


def _axis(axis: str) -> str:
    """Return the title of an axis inside a sentence; a title that begins with a symbol keeps its capitals."""
    title = AXES[axis].title
    return title.lower() if title[:2].isalpha() else title


def _unit(axis: str) -> str:
    return AXES[axis].unit.replace("^2", "²")


def _value(row: Row) -> str:
    return f"{_figure(row.value)} {_unit(row.axis)}".rstrip()


def _values(rows: Sequence[Row]) -> str:
    """The values of some runs, and their time steps where these are several."""
    values = sorted({row.value for row in rows})
    unit = _unit(rows[0].axis)
    told = listing([_figure(value) for value in values]) if len(values) <= MOST_VALUES else _range(values)
    steps = sorted({row.timestep for row in rows})
    at = f", {milliseconds(steps[0])} to {milliseconds(steps[-1])}" if len(steps) > 1 and rows[0].axis != "timestep" else ""
    return f"{told} {unit}".rstrip() + at


def _range(values: Sequence[float]) -> str:
    return f"{len(values)} from {_figure(values[0])} to {_figure(values[-1])}"


def _figure(value: float) -> str:
    """A value of an axis, all digits that were given."""
    return number(value, 4 if float(f"{value:.4g}") == value else 15)
