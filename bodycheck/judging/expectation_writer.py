"""Expectations set from what was measured, in a case file that is left as it was in everything else.

A limit is a margin times what was measured, rounded down to two digits. What is nothing but rounding differs between machines:
such a figure is taken for its floor. A comment behind each limit says what was measured, with which version, and the margin.
"""

import json
import math
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Context
from pathlib import Path

import tomlkit
from tomlkit.items import Float, Integer

from bodycheck.adapters.contract import Adapter
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.case import Case, parse, shipped
from bodycheck.casefile.toml_positions import entries, positions
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES, LIMITED, truth_bounds
from bodycheck.figures.scales import in_scene
from bodycheck.files import writing
from bodycheck.judging.judgement import Verdict
from bodycheck.reference.truth import NoTruth, Truth
from bodycheck.running import plan as planned
from bodycheck.running.outcome import Crashed, TimedOut
from bodycheck.running.plan import Task
from bodycheck.running.store import Results

#: A figure below this part of what it is the difference of is nothing but rounding, as one below the truth's own bound is.
ROUNDING = 1e-12

DIGITS = 2
#: Rounding down to two digits takes at most an eleventh.
SMALLEST_MARGIN = 1.1

#: Column, counted from 0, of a comment on a line that has none yet.
COMMENT_COLUMN = 45

#: A comment that `_limit` wrote, which is renewed with the number; any other one stays.
COMMENT_ON_LIMIT = re.compile(r"# \S+ x .*measured with .*")


@dataclass(frozen=True)
class Measurement:
    """What a method gave. figures: those that may be limited, and floors: below which they are rounding, by their names."""

    verdict: Verdict
    figures: Mapping[str, float]
    floors: Mapping[str, float]


@dataclass(frozen=True)
class Change:
    """What became of a measurement, in words. done: whether the file agrees with it now."""

    verdict: Verdict
    text: str
    done: bool = True


def measure(verdict: Verdict, truth: Truth | NoTruth) -> Measurement:
    """The figures of a run, none where it is not ok. truth: of its scene, at its instants."""
    if verdict.discrepancy is None or isinstance(truth, NoTruth):
        return Measurement(verdict, {}, {})
    maxima = verdict.discrepancy.maxima()
    figures = {name: maxima[name] for name in LIMITED if name in maxima}
    return Measurement(verdict, figures, floors(truth, figures))


def floors(truth: Truth, names: Iterable[str]) -> dict[str, float]:
    """What rounding may come to in figures, in their units."""
    scales = in_scene(truth)
    bounds = {name: float(bound.max()) for name, bound in truth_bounds(truth).items()}
    return {name: max(ROUNDING * FIGURES[name].scale(scales), bounds.get(name, 0.0)) for name in names}


def check_margin(margin: float) -> None:
    """Raises `BadInput` for a margin that rounding would bring below 1."""
    if not SMALLEST_MARGIN <= margin < math.inf:
        raise BadInput(f"--margin {margin:g}: must be at least {SMALLEST_MARGIN:g}, as limits are rounded down to two digits")


def places(files: Sequence[str], cases: Sequence[Case]) -> dict[str, Path]:
    """The files that cases came from, each given once or more, by the cases' names.

    Raises `BadInput` where there are none, for the name of a shipped case, and for a file in which expectations are an array of
    inline tables, to which none can be added.
    """
    if not files:
        raise BadInput("expect: give at least one case file")
    found = {}
    for file, case in zip(dict.fromkeys(files), cases, strict=True):
        if file in shipped():
            raise BadInput(f"{file}: the name of a shipped case; give the path of a file, which will be written to")
        expect = entries(case.text, [("expect",)]).get(("expect",))
        if expect is not None and expect.value is not None:
            raise BadInput(f"{file}: expect: an array; write its elements as [[expect]] tables, to which others can be added")
        found[case.name] = Path(file)
    return found


