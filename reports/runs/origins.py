"""Where the discrepancies of one case's contacts come from, as a table and as charts."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bodycheck.judging.attribution import Attribution
from bodycheck.reports.charts import COMPONENT_COLOURS, INK, Spec, framed
from bodycheck.reports.quantities import count, milliseconds, number
from bodycheck.reports.study import Chart
from bodycheck.reports.tables import Entry, Table

QUANTITIES = {
    "stop_time": ("Stop time", "s"),
    "stop_distance": ("Way to the stop", "m"),
    "stop_yaw": ("Turn to the stop", "rad"),
}

#: A quantity that is off by less in every run of a case is left out.
NOTHING = 1e-12

PARTS = ("model form", "constraint", "time step")

#: Height of a method in a chart, in pixels.
BAR = 26

#: By the label of the set of results; the only one has none.
Parts = Mapping[str, Sequence[Attribution]]


@dataclass(frozen=True)
class Origins:
    """The parts of one case's discrepancies: all of them, and drawn, those of the methods of which all parts are known."""

    table: Table
    charts: tuple[Chart, ...]


def origins(parts: Parts) -> Origins | None:
    """Those of one case, each engine minus truth; None where there is no contact."""
    if not any(parts.values()):
        return None
    return Origins(_table(parts), tuple(_charts(parts)))


def _charts(parts: Parts) -> Iterator[Chart]:
    """A chart a quantity, of the smallest time step of each method."""
    finest: dict[tuple[str, str, str, str], Attribution] = {}
    for label, own in parts.items():
        for part in own:
            key = part.quantity, part.engine, part.integrator, label
            if part.constraint is not None and (key not in finest or part.timestep < finest[key].timestep):
                finest[key] = part
    for quantity, (title, unit) in QUANTITIES.items():
        methods = {_method(*key[1:], part): part for key, part in finest.items() if key[0] == quantity}
        if any(abs(part.total) > NOTHING for part in methods.values()):
            yield Chart(f"{title}: engine minus truth", _bars(methods, f"{title}, {unit}"), _alt(methods, title, unit))


def _method(engine: str, integrator: str, label: str, part: Attribution) -> str:
    return " ".join(filter(None, (engine, integrator, milliseconds(part.timestep), label)))


def _alt(methods: Mapping[str, Attribution], title: str, unit: str) -> str:
    worst = max(methods, key=lambda method: abs(methods[method].total))
    shares = zip(PARTS, _values(methods[worst]), strict=True)
    told = ", ".join(f"{name} {number(value, 3)}" for name, value in shares if value is not None)
    return (
        f"{title}, bars of what each discrepancy is made of, {count(len(methods), 'method')}. "
        f"Farthest off: {worst}, by {number(methods[worst].total, 3)} {unit}: {told}."
    )


def _values(part: Attribution) -> tuple[float | None, ...]:
    return part.model_form, part.constraint, part.time_step


def _bars(methods: Mapping[str, Attribution], title: str) -> Spec:
    """Bars of the parts, those of one sign end to end, and a line at what they add up to."""
    shares = [
        {"method": method, "part": name, "value": value, "order": place}
        for method, part in methods.items()
        for place, (name, value) in enumerate(zip(PARTS, _values(part), strict=True))
        if value is not None
    ]
    totals = [{"method": method, "value": part.total} for method, part in methods.items()]
    x = {"field": "value", "type": "quantitative", "title": title, "axis": {"format": "~g", "tickCount": 6}}
    y = {
        "field": "method",
        "type": "nominal",
        "sort": list(methods),
        "title": None,
        "axis": {"ticks": False, "labelLimit": 240},
    }
    colours = {"domain": list(PARTS), "range": list(COMPONENT_COLOURS)}
    colour = {"field": "part", "type": "nominal", "sort": None, "scale": colours, "legend": {"symbolType": "square"}}
    value = {"field": "value", "format": ".4~g"}
    layers: list[Spec] = [
        {
            "data": {"values": shares},
            "mark": {"type": "bar", "height": {"band": 0.6}},
            "encoding": {
                "x": {**x, "stack": "zero"},
                "y": y,
                "color": colour,
                "order": {"field": "order"},
                "tooltip": [{"field": "method"}, {"field": "part"}, value],
            },
        },
        {
            "data": {"values": totals},
            "mark": {"type": "tick", "color": INK, "thickness": 2, "height": {"band": 0.85}},
            "encoding": {"x": x, "y": y, "tooltip": [{"field": "method"}, {**value, "title": "off by"}]},
        },
    ]
    return framed(layers, BAR * len(methods))


def _table(parts: Parts) -> Table:
    """A row a method, step and quantity."""
    labelled = [(label, part) for label, own in parts.items() for part in own if abs(part.total) > NOTHING]
    told, sets = [part for _, part in labelled], ("Set",) if any(parts) else ()
    numeric = ("Off by", f"of it {PARTS[0]}", *PARTS[1:])
    halved = any(part.constraint is None for part in told)
    notes = (
        "Engine minus truth. Model form: the law that the engine's contacts make, against the law of the case, both exact. "
        "Constraint: what the engine tends to as its step vanishes, against that law. "
        "Time step: the rest, which vanishes with it.",
        *(("–: told only of methods that were run with two time steps or more.",) if halved else ()),
    )
    return Table(
        columns=(*sets, "Engine", "Integrator", "Time step", "Quantity", *numeric),
        numeric=(False,) * (4 + len(sets)) + (True,) * 4,
        rows=tuple((*((Entry(label),) if sets else ()), *_row(part)) for label, part in labelled),
        failed=(False,) * len(told),
        notes=notes,
    )


def _row(part: Attribution) -> tuple[Entry, ...]:
    title, unit = QUANTITIES[part.quantity]
    figures = (part.total, part.model_form, part.constraint, part.time_step)
    return (
        Entry(f"{part.engine} {part.version}".rstrip()),
        Entry(part.integrator),
        Entry(milliseconds(part.timestep)),
        Entry(f"{title}, {unit}"),
        *(Entry(number(figure, 3), figure) for figure in figures),
    )
