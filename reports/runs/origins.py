"""The origins of the contact discrepancies of a case, as a table and as charts."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bodycheck.adapters.engine_name import in_words
from bodycheck.judging.attribution import Attribution
from bodycheck.reports.charts import COMPONENT_COLOURS, INK, Spec, framed
from bodycheck.reports.quantities import count, milliseconds, number
from bodycheck.reports.study import Chart
from bodycheck.reports.tables import Entry, Table

#: The title and the unit of each quantity.
QUANTITIES = {
    "stop_time": ("Stopping time", "s"),
    "stop_distance": ("Stopping distance", "m"),
    "stop_yaw": ("Rotation until the stop", "rad"),
}

#: The absolute value below which discrepancies are left out.
NOTHING = 1e-12

#: The parts of a discrepancy.
PARTS = ("model form", "constraint", "time step")

#: The note for tables in which parts are unknown.
INCOMPLETE = (
    "– marks an unknown part. The parts of constraint and time step are known only for methods that were run with at least "
    "two time steps."
)

#: The height of a method in a chart, in pixels.
BAR = 26

#: The parts by the label of the set of results, which is empty if there is only one set.
Parts = Mapping[str, Sequence[Attribution]]


@dataclass(frozen=True)
class Origins:
    """The parts of the discrepancies of one case: a table of all methods, and charts of methods whose parts are all known."""

    table: Table
    charts: tuple[Chart, ...]


def origins(parts: Parts) -> Origins | None:
    """Return the origins of the discrepancies (engine minus truth) of one case; None if there are no parts."""
    if not any(parts.values()):
        return None
    return Origins(_table(parts), tuple(_charts(parts)))


def _charts(parts: Parts) -> Iterator[Chart]:
    """Yield a chart for each quantity, with each method at its smallest time step for which all parts are finite."""
    finest: dict[tuple[str, str, str, str], Attribution] = {}
    for label, own in parts.items():
        for part in own:
            key = part.quantity, part.engine, part.integrator, label
            finite = all(math.isfinite(value) for value in (part.total, *_values(part)) if value is not None)
            if finite and part.constraint is not None and (key not in finest or part.timestep < finest[key].timestep):
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
    listed = ", ".join(f"{name} {number(value, 3)}" for name, value in shares if value is not None)
    return (
        f"{title}: bars show the parts of the discrepancy for {count(len(methods), 'method')}. "
        f"The largest discrepancy is that of {worst}, {number(methods[worst].total, 3)} {unit}: {listed}."
    )


def _values(part: Attribution) -> tuple[float | None, ...]:
    return part.model_form, part.constraint, part.time_step


def _bars(methods: Mapping[str, Attribution], title: str) -> Spec:
    """Return a chart with a bar for each part, bars of the same sign end to end, and a line at the sum."""
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
            "encoding": {"x": x, "y": y, "tooltip": [{"field": "method"}, {**value, "title": "discrepancy"}]},
        },
    ]
    return framed(layers, BAR * len(methods))


def _table(parts: Parts) -> Table:
    """Return a table with one row for each method, time step and quantity."""
    labelled = [(label, part) for label, own in parts.items() for part in own if abs(part.total) > NOTHING]
    shown, sets = [part for _, part in labelled], ("Set",) if any(parts) else ()
    numeric = ("Discrepancy", *(f"Part: {name}" for name in PARTS))
    incomplete = any(part.constraint is None for part in shown)
    notes = (
        "A discrepancy is engine minus truth and has three parts. Model form: the friction law of the engine's contact model "
        "minus the law of the case, both solved exactly. Constraint: the limit of the engine's result for vanishing time steps "
        "minus that exact solution. Time step: the rest, which vanishes with the time step.",
        *((INCOMPLETE,) if incomplete else ()),
    )
    return Table(
        columns=(*sets, "Engine", "Integrator", "Time step", "Quantity", *numeric),
        numeric=(False,) * (4 + len(sets)) + (True,) * 4,
        rows=tuple((*((Entry(label),) if sets else ()), *_row(part)) for label, part in labelled),
        failed=(False,) * len(shown),
        notes=notes,
    )


def _row(part: Attribution) -> tuple[Entry, ...]:
    title, unit = QUANTITIES[part.quantity]
    figures = (part.total, part.model_form, part.constraint, part.time_step)
    return (
        Entry(in_words(part.engine, part.version).rstrip()),
        Entry(part.integrator),
        Entry(milliseconds(part.timestep)),
        Entry(f"{title}, {unit}"),
        *(Entry(number(figure, 3), figure) for figure in figures),
    )
