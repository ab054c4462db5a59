"""Set the expectations in a case file from measurements, and leave the rest of the file unchanged.

A limit is a margin times the measured figure, rounded down to two digits. A figure that is only rounding error differs between
machines; it is replaced by its floor. A comment behind each limit states the measured figure, the version of the engine, and
the margin.
"""

import json
import math
import re
import tomllib
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Context
from pathlib import Path
from typing import cast

import numpy as np
import tomlkit
from tomlkit.items import Item

from bodycheck.adapters.contract import Engine
from bodycheck.adapters.engine_name import in_words
from bodycheck.casefile.case import Case, parse, shipped
from bodycheck.casefile.expectation import unit
from bodycheck.casefile.mechanisms.stored import file_text
from bodycheck.casefile.toml_positions import Position, entries, positions
from bodycheck.errors import BadInput
from bodycheck.figures.columns import FIGURES, LIMITED, most_possible, truth_bounds
from bodycheck.figures.scales import in_scene
from bodycheck.files import writing
from bodycheck.judging.judgement import Verdict
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.truths import NoTruth, Truth
from bodycheck.results.store import Results
from bodycheck.running import plan as planned
from bodycheck.running.plan import Task
from bodycheck.suggestion import did_you_mean

#: A figure below this fraction of the numbers whose difference it is counts as rounding error, like a figure below the bound of
#: the truth's own error.
ROUNDING = 1e-12

DIGITS = 2
#: Rounding down to two digits reduces a number by at most one eleventh.
SMALLEST_MARGIN = 1.1

#: Column, counted from 0, of a new comment on a line.
COMMENT_COLUMN = 45

#: The pattern of comments that `_limit` writes. Such a comment is renewed with the number; any other comment stays.
COMMENT_ON_LIMIT = re.compile(r"# \S+ x .*measured with .*")


@dataclass(frozen=True)
class Measurement:
    """The measured figures of a method.

    Attributes
    ----------
    verdict
        The verdict on its run.
    figures
        The figures to be limited, by name.
    floors
        The values below which the figures count as rounding error, by name.
    most
        The largest possible values of the figures, by name.
    """

    verdict: Verdict
    figures: Mapping[str, float]
    floors: Mapping[str, float]
    most: Mapping[str, float]


@dataclass(frozen=True)
class Limited:
    """A limit for a case file. number: its digits; comment: the measurement; idle: why it cannot fail; empty if it can."""

    number: str
    comment: str
    idle: str


@dataclass(frozen=True)
class Change:
    """The effect of a measurement on the file, in words. done: whether the file now agrees with the measurement."""

    verdict: Verdict
    text: str
    done: bool = True


def measure(verdict: Verdict, truth: Truth | NoTruth, asked: Collection[str] = ()) -> Measurement:
    """Return the measured figures of a run; none if the run has no figures or there is no truth.

    Parameters
    ----------
    verdict
        The verdict on the run.
    truth
        The truth of its scene, at its instants.
    asked
        The names of the figures; if empty, all figures that a case may limit.
    """
    if verdict.discrepancy is None or isinstance(truth, NoTruth):
        return Measurement(verdict, {}, {}, {})
    maxima, last = verdict.discrepancy.maxima(), float(truth.trajectory.t[-1])
    figures = {name: maxima[name] for name in asked or LIMITED if name in maxima}
    return Measurement(verdict, figures, floors(truth, figures), {name: most_possible(name, last) for name in figures})


def floors(truth: Truth, names: Iterable[str]) -> dict[str, float]:
    """Return the values below which figures count as rounding error, by name, in their units."""
    scales = in_scene(truth)
    bounds = {name: float(np.fmax.reduce(bound)) for name, bound in truth_bounds(truth).items()}
    return {name: max(ROUNDING * FIGURES[name].scale(scales), bounds.get(name, 0.0)) for name in names}


def check_margin(margin: float) -> None:
    """Raise `BadInput` for a margin that the rounding of a limit could bring below 1."""
    if not SMALLEST_MARGIN <= margin < math.inf:
        raise BadInput(f"--margin {margin:g}: must be at least {SMALLEST_MARGIN:g}, as limits are rounded down to two digits")


def check_figures(names: Sequence[str]) -> None:
    """Raise `BadInput` for a figure that cannot be written as a limit."""
    allowed = [name for name in LIMITED if name in FIGURES]
    for name in names:
        if name not in allowed:
            raise BadInput(f"--figure {name}: allowed: {', '.join(allowed)}{did_you_mean(name, allowed)}")


