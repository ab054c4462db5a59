"""The release of an engine at which a figure broke a limit, with as few of them installed as possible."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from packaging.version import Version

from bodycheck.casefile.case import Case
from bodycheck.environments import environments
from bodycheck.environments.environments import Unobtainable
from bodycheck.errors import BadInput
from bodycheck.running import plan
from bodycheck.running.outcome import Completed, Unsupported
from bodycheck.studies.releases import answers as release_answers
from bodycheck.studies.releases.questions import Question
from bodycheck.studies.releases.rows import ALLOWANCE, UNOBTAINABLE
from bodycheck.studies.releases.study import kept, version
from bodycheck.suggestion import did_you_mean

#: Whether a release is still good; None where it cannot be told.
Probe = Callable[[str], bool | None]


@dataclass(frozen=True)
class Found:
    """Where it changed: last_good and first_bad, between which nothing could be told of `unknown` ones.

    probed: what was looked at, in the order in which it was, the two ends first.
    """

    last_good: str
    first_bad: str
    unknown: tuple[str, ...]
    probed: tuple[str, ...]


class Undecided(Exception):
    """What is given as good or as bad cannot be told to be either; the text says why."""


@dataclass(frozen=True)
class Look:
    """What was seen of a release. figure: None where it has none. reason: why not."""

    version: str
    status: str
    figure: float | None = None
    reason: str = ""

    def is_good(self, limit: float) -> bool | None:
        """Whether the limit is kept, which a run that fails breaks; None where the release cannot be told."""
        if self.status in (UNOBTAINABLE, Unsupported.status):
            return None
        return self.figure is not None and self.figure <= limit

    @property
    def text(self) -> str:
        return f"{self.version}: {self.reason or self.status if self.figure is None else f'{self.figure:.4g}'}"


@dataclass(frozen=True)
class Limit:
    """What is to be kept: a figure of a case with a method, timestep in s. integrator: empty for the engine's first."""

    case: Case
    integrator: str
    timestep: float
    quantity: str
    most: float


class NoChange(Exception):
    """The ends are not what they should be. ends: whether each is good, None where it cannot be told."""

    def __init__(self, good: bool | None, bad: bool | None) -> None:
        super().__init__(good, bad)
        self.ends = good, bad


def bisect(releases: Sequence[str], probe: Probe, cheap: Collection[str] = ()) -> Found:
    """The change between the first release, which is to be good, and the last one, which is to be bad.

    cheap: releases that cost little to look at; they are looked at first. Where good and bad alternate, one of the changes from
    good to bad is found. Of n releases that can all be told, at most 2 + log2(n - 1) are looked at, rounded up.

    Raises `NoChange` where the ends are not good and bad.
    """
    good, bad = 0, len(releases) - 1
    known = {place: probe(releases[place]) for place in (good, bad)}
    if (known[good], known[bad]) != (True, False):
        raise NoChange(known[good], known[bad])
    for among in (cheap, releases):
        while left := [place for place in range(good + 1, bad) if releases[place] in among and place not in known]:
            place = min(left, key=lambda place: abs(2 * place - good - bad))
            known[place] = probe(releases[place])
            if known[place] is not None:
                good, bad = (place, bad) if known[place] else (good, place)
    return Found(releases[good], releases[bad], tuple(releases[good + 1 : bad]), tuple(releases[place] for place in known))


