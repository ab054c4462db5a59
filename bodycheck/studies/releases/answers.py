"""Get the answers of releases to questions, from a cache or by measurements in the environments of the releases.

A cached answer is used if everything that determines it is unchanged: the release and the files of its environment, the case,
the methods, bodycheck's own source, the packages with which it computes, and the machine.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck import adapters, errors, reference
from bodycheck.adapters import registry
from bodycheck.casefile import case
from bodycheck.environments import contents, environments, user_cache
from bodycheck.environments.environments import Environment
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.results import versions
from bodycheck.studies.releases.questions import MEASUREMENTS, TIME_LIMIT_S, Answer, Errand, Question, failed, kept, put

if TYPE_CHECKING:
    from bodycheck.running.campaign import Advance

#: The packages that compute truths and errors.
PACKAGES = ("numpy", "scipy", "heyoka")

#: Folders whose source determines an answer. In a checkout, the last two are linked folders, into which `rglob` does not go.
SOURCE_FOLDERS = (Path(errors.__file__).parent, *map(Path, adapters.__path__), *map(Path, reference.__path__))

Asked = tuple[Environment, Question]


@dataclass(frozen=True)
class Answers:
    """The answers by release and question, and the times at which those that come from the cache were measured."""

    by_question: Mapping[Asked, Answer]
    kept: tuple[datetime, ...]

    @property
    def measured(self) -> int:
        return len(self.by_question) - len(self.kept)


def known(questions: Sequence[Asked]) -> bool:
    """Return whether the answers to all questions are cached."""
    return all(kept(name) is not None for name in _names(questions).values())


def forget(questions: Sequence[Asked]) -> None:
    """Remove the answers to questions from the cache, so that they are measured anew."""
    for name in _names(questions).values():
        user_cache.forget(name)


def ask(questions: Sequence[Asked], jobs: int, progress: "Advance") -> Answers:
    """Return the answers to all questions, in their order. Answers that are not cached are measured.

    If the process of a release crashes or exceeds its time limit, the missing answers have this failure.

    Parameters
    ----------
    questions
        Pairs of environment and question.
    jobs
        The number of processes.
    progress
        A function that is called with a text after each answer.
    """
    names = _names(questions)
    cached = {pair: entry for pair, name in names.items() if (entry := kept(name)) is not None}
    answers = {pair: answer for pair, (answer, _) in cached.items()}
    if answers:
        progress("", len(answers))
    errands = _errands({pair: name for pair, name in names.items() if pair not in answers}, jobs)
    limit = TIME_LIMIT_S * max((len(errand.questions) for errand in errands), default=1)
    with pool.Workers(put, jobs, limit + pool.SHUTDOWN_TIMEOUT_S) as workers:
        for errand, result in workers.map(errands):
            replies = [failed(result)] * len(errand.questions) if isinstance(result, Crashed | TimedOut) else result
            for (question, _), answer in zip(errand.questions, replies, strict=True):
                answers[errand.environment, question] = answer
                progress(f"{errand.environment.engine}@{errand.environment.version} · {question.name}")
    return Answers({pair: answers[pair] for pair in names}, tuple(time for _, time in cached.values()))


def _errands(left: Mapping[Asked, str], jobs: int) -> list[Errand]:
    """Return one errand for each release. The processes are shared equally among the releases, at least one for each."""
    releases = dict.fromkeys(environment for environment, _ in left)
    share = max(1, jobs // max(1, len(releases)))
    return [
        Errand(
            release,
            _contents(release),
            tuple((question, name) for (environment, question), name in left.items() if environment == release),
            share,
        )
        for release in releases
    ]


def _names(questions: Sequence[Asked]) -> dict[Asked, str]:
    """Return the names of answers in the cache, which contain a digest of everything that determines the answer."""
    packages = {
        environment: _contents(environment) for environment in dict.fromkeys(environment for environment, _ in questions)
    }
    return {
        (environment, question): _name(_context(environment.engine), environment, packages[environment], question)
        for environment, question in dict.fromkeys(questions)
    }


def _name(context: tuple[object, ...], environment: Environment, packages: str, question: Question) -> str:
    decides = context, environment, packages, question, _tolerated(question)
    return f"{MEASUREMENTS}/{sha256(repr(decides).encode()).hexdigest()}.json"


def _contents(environment: Environment) -> str:
    """Return a digest of the packages of an environment: of the sizes and times of all their files."""
    return contents.of_folders(environments.package_folders(environment))


def _tolerated(question: Question) -> tuple[bool, ...]:
    """Return for each known discrepancy of a case, in the order of its expectations, whether it is tolerated today."""
    today = datetime.now(UTC).date()
    expectations = case.parse_stored(question.text, question.name).expectations
    return tuple(expectation.until >= today for expectation in expectations if expectation.until is not None)


@cache
def _context(engine: str) -> tuple[object, ...]:
    """Return the context on which all answers depend: the sources of bodycheck and the adapter, the packages, the machine."""
    return _digest(engine), [(name, _version(name)) for name in PACKAGES], versions.fingerprint()


def _digest(engine: str) -> str:
    sources = {path.resolve() for folder in SOURCE_FOLDERS for path in folder.rglob("*.py")}
    files = sorted(sources.union(map(Path.resolve, registry.sources(engine))))
    return sha256(b"".join(sha256(path.read_bytes()).digest() for path in files)).hexdigest()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
