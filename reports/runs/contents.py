"""The contents of the report of runs before layout, which all writers use."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.figures.bounds import ATTITUDE
from bodycheck.judging import advice
from bodycheck.judging.advice import Step
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line, assign
from bodycheck.reports.quantities import PLOTTED, QUANTITIES, Quantity
from bodycheck.reports.runs import comparison
from bodycheck.reports.runs.brief import brief
from bodycheck.reports.runs.charts import curves
from bodycheck.reports.runs.charts.choice_charts import error_over_cost
from bodycheck.reports.runs.charts.curves import Curves
from bodycheck.reports.runs.charts.drawn_cases import drawn_cases
from bodycheck.reports.runs.charts.legends import first_lines
from bodycheck.reports.runs.charts.step_charts import StepCharts, over_steps
from bodycheck.reports.runs.choices import Extreme
from bodycheck.reports.runs.commands import Command, command
from bodycheck.reports.runs.comparison import Shown
from bodycheck.reports.runs.demonstrations import demonstrated
from bodycheck.reports.runs.kinds import kind_of
from bodycheck.reports.runs.matrix import Matrix, matrices
from bodycheck.reports.runs.motions.animation import animated
from bodycheck.reports.runs.motions.leading import Leading, leading
from bodycheck.reports.runs.motions.playback import MOST_CHARACTERS, Playback
from bodycheck.reports.runs.motions.stills import still
from bodycheck.reports.runs.origins import Origins, origins
from bodycheck.reports.runs.run_table import run_table
from bodycheck.reports.runs.scenes import Fact, Told, describe, softness
from bodycheck.reports.runs.summary import failure_status
from bodycheck.reports.runs.unsupported import with_place
from bodycheck.reports.same_algorithm import NO_CLASSES
from bodycheck.reports.study import Chart
from bodycheck.reports.tables import Table
from bodycheck.reports.time_limit import TookTooLong, limited
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey

#: About the most numbers in four curves of each run together, so that even a large report opens. A number needs three bytes.
MOST_NUMBERS = 220_000

#: The most points of a curve.
MOST_POINTS = 256

#: The most instants of the curves of the angular momentum in all cases, about 1.5 MB, and the fewest instants in each case.
MOST_INSTANTS, LEAST_INSTANTS = 25_000, 50

#: The most processor time (s) for the curves and the animation of a case. A thousand runs take about twenty seconds.
DRAWING_LIMIT_S = 120.0

#: The reasons why a case has no runs to show.
NONE_FINISHED, ALL_REFUSED = "No run of this case finished.", "No run of this case has a result."


@dataclass(frozen=True)
class Section:
    """One case.

    Parameters
    ----------
    name, title, source, tags
        The name, title, source and tags of the case. If several sets have different cases of this name, a number
        follows the name. If several cases have this title, the name follows the title.
    facts
        The case in words.
    table
        The runs; None if there are none to show.
    absence
        The reason why there are no runs to show.
    commands
        The commands that reproduce the runs.
    steps
        Charts of errors over the time step; none if there is only one time step.
    origins
        Parts of the contact discrepancies; None without contact.
    curves, first
        Plots over time, and the lines that they show first.
    playback
        The animation; None if no run has a truth with which it can be compared.
    still
        A small picture of the motion as SVG text; empty if there is none.
    extremes
        The methods with the smallest and the largest error.
    """

    name: str
    title: str
    source: str
    tags: tuple[str, ...]
    facts: tuple[Fact, ...]
    table: Table | None
    absence: str
    commands: tuple[Command, ...]
    steps: StepCharts
    origins: Origins | None
    curves: Curves
    first: tuple[Line, ...]
    playback: Playback | None
    still: str
    extremes: tuple[Extreme, ...]


@dataclass(frozen=True)
class Room:
    """Limits for one case on a page: points of a curve, instants of the angular momentum, and characters of the animation."""

    points: int
    instants: int
    characters: int


@dataclass(frozen=True)
class Failure:
    """A failed run: its case, its method, how and why it failed, and the next steps."""

    case: str
    method: str
    status: str
    reason: str
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class Contents:
    """The contents of a whole report.

    Parameters
    ----------
    header
        Versions, machine and command.
    complete
        Whether the command was not interrupted.
    headline, tally, notices
        The verdict in one line, the number of runs with each outcome, and sentences about the limits of the report.
    broken
        A sentence about the failed runs; None if there are none.
    answers, findings
        Sentences for the beginning of the report, and sentences on where discrepancies come from.
    leading
        The animation at the beginning; None if there is none.
    trades
        Charts of error over cost: one for each kind of scene, by its name, the kind with the most runs first.
    failures
        The failed runs.
    lines
        The line of each method that appears in tables.
    matrices
        Cases by methods.
    sections
        The cases.
    plotted
        The quantities that any section draws over time.
    undrawn
        The number of cases without curves over time and animation, because the report has so many.
    """

    header: Header
    complete: bool
    headline: str
    tally: tuple[tuple[str, int], ...]
    notices: tuple[str, ...]
    broken: Finding | None
    answers: tuple[Finding, ...]
    findings: tuple[Finding, ...]
    leading: Leading | None
    trades: Mapping[str, Chart]
    failures: tuple[Failure, ...]
    lines: tuple[Line, ...]
    matrices: tuple[Matrix, ...]
    sections: tuple[Section, ...]
    plotted: tuple[Quantity, ...]
    undrawn: int


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def gather(sets: Sequence[ResultSet]) -> Contents:
    """Return the contents of a report of one set of results, or of a comparison of several sets, which have labels.

    Quantities that are not finite, because states are too large or NaN, are shown as a dash or left out.
    """
    every = comparison.shown(sets)
    lines = assign(verdict.key.over_cases for case in every for verdict in case.verdicts)
    shown = tuple(replace(case, verdicts=with_place(case.verdicts)) for case in every)
    verdicts = [verdict for case in shown for verdict in case.verdicts]
    told = brief(sets)
    chosen = frozenset(drawn_cases(shown, (*told.answers, *told.findings)))
    room = _room([case for case in shown if case.name in chosen])
    placed = {verdict.key.over_cases for verdict in verdicts}
    header = comparison.header(sets)
    demonstrations = demonstrated(header, lines)
    anchors = {verdict.key: f"run-{case.name}-{place}" for case in shown for place, verdict in enumerate(case.verdicts, 1)}
    refused = {case.name for case in every if case.verdicts}
    absences = {case.name: ALL_REFUSED if case.name in refused else NONE_FINISHED for case in shown if not case.verdicts}
    titles = Counter(case.title for case in shown)
    sections = tuple(
        _section(
            case,
            absences.get(case.name, ""),
            lines,
            anchors,
            demonstrations,
            room if case.name in chosen else None,
            case.title if titles[case.title] == 1 else f"{case.title} ({case.name})",
            told.extremes.get(case.name, ()),
        )
        for case in shown
    )
    return Contents(
        header=header,
        complete=all(one.results.complete for one in sets),
        headline=told.headline,
        tally=told.tally,
        notices=told.notices,
        broken=told.broken,
        answers=told.answers,
        findings=told.findings,
        leading=leading({section.name: section.playback for section in sections}, told.foremost),
        trades={one.kind.name: chart for one in told.choices if (chart := error_over_cost(one)) is not None},
        failures=tuple(
            _failure(case, verdict, lines) for case in shown for verdict in case.verdicts if verdict.passed is False
        ),
        lines=tuple(line for key, line in lines.items() if key in placed),
        matrices=matrices(
            {case.name: case.case for case in shown},
            verdicts,
            lines,
            anchors,
            {one.name: one.curves.drawn for one in sections},
            demonstrations,
            sets[0].classes if len(sets) == 1 else NO_CLASSES,
        ),
        sections=sections,
        plotted=tuple(QUANTITIES[name] for name in PLOTTED if any(name in section.curves.drawn for section in sections)),
        undrawn=len(shown) - len(chosen),
    )


def _room(cases: Sequence[Shown]) -> Room:
    """Return the limits for each of the drawn cases."""
    curved, amount = sum(len(case.verdicts) for case in cases), max(1, len(cases))
    return Room(
        points=max(2, min(MOST_POINTS, MOST_NUMBERS // max(1, 4 * curved))),
        instants=min(curves.MOST_CORNERS, max(LEAST_INSTANTS, MOST_INSTANTS // amount)),
        characters=MOST_CHARACTERS // amount,
    )


def _failure(case: Shown, verdict: Verdict, lines: Mapping[RunKey, Line]) -> Failure:
    label, steps = lines[verdict.key.over_cases].label, advice.of_run(verdict, case.file(verdict.label))
    return Failure(verdict.run.case, label, failure_status(verdict), verdict.reason, steps)


def _section(
    shown: Shown,
    absence: str,
    lines: Mapping[RunKey, Line],
    anchors: Mapping[RunKey, str],
    demonstrations: Mapping[RunKey, str],
    room: Room | None,
    title: str,
    extremes: tuple[Extreme, ...],
) -> Section:
    """Return the section of a case. room: the limits for its curves and animation; None if it has neither."""
    case, verdicts = shown.case, shown.verdicts
    samplings = dict.fromkeys(verdict.run.method.sampling for verdict in verdicts)
    parts = {one.label: one.parts_by_case.get(case.name, ()) for one in shown.sets}
    facts = describe(case, [_told(one, shown, sampling) for one in shown.sets for sampling in samplings])
    soft = {name: options for each in shown.sets for name, options in each.results.header["soft"].items()}
    facts += softness(
        case.scene, {name: soft[name] for name in {verdict.run.engine: None for verdict in verdicts} if name in soft}
    )
    drawn, played, picture = curves.draw({}, {}, MOST_POINTS), None, ""
    if room is not None:
        truths = {(one.label, each): one.results.truth(case.name, each) for one in shown.sets for each in samplings}
        known = {key: truth for key, truth in truths.items() if isinstance(truth, Truth)}
        try:
            with limited(DRAWING_LIMIT_S):
                drawn, played = _drawn(shown, known, lines, room)
                picture = still(case.scene, next(iter(known.values())).trajectory) if known else ""
        except TookTooLong as error:
            facts += (Fact("Left out", f"curves and animation, because drawing them took {error} of processor time"),)
    else:
        facts += (Fact("Left out", _undrawn(shown.name)),)
    return Section(
        name=shown.name,
        title=title,
        source=case.source,
        tags=case.tags,
        facts=facts,
        absence=absence,
        table=run_table(verdicts, anchors, drawn.drawn, demonstrations) if verdicts else None,
        commands=tuple(
            Command(
                anchors[verdict.key],
                lines[verdict.key.over_cases].label,
                command(verdict, shown.argument(verdict.label)),
            )
            for verdict in verdicts
        ),
        steps=over_steps(verdicts),
        origins=origins(parts),
        curves=drawn,
        first=first_lines(verdicts, lines, kind_of(case.scene).quantity),
        playback=played,
        still=picture,
        extremes=extremes,
    )


def _told(one: ResultSet, shown: Shown, sampling: float) -> Told | NoTruth:
    """Return the facts about the truth of a case with a sampling in a set of results, or why there is no truth.

    If a run was compared with the truth, the largest error of the truth is known, and the truth is not read again.
    """
    runs = (v for v in shown.verdicts if v.label == one.label and v.run.method.sampling == sampling)
    errors = (run.discrepancy.largest.get(ATTITUDE.name) for run in runs if run.discrepancy is not None)
    error, ways = next(errors, None), one.results.ways(shown.case.name, sampling)
    if error is not None and ways is not None:
        return Told(**ways, error=error)
    truth = one.results.truth(shown.case.name, sampling)
    return Told.of(truth) if isinstance(truth, Truth) else truth


def _drawn(
    shown: Shown, known: Mapping[tuple[str, float], Truth], lines: Mapping[RunKey, Line], room: Room
) -> tuple[Curves, Playback | None]:
    """Return the curves and the animation of a case; the animation is None if there is nothing to show.

    known: the truths of the case by the label of their set of results and the time step (s).
    """
    labels = [one.label for one in shown.sets]
    completed = sorted(
        (v for v in shown.verdicts if v.discrepancy is not None), key=lambda verdict: labels.index(verdict.label)
    )
    return (
        curves.draw({lines[verdict.key.over_cases].label: verdict for verdict in completed}, known, room.points, room.instants),
        animated(
            shown.case.scene,
            {lines[verdict.key.over_cases]: verdict for verdict in shown.verdicts},
            {timestep: truth for (_, timestep), truth in known.items()},
            room.characters,
        ),
    )


def _undrawn(case: str) -> str:
    """Return the text for the section of a case that is not drawn, with the command that draws it."""
    return f"curves and animation, to keep this page small; bodycheck report FOLDER --case {case} --out OTHER draws them"