class Observer:
    """Looks at releases of an engine, each at most once. made: environments that were made for it."""

    def __init__(self, engine: str, limit: Limit, jobs: int, told: Callable[[str], None]) -> None:
        plan.check([limit.case], {}, (limit.integrator,) if limit.integrator else (), (limit.timestep,))
        self.engine, self.limit, self.jobs = engine, limit, jobs
        self.cached = frozenset(kept(engine))
        self.looks: dict[str, Look] = {}
        self.made = 0
        self._told = told

    def is_good(self, version: str) -> bool | None:
        """See `Look.is_good`. Raises `BadInput` for an integrator or a figure that there is none of."""
        look = self.looks[version] = self._look(version)
        self._told(look.text)
        return look.is_good(self.limit.most)

    def _look(self, version: str) -> Look:
        try:
            environment = environments.obtain(self.engine, version)
        except Unobtainable as error:
            return Look(version, UNOBTAINABLE, reason=str(error))
        self.made += version not in self.cached
        case, limit = self.limit.case, self.limit
        integrators = (limit.integrator,) if limit.integrator else ()
        question = Question("figures", case.name, case.text, integrators, (limit.timestep,))
        (answer,) = release_answers.ask([(environment, question)], self.jobs, _silent).by_question.values()
        if answer.failure:
            return Look(version, answer.status, reason=answer.failure)
        if answer.lacking:
            return Look(version, Unsupported.status, reason="; ".join(answer.lacking.values()))
        if not limit.integrator and answer.offered:
            self.limit = limit = replace(limit, integrator=answer.offered[0])
        for row in answer.rows:
            if row["integrator"] == limit.integrator:
                return self._seen(version, row)
        return Look(version, Unsupported.status, reason=f"it has no integrator {limit.integrator!r} for this scene")

    def _seen(self, version: str, row: dict[str, Any]) -> Look:
        if row["status"] != Completed.status:
            return Look(version, row["status"], reason=f"{row['status']}: {row['reason']}")
        if (figure := row.get(self.limit.quantity)) is None:
            known = [name.removesuffix(ALLOWANCE) for name in row if name.endswith(ALLOWANCE)]
            meant = did_you_mean(self.limit.quantity, known)
            raise BadInput(f"--quantity {self.limit.quantity}: {row['case']} has {', '.join(known)}{meant}")
        return Look(version, Completed.status, figure)


def between(engine: str, good: str, bad: str) -> tuple[tuple[str, ...], str]:
    """The releases from good to bad, in this order and with both, whichever is the newer; and what is to be said of the list.

    Where there is no index to ask, they are those whose environments are there. Raises `BadInput`.
    """
    start, end = Version(version(good)), Version(version(bad))
    if start == end:
        raise BadInput(f"{good} cannot be both good and bad")
    notice = ""
    try:
        listed = environments.releases(engine)
    except Unobtainable as error:
        listed, notice = environments.cached(engine), f"{error}; going on with those whose environments are there"
    # What the index calls a release comes last and wins: 4.0 is its 4.0.0.
    names = {Version(name): name for name in (str(start), str(end), *listed)}
    inside = sorted((one for one in names if min(start, end) <= one <= max(start, end)), reverse=start > end)
    return tuple(names[one] for one in inside), notice


def find(engine: str, good: str, bad: str, observer: Observer) -> tuple[Found, str]:
    """Where the observer's limit came to be broken on the way from one release to another, and a notice as above.

    Raises `BadInput` where the first does not keep it, or the other one does, and `Undecided` where that cannot be told.
    """
    row, notice = between(engine, good, bad)
    try:
        return bisect(row, observer.is_good, observer.cached), notice
    except NoChange as error:
        good, bad = row[0], row[-1]
        if None in error.ends:
            unclear = [end for end, is_good in zip((good, bad), error.ends, strict=True) if is_good is None]
            raise Undecided("; ".join(f"{engine} {observer.looks[end].text}" for end in unclear)) from error
        told = f"{engine} {observer.looks[good].text}; {observer.looks[bad].text}; the limit is {observer.limit.most:g}"
        if error.ends == (False, True):
            raise BadInput(f"{good} breaks the limit and {bad} keeps it: give them the other way round ({told})") from error
        wrong = f"{good} breaks the limit too" if not error.ends[0] else f"{bad} keeps the limit too"
        raise BadInput(f"{wrong} ({told})") from error


def as_json(found: Found, observer: Observer) -> dict[str, Any]:
    """Return the document that `bodycheck bisect --json` prints."""
    limit = observer.limit
    where = {"case": limit.case.name, "integrator": limit.integrator, "timestep": limit.timestep}
    looks = [asdict(look) for look in observer.looks.values()]
    return where | {"quantity": limit.quantity, "limit": limit.most, **asdict(found), "looks": looks, "made": observer.made}


def _silent(done: str, count: int = 1, /) -> None:
    pass
