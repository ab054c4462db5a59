"""Find the release of an engine at which a figure exceeded a limit, with as few installations as possible."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from packaging.version import Version

from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.adapters.roles import alias, aliases
from bodycheck.casefile.content import Case
from bodycheck.environments import environments
from bodycheck.environments.environments import Unobtainable
from bodycheck.errors import BadInput
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.running import plan
from bodycheck.running.roles import BOTH, refuse_timesteps
from bodycheck.studies.releases import answers as release_answers
from bodycheck.studies.releases.questions import Question
from bodycheck.studies.releases.rows import ALLOWANCE_SUFFIX, UNOBTAINABLE
from bodycheck.studies.releases.study import kept, version
from bodycheck.suggestion import did_you_mean

#: A function that returns whether a release is good; None if that cannot be determined.
Probe = Callable[[str], bool | None]


@dataclass(frozen=True)
class Found:
    """The result of a bisection.

    Parameters
    ----------
    last_good, first_bad
        The releases between which the change happened.
    unknown
        The releases between these two that could not be measured.
    probed
        All releases that were measured, in the order of measurement, which begins with the first and the last release.
    """

    last_good: str
    first_bad: str
    unknown: tuple[str, ...]
    probed: tuple[str, ...]


class Undecided(Exception):
    """The error that one of the two given releases cannot be measured; the text says why."""


@dataclass(frozen=True)
class Look:
    """The measurement of a release. `figure` is None if it could not be measured; `reason` then says why."""

    version: str
    status: str
    figure: float | None = None
    reason: str = ""

    def is_good(self, limit: float) -> bool | None:
        """Return whether the release keeps the limit, which a failed run does not; None if it could not be measured."""
        if self.status in (UNOBTAINABLE, Unsupported.status):
            return None
        return self.figure is not None and self.figure <= limit

    @property
    def text(self) -> str:
        """The version with its figure, or with the reason why it has none."""
        return f"{self.version}: {self.reason or self.status if self.figure is None else f'{self.figure:.4g}'}"


@dataclass(frozen=True)
class Limit:
    """The limit of a figure of results, for one case and one method.

    Parameters
    ----------
    case
        The case.
    integrator
        The spelling of the method, or an alias, which stands for the method that the first measured release has behind it;
        empty for the first method of the engine.
    timestep
        The time step (s); None for that of the alias, or 2 ms.
    quantity
        A column of results.
    most
        The largest allowed value.
    """

    case: Case
    integrator: str
    timestep: float | None
    quantity: str
    most: float


class NoChange(Exception):
    """The error that the first release is not good or the last release is not bad.

    `ends` contains for both releases whether they are good; None if that is unknown.
    """

    def __init__(self, good: bool | None, bad: bool | None) -> None:
        super().__init__(good, bad)
        self.ends = good, bad


def bisect(releases: Sequence[str], probe: Probe, cheap: Collection[str] = ()) -> Found:
    """Find the change from good to bad between the first and the last release of a sequence.

    If good and bad releases alternate, one of the changes from good to bad is found. Of n releases that can all be measured, at
    most 2 + log2(n - 1), rounded up, are measured.

    Parameters
    ----------
    releases
        The releases in order; the first should be good and the last bad.
    probe
        The function that measures a release.
    cheap
        Releases whose measurement is cheap; they are measured first.

    Raises
    ------
    NoChange
        If the first release is not good or the last release is not bad, or if this cannot be determined.
    """
    good, bad = 0, len(releases) - 1
    is_good = {index: probe(releases[index]) for index in (good, bad)}
    if (is_good[good], is_good[bad]) != (True, False):
        raise NoChange(is_good[good], is_good[bad])
    for among in (cheap, releases):
        while left := [index for index in range(good + 1, bad) if releases[index] in among and index not in is_good]:
            index = min(left, key=lambda index: abs(2 * index - good - bad))
            is_good[index] = probe(releases[index])
            if is_good[index] is not None:
                good, bad = (index, bad) if is_good[index] else (good, index)
    return Found(releases[good], releases[bad], tuple(releases[good + 1 : bad]), tuple(releases[index] for index in is_good))


class Observer:
    """The observer that measures releases of an engine and checks a limit.

    Parameters
    ----------
    engine
        The name of the engine.
    limit
        The limit to check.
    jobs
        The number of processes.
    report
        A function that is called with a text about each measured release.
    again
        Whether every release is measured anew, and replaces what is in the cache.

    The attribute `looks` holds the measurements by version, and `made` counts the environments that were made.
    """

    def __init__(self, engine: str, limit: Limit, jobs: int, report: Callable[[str], None], again: bool = False) -> None:
        integrators = (limit.integrator,) if limit.integrator else ()
        if limit.timestep is None and not aliases(integrators):
            limit = replace(limit, timestep=DEFAULT_TIMESTEP)
        timesteps = () if limit.timestep is None else (limit.timestep,)
        refuse_timesteps(integrators, timesteps)
        plan.check([limit.case], {}, integrators, timesteps)
        self.engine, self.limit, self.jobs = engine, limit, jobs
        self.cached = frozenset(kept(engine))
        self.looks: dict[str, Look] = {}
        self.made = 0
        self._report, self._again = report, again

    def is_good(self, version: str) -> bool | None:
        """Measure a release, and return whether it keeps the limit; see `Look.is_good`.

        Raises `BadInput` if the case does not have the quantity.
        """
        look = self.looks[version] = self._look(version)
        self._report(look.text)
        return look.is_good(self.limit.most)

    def _look(self, version: str) -> Look:
        try:
            environment = environments.obtain(self.engine, version)
        except Unobtainable as error:
            return Look(version, UNOBTAINABLE, reason=str(error))
        self.made += version not in self.cached
        case, limit = self.limit.case, self.limit
        integrators = (limit.integrator,) if limit.integrator else ()
        timesteps = () if limit.timestep is None else (limit.timestep,)
        question = Question("figures", case.name, case.text, integrators, timesteps)
        if self._again:
            release_answers.forget([(environment, question)])
        (answer,) = release_answers.ask([(environment, question)], self.jobs, _silent).by_question.values()
        if answer.failure:
            return Look(version, answer.status, reason=answer.failure)
        if answer.lacking:
            return Look(version, Unsupported.status, reason="; ".join(answer.lacking.values()))
        if not limit.integrator and answer.offered:
            self.limit = limit = replace(limit, integrator=answer.offered[0])
        if (role := alias(limit.integrator)) is not None:
            for row in answer.rows:
                if role in row.get("role", "").split(BOTH):
                    self.limit = replace(limit, integrator=row["integrator"], timestep=row["timestep"])
                    return self._seen(version, row)
        for row in answer.rows:
            if row["integrator"] == limit.integrator:
                return self._seen(version, row)
        return Look(version, Unsupported.status, reason=f"it has no integrator {limit.integrator!r} for this scene")

    def _seen(self, version: str, row: dict[str, Any]) -> Look:
        if row["status"] != Completed.status:
            return Look(version, row["status"], reason=f"{row['status']}: {row['reason']}")
        if (figure := row.get(self.limit.quantity)) is None:
            known = [name.removesuffix(ALLOWANCE_SUFFIX) for name in row if name.endswith(ALLOWANCE_SUFFIX)]
            meant = did_you_mean(self.limit.quantity, known)
            raise BadInput(f"--quantity {self.limit.quantity}: {row['case']} has {', '.join(known)}{meant}")
        return Look(version, Completed.status, figure)


def between(engine: str, good: str, bad: str) -> tuple[tuple[str, ...], str]:
    """Return the releases from `good` to `bad`, both included, and a notice for the user, which may be empty.

    Either of the two may be the newer release. If no package index can be reached, only releases with an environment are
    included between them, and the notice says so. Raises `BadInput` for text that is not a version, and if both versions are
    equal.
    """
    start, end = Version(version(good)), Version(version(bad))
    if start == end:
        raise BadInput(f"{good} cannot be both good and bad")
    notice = ""
    try:
        listed = environments.releases(engine)
    except Unobtainable as error:
        listed, notice = environments.cached(engine), f"{error}; continuing with the releases that have an environment"
    # The spelling of the index comes last and takes precedence: if 4.0 is given, 4.0.0 is used.
    names = {Version(name): name for name in (str(start), str(end), *listed)}
    inside = sorted((one for one in names if min(start, end) <= one <= max(start, end)), reverse=start > end)
    return tuple(names[one] for one in inside), notice


def find(engine: str, good: str, bad: str, observer: Observer) -> tuple[Found, str]:
    """Find the release between two releases at which the observer's limit was exceeded.

    The result is returned with the notice of `between`.

    Parameters
    ----------
    engine
        The name of the engine.
    good, bad
        A release that should keep the limit, and a release that should exceed it.
    observer
        The observer, which measures releases and checks the limit.

    Raises
    ------
    BadInput
        If the good release exceeds the limit, or if the bad release keeps it.
    Undecided
        If one of the two releases cannot be measured.
    """
    row, notice = between(engine, good, bad)
    try:
        return bisect(row, observer.is_good, observer.cached), notice
    except NoChange as error:
        good, bad = row[0], row[-1]
        if None in error.ends:
            unclear = [end for end, is_good in zip((good, bad), error.ends, strict=True) if is_good is None]
            raise Undecided("; ".join(f"{engine} {observer.looks[end].text}" for end in unclear)) from error
        report = f"{engine} {observer.looks[good].text}; {observer.looks[bad].text}; the limit is {observer.limit.most:g}"
        if error.ends == (False, True):
            raise BadInput(f"{good} exceeds the limit and {bad} keeps it; exchange the two ({report})") from error
        wrong = f"{good} exceeds the limit too" if not error.ends[0] else f"{bad} keeps the limit too"
        raise BadInput(f"{wrong} ({report})") from error


def as_json(result: Found, observer: Observer) -> dict[str, Any]:
    """Return the document that `bodycheck bisect --json` prints."""
    limit = observer.limit
    where = {"case": limit.case.name, "integrator": limit.integrator, "timestep": limit.timestep}
    looks = [asdict(look) for look in observer.looks.values()]
    return where | {"quantity": limit.quantity, "limit": limit.most, **asdict(result), "looks": looks, "made": observer.made}


def _silent(done: str, count: int = 1, /) -> None:
    pass