def plan(
    cases: Sequence[Case], engines: Mapping[str, Adapter], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """What is measured: the runs of `running.plan.plan`, without the finer steps that only serve to see an order.

    Raises `BadInput` as `running.plan.plan` does.
    """
    return tuple(
        task
        for task in planned.plan(cases, engines, integrators, timesteps)
        if task.method.timestep in (timesteps or (DEFAULT_TIMESTEP,))
        or any(e.concerns(task.engine, task.method) for e in task.case.expectations)
    )


def write(results: Results, verdicts: Sequence[Verdict], places: Mapping[str, Path], margin: float) -> list[Change]:
    """Set the expectations in the files of cases, by their names, from results that were judged. Raises `BadInput`."""
    changes = []
    by_case: dict[str, list[Verdict]] = defaultdict(list)
    for verdict in verdicts:
        by_case[verdict.run.case].append(verdict)
    for name, case in results.cases.items():
        file, own = places[name], by_case[name]
        measurements = [measure(verdict, results.truth(name, verdict.run.method.timestep)) for verdict in own]
        text, made = rewrite(case, measurements, margin)
        parse(text, str(file))
        try:
            if file.read_bytes() != case.text.encode():
                raise BadInput(f"{file}: has changed meanwhile; nothing is written")
        except OSError as error:
            raise BadInput(f"{file}: cannot be read: {error.strerror}") from error
        writing.write_named(file, text.encode("utf-8"))
        changes += made
    return changes


def rewrite(case: Case, measurements: Sequence[Measurement], margin: float) -> tuple[str, list[Change]]:
    """The text of a case's file with its expectations set, and what was done.

    Where something is expected of a method already, its numbers are renewed; ranges, orders, statuses and what is known to fail
    stay. Of others all figures are limited, in tables at the end.
    """
    newline = "\r\n" if "\r\n" in case.text else "\n"
    lines = case.text.split("\n")
    changes: list[Change] = []
    tables: list[str] = []
    for measurement in measurements:
        verdict = measurement.verdict
        run, outcome = verdict.run, verdict.outcome
        places = [place for place, expectation in enumerate(case.expectations) if expectation.concerns(run.engine, run.method)]
        if isinstance(outcome, Crashed | TimedOut) and not places:
            changes.append(Change(verdict, f"nothing is written: {outcome.status}: {outcome.reason}", done=False))
        elif not places:
            tables += ["", *_table(measurement, margin)]
            changes.append(Change(verdict, "written"))
        changes += [_renew(lines, case, place, measurement, margin) for place in places]
    text = "\n".join(lines)
    if tables and not text.endswith("\n"):
        text += newline
    return text + "".join(line + newline for line in tables), changes


def _renew(lines: list[str], case: Case, place: int, measurement: Measurement, margin: float) -> Change:
    """Renew the numbers of one of a case's expectations in the lines of its file, and return what was done.

    Lines are edited one by one because tomlkit moves the tables of an array together where others stand between them, as in a
    file to which `rewrite` has added tables.
    """
    verdict, expectation = measurement.verdict, case.expectations[place]
    outcome = verdict.outcome
    if expectation.known:
        return Change(verdict, f"left as it is: known to fail ({expectation.known})")
    if outcome.status != expectation.status:
        found = f"{outcome.status}: {outcome.reason}".removesuffix(": ")
        return Change(verdict, f"left as it is: {expectation.status} is expected, found is {found}", done=False)
    there = positions(case.text, [("expect", place, name) for name in measurement.figures])
    renewed = False
    for name in measurement.figures:
        if position := there.get(("expect", place, name)):
            line = lines[position.line - 1]
            if (new := _with_number(line, name, *_limit(measurement, name, margin))) is not None:
                lines[position.line - 1] = new
                renewed = True
    return Change(verdict, "renewed" if renewed else "left as it is: it has no numbers")


def _with_number(line: str, name: str, number: str, comment: str) -> str | None:
    """Return a line of a case file with another number, and a comment on it in the column of the one that is there.

    A comment that is not from this module stays. Returns None if the line does not set a key to a number.
    """
    document = tomlkit.parse(f"{line}\n")  # a carriage return is valid only before a line feed
    value = document.get(name)
    if not isinstance(value, Integer | Float):
        return None
    column = line.index("#") if value.trivia.comment else COMMENT_COLUMN
    if value.trivia.comment and not COMMENT_ON_LIMIT.fullmatch(value.trivia.comment):
        comment = value.trivia.comment
    document[name] = renewed = tomlkit.value(number)
    renewed.trivia.comment = ""
    end = "\r" if line.endswith("\r") else ""
    return f"{document.as_string().rstrip():<{column - 1}} {comment}{end}"


def _table(measurement: Measurement, margin: float) -> list[str]:
    """The lines of a new expectation."""
    run, status = measurement.verdict.run, measurement.verdict.outcome.status
    lines = ["[[expect]]", f"engine = {_quoted(run.engine)}", f"integrator = {_quoted(run.method.name)}"]
    lines.append(f"timestep = {run.method.timestep!r}")
    if not measurement.figures:
        return [*lines, f"{f'status = {_quoted(status)}':<{COMMENT_COLUMN - 1}} # found with {run.engine} {run.version}"]
    for name in measurement.figures:
        number, comment = _limit(measurement, name, margin)
        lines.append(f"{f'{name} = {number}':<{COMMENT_COLUMN - 1}} {comment}")
    return lines


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _limit(measurement: Measurement, name: str, margin: float) -> tuple[str, str]:
    """The limit of a figure and the comment on it."""
    value, floor, run = measurement.figures[name], measurement.floors[name], measurement.verdict.run
    found = f"{value:.3g} measured with {run.engine} {run.version}"
    if value >= floor:
        return _rounded_down(margin * value), f"# {margin:g} x {found}"
    return _rounded_down(margin * floor), f"# {margin:g} x {floor:.2g}, the floor: {found} is rounding"


def _rounded_down(value: float) -> str:
    return f"{float(Context(prec=DIGITS, rounding=ROUND_FLOOR).create_decimal(repr(value))):g}"
