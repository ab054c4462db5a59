"""Run the same cases and methods in several releases of an engine, and find the changes between them."""

import math
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

from packaging.version import InvalidVersion, Version

from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case
from bodycheck.casefile.identity import identity
from bodycheck.environments import environments
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.errors import BadInput
from bodycheck.figures.revisions import REVISIONS
from bodycheck.judging.baselines import difference
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Unsupported
from bodycheck.running import campaign, fetch_environments, plan
from bodycheck.running.roles import refuse_timesteps
from bodycheck.studies.orders import Order
from bodycheck.studies.releases import answers as release_answers
from bodycheck.studies.releases.questions import Answer, Question
from bodycheck.studies.releases.rows import STATUS, UNOBTAINABLE, Change, Found, ReleasesHeader, Row
from bodycheck.studies.tradeoff.measurements import COLUMNS

if TYPE_CHECKING:
    from bodycheck.running.campaign import Advance

#: A function that shows a progress bar for a title and a number of units; see `bodycheck.console.terminal.progress`.
Bar = Callable[[str, int], "AbstractContextManager[Advance]"]

#: The quantity of each column of results that belongs to a quantity whose order is observed.
QUANTITIES = {column: quantity for quantity, columns in COLUMNS.items() for column in columns}

Releases = Mapping[str, Environment | Unobtainable]


@dataclass(frozen=True)
class Tally:
    """The effort of a study: the numbers of environments made, of answers measured, and of answers taken from the cache.

    `since` is the day on which the oldest answer in the cache was measured; it is empty if none was taken from there.
    """

    made: int
    measured: int
    known: int
    since: str = ""

    @property
    def text(self) -> str:
        kept = f" (measured since {self.since}; --again measures anew)" if self.known else ""
        return f"environments made: {self.made}; measured: {self.measured}; from the cache: {self.known}{kept}"


def version(text: str) -> str:
    """Return a version in its normalised spelling. Raises `BadInput` for text that is not a version."""
    try:
        return str(Version(text))
    except InvalidVersion as error:
        raise BadInput(f"{text!r} is not a version; an example is 3.2.0") from error


