"""The report of the study: the answer, a chart of the error over the time step, and a table of all measured time steps."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from bodycheck.adapters.engine_name import in_words
from bodycheck.reports.charts import INK, Spec, log_axis, method_scale, zoomable
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import QUANTITIES, count, exactly, number
from bodycheck.reports.series import rounded
from bodycheck.reports.study import Chart, Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey
from bodycheck.studies.recommend import wording
from bodycheck.studies.recommend.rows import Answer, Probe, Recommendation

#: Lines by method.
Lines = Mapping[RunKey, Line]

#: Explanations for readers.
READING = (
    "A time step is the duration divided by an integer, so that all runs end at the same instant. The time step of a method is "
    "the largest one such that it, its neighbours and every smaller measured one keep the limit. Its neighbours differ from it "
    "by at most 3 %, and are at least the next time steps on both sides; all of them are measured, or a dozen if there are "
    "more. The search first brackets the limit to 5 %, and measures steps down to half as large, as close to each other as the "
    "errors there require.",
    "The cost is the computing time of a simulated second: the median of repeated timings, all methods in turn, with the "
    "shortest and the longest. The margin is the limit divided by the largest error of the neighbours. The error is monotone "
    "if no measured step has an error more than 10 % above that of a larger step that keeps the limit; errors below a "
    "hundredth of the limit do not count. In the chart, large points are the steps of the methods that keep the limit, which "
    "is the broken line. Runs that failed have no point, and zeros cannot be shown on a log scale.",
    "Of methods with error control, accuracies take the place of time steps: 0.1 to 1e-12, three in a decade, with the same "
    "largest step.",
)


def present(header: Header, recommendation: Recommendation) -> StudyReport:
    """Return the contents of the report.

    Parameters
    ----------
    header
        The header of the results, with versions, machine and command.
    recommendation
        The result of the study.
    """
    lines = assign(answer.method for answer in recommendation.answers)
    drawn = {probe.method for probe in recommendation.probes if _is_drawn(probe)}
    tables = [("The time step of each method", _answers(recommendation))] if recommendation.answers else []
    return StudyReport(
        title="The cheapest method that is accurate enough",
        headline=wording.headline(recommendation),
        header=header,
        notices=tuple(of_header(header)),
        findings=_findings(recommendation),
        parts=(
            Part(
                name=recommendation.asked.case,
                title=recommendation.asked.case,
                texts=tuple(filter(None, (wording.effort(recommendation), wording.truth_error(recommendation)))),
                charts=tuple(_charts(recommendation, lines)),
                tables=(*tables, ("All measured time steps", _steps(recommendation))),
                lines=tuple(line for key, line in lines.items() if key in drawn) if drawn else (),
            ),
        ),
        reading=READING,
    )


def _findings(recommendation: Recommendation) -> tuple[Finding, ...]:
    sentences = (
        ("Margin", (wording.margin(recommendation),)),
        ("Not monotone", wording.jumps(recommendation)),
        ("Second", (wording.second(recommendation),)),
        ("Never", wording.never(recommendation)),
    )
    return tuple(Finding(subject, text) for subject, texts in sentences for text in texts if text)


def _is_drawn(probe: Probe) -> bool:
    """Return whether a log scale can show the error of a probe."""
    return probe.error is not None and 0 < probe.error < math.inf


def _charts(recommendation: Recommendation, lines: Lines) -> Iterator[Chart]:
    """Yield the charts of the error over the time step, and over the accuracy with error control, if there are such probes."""
    for is_controlled, field in ((False, "time step"), (True, "accuracy")):
        probes = [probe for probe in recommendation.probes if (probe.engine_method.accuracy is not None) == is_controlled]
        if any(map(_is_drawn, probes)):
            yield _chart(replace(recommendation, probes=tuple(probes)), lines, field)


def _chart(recommendation: Recommendation, lines: Lines, over: str) -> Chart:
    """Return the chart of the error over the time step or the accuracy; `over` says which."""
    quantity = QUANTITIES[recommendation.asked.figure]
    drawn = {probe.method for probe in recommendation.probes if _is_drawn(probe)}
    measured = [line for key, line in lines.items() if key in drawn]
    alt = (
        f"{quantity.title} against the {over} on log scales, for {count(len(measured), 'method')}, with the limit of "
        f"{number(recommendation.asked.error)} {recommendation.asked.unit}".rstrip()
        + f". {wording.headline(recommendation)}"
    )
    zero = [wording.method(answer) for answer in recommendation.answers if answer.error == 0]
    return Chart(
        title=f"{quantity.title} over the {over}",
        specification=_specification(recommendation, lines, measured, over),
        alt=alt,
        notes=(f"Errors of zero, which are not drawn, occur with {', '.join(zero)}.",) if zero else (),
    )


def _specification(recommendation: Recommendation, lines: Lines, drawn: Sequence[Line], over: str) -> Spec:
    """Return a chart with a curve for each method through its measured steps, the limit, and the steps of the answers."""
    chosen = {(answer.engine, answer.integrator, answer.timestep) for answer in recommendation.reached}
    field = "timestep" if over == "time step" else "accuracy"
    values = [
        {
            "method": lines[probe.method].label,
            field: probe.timestep if field == "timestep" else probe.engine_method.accuracy,
            "error": rounded([probe.error])[0],
            "chosen": (probe.engine, probe.integrator, probe.timestep) in chosen,
        }
        for probe in recommendation.probes
        if probe.error is not None and _is_drawn(probe)
    ]
    x = {
        "field": field,
        "type": "quantitative",
        "title": "Time step, s" if field == "timestep" else "Accuracy",
        "scale": {"type": "log", "nice": False, "padding": 12},
        "axis": log_axis("x") | {"grid": False},
    }
    y = {
        "field": "error",
        "type": "quantitative",
        "title": QUANTITIES[recommendation.asked.figure].label,
        "scale": {"type": "log", "nice": False, "padding": 12},
        "axis": log_axis("y"),
    }
    scales = {channel: method_scale(channel, drawn) for channel in ("strokeDash", "strokeWidth")}
    tooltip = [{"field": name} for name in ("method", field, "error")]
    size = {"condition": {"test": "datum.chosen", "value": 110}, "value": 22}
    measured: Spec = {
        "data": {"values": values},
        "transform": [{"filter": "indexof(hidden, datum.method) < 0"}],
        "encoding": {"x": x, "y": y, "color": method_scale("color", drawn)},
        "layer": [
            {"mark": {"type": "line", "clip": True, "tooltip": None, "aria": False}, "encoding": scales},
            {
                "mark": {"type": "point", "clip": True, "filled": True, "opacity": 1},
                "encoding": {"size": size, "tooltip": tooltip},
            },
        ],
    }
    rule: Spec = {
        "data": {"values": [{"error": recommendation.asked.error}]},
        "mark": {"type": "rule", "color": INK, "strokeDash": [6, 4], "clip": True, "tooltip": None, "aria": False},
        "encoding": {"y": y},
    }
    return zoomable([rule, measured], height=320) | {"params": [{"name": "hidden", "value": []}]}


def _answers(recommendation: Recommendation) -> Table:
    """Return the table of the answers, in their order: those that keep the limit come first."""
    words = ("Engine", "Integrator", "Keeps the limit")
    label = QUANTITIES[recommendation.asked.figure].label
    near = f"Worst neighbour, {QUANTITIES[recommendation.asked.figure].unit or 'relative'}"
    figures = ("Time step, s", label, near, "Margin", "Computing time, s", "Shortest, s", "Longest, s", "Breaks at, s", "Runs")
    return Table(
        columns=(*words, *figures, "Monotone"),
        numeric=(*(False,) * len(words), *(True,) * len(figures), False),
        rows=tuple(
            (
                Entry(in_words(answer.engine, answer.version).rstrip()),
                Entry(answer.integrator),
                Entry("yes" if answer.reached else "no"),
                Entry("–" if answer.timestep is None else exactly(answer.timestep), answer.timestep),
                *map(
                    _figure,
                    (
                        answer.error,
                        answer.worst,
                        answer.margin,
                        answer.cost,
                        answer.cost_low,
                        answer.cost_high,
                        answer.broken,
                    ),
                ),
                _figure(answer.steps),
                Entry("–" if answer.monotone is None else "yes" if answer.monotone else "no"),
            )
            for answer in recommendation.answers
        ),
        failed=tuple(not answer.reached for answer in recommendation.answers),
        notes=(*dict.fromkeys(_reason(answer) for answer in recommendation.answers if answer.reason),),
    )


def _reason(answer: Answer) -> str:
    return f"{wording.method(answer)}: {answer.reason}."


def _steps(recommendation: Recommendation) -> Table:
    """Return the table of all measured time steps."""
    words = ("Engine", "Integrator", "Status")
    figures = ("Steps", "Time step, s", QUANTITIES[recommendation.asked.figure].label)
    return Table(
        columns=words + figures,
        numeric=(False,) * len(words) + (True,) * len(figures),
        rows=tuple(
            (
                Entry(in_words(probe.engine, probe.version).rstrip()),
                Entry(probe.integrator),
                Entry(probe.status, None, probe.reason),
                _steps_of(recommendation, probe),
                *map(_figure, (probe.timestep, probe.error)),
            )
            for probe in recommendation.probes
        ),
        failed=tuple(probe.error is None or probe.error > recommendation.asked.error for probe in recommendation.probes),
        notes=("Coloured rows do not keep the limit.",),
    )


def _steps_of(recommendation: Recommendation, probe: Probe) -> Entry:
    """Return the entry of the number of steps of a probe; with error control, the engine chooses it."""
    if probe.engine_method.accuracy is not None:
        return Entry("–")
    steps = recommendation.asked.steps(probe.timestep)
    return Entry(str(steps), steps)


def _figure(value: float | None) -> Entry:
    return Entry(number(value, 3), value)