def places(files: Sequence[str], cases: Sequence[Case]) -> dict[str, Path]:
    """Return the files of cases by the names of the cases. files: the paths as given, possibly repeated.

    Raises `BadInput` if there are no files, for the name of a shipped case, and for a file whose expectations are an array of
    inline tables, to which no table can be added.
    """
    if not files:
        raise BadInput("expect: give at least one case file")
    paths = {}
    for file, case in zip(dict.fromkeys(files), cases, strict=True):
        if file in shipped():
            raise BadInput(f"{file}: the name of a shipped case; give the path of a file, which will be written to")
        expect = entries(file_text(case), [("expect",)]).get(("expect",))
        if expect is not None and expect.value is not None:
            raise BadInput(f"{file}: expect: an array; write its elements as [[expect]] tables, to which others can be added")
        paths[case.name] = Path(file)
    return paths


def plan(
    cases: Sequence[Case], engines: Mapping[str, Engine], integrators: Sequence[str], timesteps: Sequence[float]
) -> tuple[Task, ...]:
    """Return the runs to measure: all of `running.plan.plan`, without the finer steps that only serve to measure orders.

    Raises `BadInput` as `running.plan.plan` does.
    """
    return tuple(
        task
        for task in planned.plan(cases, engines, integrators, timesteps)
        if task.method in planned.methods_in(task.case, engines[task.engine], integrators, timesteps)
        or any(e.concerns(task.engine, task.method) for e in task.case.expectations)
    )


def write(
    results: Results,
    verdicts: Sequence[Verdict],
    places: Mapping[str, Path],
    margin: float,
    figures: Sequence[str] = (),
) -> list[Change]:
    """Set the expectations in the files of cases from judged results, for some figures or all, and return the changes.

    places: the files by the names of the cases. Raises `BadInput` if a file has changed, or a new text is no valid case.
    """
    changes = []
    by_case: dict[str, list[Verdict]] = defaultdict(list)
    for verdict in verdicts:
        by_case[verdict.run.case].append(verdict)
    for name, case in results.cases.items():
        file, verdicts_of_case = places[name], by_case[name]
        measurements = [
            measure(verdict, results.truth(name, verdict.run.method.sampling), figures) for verdict in verdicts_of_case
        ]
        text, changes_of_case = rewrite(case, measurements, margin)
        parse(text + case.text.removeprefix(file_text(case)), str(file))
        try:
            if file.read_bytes() != file_text(case).encode():
                raise BadInput(f"{file}: has changed meanwhile; nothing is written")
        except OSError as error:
            raise BadInput(f"{file}: cannot be read: {error.strerror}") from error
        writing.write_named(file, text.encode("utf-8"))
        changes += changes_of_case
    return changes


def rewrite(case: Case, measurements: Sequence[Measurement], margin: float) -> tuple[str, list[Change]]:
    """Return the text of a case's file with its expectations set, and the changes.

    If the case already has expectations of a method, their numbers and version are renewed; ranges, orders, statuses and known
    discrepancies stay. For other methods, all measured figures get limits in new tables at the end. A limit that cannot fail is
    not written.
    """
    newline = "\r\n" if "\r\n" in file_text(case) else "\n"
    lines = file_text(case).split("\n")
    changes: list[Change] = []
    tables: list[str] = []
    for measurement in measurements:
        run = measurement.verdict.run
        places = [index for index, expectation in enumerate(case.expectations) if expectation.concerns(run.engine, run.method)]
        if not places:
            table, change = _table(measurement, margin)
            tables += table
            changes.append(change)
        changes += [_renew(lines, case, index, measurement, margin) for index in places]
    text = "\n".join(lines)
    if tables and not text.endswith("\n"):
        text += newline
    return text + "".join(line + newline for line in tables), changes


def _table(measurement: Measurement, margin: float) -> tuple[list[str], Change]:
    """Return the lines of a new expectation of a method without expectations, and the change."""
    verdict = measurement.verdict
    run, outcome = verdict.run, verdict.outcome
    if isinstance(outcome, Crashed | TimedOut):
        return [], Change(verdict, f"nothing is written: {outcome.status}: {outcome.reason}", done=False)
    limits = {name: _limit(measurement, name, margin) for name in measurement.figures}
    idle = _told_idle(limits.values())
    written = {name: limit for name, limit in limits.items() if not limit.idle}
    if verdict.discrepancy is not None and not written:
        return [], Change(verdict, f"nothing is written: {idle or 'none of the figures exists in this scene'}", done=False)
    lines = ["", "[[expect]]", f"engine = {_quoted(run.engine)}", f"integrator = {_quoted(run.method.name)}"]
    lines += [f"timestep = {run.method.timestep!r}", f"version = {_quoted(run.version)}"]
    if verdict.discrepancy is None:
        lines.append(_with_comment(f"status = {_quoted(outcome.status)}", f"# found with {in_words(run.engine, run.version)}"))
    lines += [_with_comment(f"{name} = {limit.number}", limit.comment) for name, limit in written.items()]
    return lines, Change(verdict, "; ".join(filter(None, ("written", idle))))