def chosen(engine: str, versions: Sequence[str], last: int | None) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the named versions together with the newest `last` versions, ascending, and notices about the choice.

    If no package index can be reached, the newest versions are chosen among those with an environment, and a notice says so.

    Parameters
    ----------
    engine
        The name of the engine.
    versions
        The named versions.
    last
        The number of newest versions, or None to add none.

    Raises
    ------
    BadInput
        If a text is not a version, if `last` is less than 1, or if no version is chosen.
    """
    names, notices = {Version(version(text)): version(text) for text in versions}, []
    if last is not None:
        if last < 1:
            raise BadInput(f"--last {last}: must be at least 1")
        try:
            newest = environments.releases(engine)[-last:]
        except Unobtainable as error:
            newest = tuple(kept(engine))[-last:]
            notices.append(f"{error}; the newest releases are those that have an environment")
        names |= {Version(name): name for name in newest}
    if not names:
        raise BadInput("; ".join(notices) or "give versions, or the number of newest releases: --last N")
    return tuple(names[one] for one in sorted(names)), tuple(notices)


def study(
    engine: str,
    versions: Sequence[str],
    cases: Sequence[Case],
    integrators: Sequence[str],
    timesteps: Sequence[float],
    jobs: int,
    bar: Bar,
    notices: Sequence[str] = (),
    again: bool = False,
) -> tuple[Found, Tally]:
    """Measure releases, and return the results of the study and its effort.

    Parameters
    ----------
    engine
        The name of the engine.
    versions
        The releases, ascending.
    cases
        The cases to run.
    integrators
        Spellings of methods, and aliases; all that each release offers if it is empty.
    timesteps
        Time steps (s). If it is empty, 2 ms and the time steps of the case's expectations.
    jobs
        The number of processes.
    bar
        A function that shows a progress bar.
    notices
        Notices for the reader about the choice of releases.
    again
        Whether everything is measured anew, and replaces what is in the cache.

    Raises
    ------
    BadInput
        If no release has an integrator, or if a time step is not possible.
    """
    refuse_timesteps(integrators, timesteps)
    plan.check(cases, {}, integrators, timesteps)
    integrators = [Method.parse(spelling, 0.0).name for spelling in integrators]
    questions = [Question("figures", case.name, case.text, tuple(integrators), tuple(timesteps)) for case in cases]
    installed = kept(engine)
    if again:
        release_answers.forget([(installed[one], question) for one in versions if one in installed for question in questions])
    obtained = _obtained(engine, versions, questions, jobs, bar)
    with bar("measuring", len(questions) * sum(isinstance(one, Environment) for one in obtained.values())) as progress:
        asked = [(one, question) for one in obtained.values() if isinstance(one, Environment) for question in questions]
        figures = release_answers.ask(asked, jobs, progress)
    answers = {(one.version, question.name): answer for (one, question), answer in figures.by_question.items()}
    _refuse_unknown(engine, integrators, answers.values())
    rows = [row for case in cases for row in rows_of(engine, case, obtained, answers)]
    found_changes = list(changes(rows))
    order_questions = list(dict.fromkeys(_convergences(found_changes, {case.name: case for case in cases}, obtained)))
    if again:
        release_answers.forget(order_questions)
    with bar("observing orders", len(order_questions)) as progress:
        observed = release_answers.ask(order_questions, jobs, progress)
    orders = {(one.version, asked.name, *asked.integrators): answer for (one, asked), answer in observed.by_question.items()}
    tally = Tally(
        sum(isinstance(one, Environment) and one.version not in installed for one in obtained.values()),
        figures.measured + observed.measured,
        len(measured_before := (*figures.kept, *observed.kept)),
        f"{min(measured_before):%Y-%m-%d}" if measured_before else "",
    )
    header = _header(engine, cases, obtained, answers, notices)
    return Found(header, tuple(rows), tuple(_with_orders(change, orders) for change in found_changes)), tally


def _header(
    engine: str,
    cases: Sequence[Case],
    obtained: Releases,
    answers: Mapping[tuple[str, str], Answer],
    notices: Sequence[str],
) -> ReleasesHeader:
    """Return the header of a study.

    obtained: the environments by version, ascending. answers: the answers by version and name of the case.
    """
    versions = list(obtained)
    unmeasured = {version: str(one) for version, one in obtained.items() if isinstance(one, Unobtainable)}
    unmeasured |= {version: answer.failure for (version, _), answer in answers.items() if answer.failure}
    return {
        **campaign.header(sys.argv, {}, {}),
        "engines": {engine: " to ".join(dict.fromkeys((versions[0], versions[-1])))},
        "versions": versions,
        "unmeasured": unmeasured,
        "notices": list(notices),
        "cases": {case.name: identity(case) for case in cases},
        "revisions": REVISIONS,
    }


def kept(engine: str) -> Mapping[str, Environment]:
    """Return the existing environments of an engine by version. Raises `BadInput` for an engine whose package is not known."""
    try:
        return environments.kept(engine)
    except Unobtainable as error:
        raise BadInput(str(error)) from error


def _obtained(engine: str, versions: Sequence[str], questions: Sequence[Question], jobs: int, bar: Bar) -> Releases:
    """Return the environments of versions, or the reasons why they could not be made.

    An existing environment is not checked if all its answers are cached. All others are checked or made.
    """
    installed = kept(engine)
    left = [
        version
        for version in versions
        if version not in installed or not release_answers.known([(installed[version], question) for question in questions])
    ]
    with bar("obtaining", len(left)) as progress:
        fetched = fetch_environments.obtain_all(engine, left, jobs, progress)
    return {version: fetched.get(version) or installed[version] for version in versions}


def changes(rows: Sequence[Row]) -> Iterator[Change]:
    """Yield the changes of each method between successive versions with rows, without orders and schemes.

    Rows of unobtainable versions are skipped. The rows of each method and case must be in the order of the versions.
    """
    methods: dict[RunKey, list[Row]] = defaultdict(list)
    for row in rows:
        if row["status"] != UNOBTAINABLE and row["timestep"] is not None:
            methods[RunKey.of_row(row)].append(row)
    for key, method_rows in methods.items():
        for before, after in pairwise(method_rows):
            for change in difference.changes(key, dict(before), dict(after)):
                yield _without_orders(change, before["version"], after["version"])


def _without_orders(change: difference.Change, before: str, after: str) -> Change:
    assert change.base is not None  # both versions have the figure
    assert change.now is not None
    return Change(
        engine=change.engine,
        case=change.case,
        integrator=change.integrator,
        quantity=change.what,
        from_version=before,
        to_version=after,
        before=change.base,
        after=change.now,
        factor=change.factor if math.isfinite(change.factor) else None,
        order_before=None,
        order_after=None,
        scheme_before="",
        scheme_after="",
        timestep=change.timestep,
        allowance=change.allowance,
    )


def _refuse_unknown(engine: str, integrators: Sequence[str], answers: Iterable[Answer]) -> None:
    """Raise `BadInput` for a method that none of the releases that answered has."""
    report = [answer for answer in answers if not answer.failure]
    for integrator in integrators:
        if report and all(integrator in answer.lacking for answer in report):
            raise BadInput(f"none of these releases of {engine} has this method: {report[-1].lacking[integrator]}")


def rows_of(engine: str, case: Case, obtained: Releases, answers: Mapping[tuple[str, str], Answer]) -> Iterator[Row]:
    """Yield the rows of a case, one for each method and version: the measured figures, or the reason why there are none.

    The methods are in the order of the newest release that has them.

    Parameters
    ----------
    engine
        The name of the engine.
    case
        The case.
    obtained
        The environments by version, ascending, or the reason why there is no environment.
    answers
        The answers by version and name of the case.
    """
    measured = {
        (row["integrator"], row["timestep"], version): row | {"version": version}
        for version in reversed(list(obtained))
        if (version, case.name) in answers
        for row in answers[version, case.name].rows
    }
    # If no release has a measured row, there is one row with an empty method for each version.
    methods: list[tuple[str, float | None]] = list(
        dict.fromkeys((integrator, timestep) for integrator, timestep, _ in measured)
    ) or [("", None)]
    for integrator, timestep in methods:
        for version, one in obtained.items():
            row = {"case": case.name, "engine": engine, "version": version, "integrator": integrator, "timestep": timestep}
            if isinstance(one, Unobtainable):
                yield row | {"status": UNOBTAINABLE, "reason": str(one)}
            elif (integrator, timestep, version) in measured:
                yield measured[integrator, timestep, version]
            elif (answer := answers[version, case.name]).failure:
                yield row | {"status": answer.status, "passed": False, "reason": answer.failure}
            else:
                lacks = f"{engine}@{version} has no integrator {integrator!r} for this scene"
                yield row | {"status": Unsupported.status, "reason": lacks}


def _convergences(
    figure_changes: Sequence[Change], cases: Mapping[str, Case], obtained: Releases
) -> Iterator[tuple[Environment, Question]]:
    """Yield questions about orders of convergence: for each change of a figure, one to either of its two releases."""
    for change in figure_changes:
        for version in (change.from_version, change.to_version):
            one = obtained[version]
            if change.quantity != STATUS and isinstance(one, Environment):
                yield one, Question("orders", change.case, cases[change.case].text, (change.integrator,))


def _with_orders(change: Change, answers: Mapping[tuple[str, ...], Answer]) -> Change:
    before, after = (
        _order(change, answers.get((version, change.case, change.integrator)))
        for version in (change.from_version, change.to_version)
    )
    return replace(change, order_before=before[0], order_after=after[0], scheme_before=before[1], scheme_after=after[1])


def _order(change: Change, answer: Answer | None) -> tuple[float | None, str]:
    """Return the observed order in the quantity of a change, and the scheme of its method, from the answer of one release."""
    orders: dict[str, Order] = {} if answer is None else {order.quantity: order for order in answer.orders}
    of_quantity = orders.get(QUANTITIES.get(change.quantity, ""))
    return (of_quantity.order if of_quantity else None), next((order.scheme for order in orders.values()), "")