def _renew(lines: list[str], case: Case, index: int, measurement: Measurement, margin: float) -> Change:
    """Renew the numbers of one of a case's expectations in the lines of its file, and return the change.

    Lines are edited one by one, because tomlkit moves the tables of an array together if other tables are between them, as in a
    file to which `rewrite` has added tables.
    """
    verdict, expectation = measurement.verdict, case.expectations[index]
    outcome = verdict.outcome
    if expectation.known:
        return Change(verdict, f"left as it is: known to fail ({expectation.known})")
    if outcome.status != expectation.status:
        outcome_text = f"{outcome.status}: {outcome.reason}".removesuffix(": ")
        return Change(verdict, f"left as it is: {expectation.status} is expected, found is {outcome_text}", done=False)
    numbers = _numbers(case, index)
    limits = {name: _limit(measurement, name, margin) for name in measurement.figures if name in numbers}
    renewed = {name: limit for name, limit in limits.items() if not limit.idle}
    there = positions(file_text(case), [("expect", index, name) for name in (*renewed, "timestep", "version")])
    for name, limit in renewed.items():
        at = there["expect", index, name].line - 1
        lines[at] = _with_value(lines[at], name, tomlkit.value(limit.number), limit.comment)
    if renewed and renewed.keys() == numbers:
        version = there.get(("expect", index, "version"))
        _set_version(lines, version, there["expect", index, "timestep"], verdict.run.version)
    idle = _told_idle(limits.values())
    nothing = "left as it is" if numbers else "left as it is: it has no numbers"
    text = "; ".join(filter(None, ("renewed" if renewed else nothing, idle)))
    return Change(verdict, text, done=not idle)


def _numbers(case: Case, index: int) -> set[str]:
    """Return the names of the figures that one of a case's expectations limits by a number, and not by a range."""
    table = tomllib.loads(file_text(case))["expect"][index]
    return {name for name in FIGURES if isinstance(table.get(name), int | float)}


def _set_version(lines: list[str], version: Position | None, timestep: Position, value: str) -> None:
    """Set the version in an expectation. version, timestep: the positions of these keys.

    If there is no version, its line is appended to the line of the time step, so that later lines keep their numbers.
    """
    if version is not None:
        lines[version.line - 1] = _with_value(lines[version.line - 1], "version", tomlkit.string(value))
        return
    before = lines[timestep.line - 1].partition("\n")[0]
    end = "\r" if before.endswith("\r") else ""
    lines[timestep.line - 1] = f"{before}\nversion = {_quoted(value)}{end}"


def _with_value(line: str, name: str, value: Item, comment: str = "") -> str:
    """Return a line of a case file with a new value of its key, and a comment in the column of the previous comment.

    A previous comment that was not written by this module stays.
    """
    document = tomlkit.parse(f"{line}\n")  # a carriage return is valid only before a line feed
    trivia = cast(Item, document.item(name)).trivia
    column = line.index("#", len(line.rstrip()) - len(trivia.comment)) if trivia.comment else COMMENT_COLUMN
    if trivia.comment and not COMMENT_ON_LIMIT.fullmatch(trivia.comment):
        comment = trivia.comment
    document[name] = value
    cast(Item, document.item(name)).trivia.comment = ""  # it was copied from the previous value
    return _with_comment(document.as_string().rstrip(), comment, column) + ("\r" if line.endswith("\r") else "")


def _with_comment(text: str, comment: str, column: int = COMMENT_COLUMN) -> str:
    """Return a line of a case file with a comment, unless it is empty, at a column that is counted from 0."""
    return f"{text:<{column - 1}} {comment}" if comment else text


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _limit(measurement: Measurement, name: str, margin: float) -> Limited:
    """Return the limit of a figure, with its comment."""
    value, floor, run = measurement.figures[name], measurement.floors[name], measurement.verdict.run
    measured = f"{value:.3g} measured with {in_words(run.engine, run.version)}"
    number, comment = _rounded_down(margin * value), f"# {margin:g} x {measured}"
    if value < floor:
        number, comment = _rounded_down(margin * floor), f"# {margin:g} x {floor:.2g}, the floor: {measured} is rounding"
    most = measurement.most[name]
    beyond = f"{margin:g} x {value:.3g} is not below {most:.4g}{unit(name)}, the most possible"
    idle = f"no limit of {name}, about which the method says nothing here: {beyond}"
    return Limited(number, comment, idle if float(number) >= most else "")


def _told_idle(limits: Iterable[Limited]) -> str:
    return "; ".join(limit.idle for limit in limits if limit.idle)


def _rounded_down(value: float) -> str:
    return f"{float(Context(prec=DIGITS, rounding=ROUND_FLOOR).create_decimal(repr(value))):g}"
