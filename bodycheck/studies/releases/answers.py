"""Get the answers of releases to questions, from a cache or by measurements in the environments of the releases.

A cached answer is used if everything that determines it is unchanged: the release and its environment, the case, the methods,
bodycheck's own source, the packages with which it computes, and the machine.
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
from bodycheck.environments import user_cache
from bodycheck.environments.environments import Environment
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.results import versions
from bodycheck.studies.releases.questions import TIME_LIMIT_S, Answer, Errand, Question, failed, put, stored

if TYPE_CHECKING:
    from bodycheck.running.campaign import Advance

#: The packages that compute truths and errors.
PACKAGES = ("numpy", "scipy", "heyoka")

#: Folders whose source determines an answer. In a checkout, the last two are linked folders, into which `rglob` does not go.
SOURCE_FOLDERS = (Path(errors.__file__).parent, *map(Path, adapters.__path__), *map(Path, reference.__path__))

Asked = tuple[Environment, Question]


@dataclass(frozen=True)
class Answers:
    """The answers by release and question, and the number of answers that were measured; the others were cached."""

    by_question: Mapping[Asked, Answer]
    measured: int

    @property
    def known(self) -> int:
        return len(self.by_question) - self.measured


def known(questions: Sequence[Asked]) -> bool:
    """Return whether the answers to all questions are cached."""
    return all(stored(_path(*pair)) is not None for pair in questions)


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
    paths = {pair: _path(*pair) for pair in dict.fromkeys(questions)}
    answers = {pair: answer for pair, path in paths.items() if (answer := stored(path)) is not None}
    if answers:
        progress("", len(answers))
    errands = _errands({pair: path for pair, path in paths.items() if pair not in answers}, jobs)
    limit = TIME_LIMIT_S * max((len(errand.questions) for errand in errands), default=1)
    with pool.Workers(put, jobs, limit + pool.SHUTDOWN_TIMEOUT_S) as workers:
        for errand, result in workers.map(errands):
            failure = failed(result) if isinstance(result, Crashed | TimedOut) else result
            for question, path in errand.questions:
                pair = errand.environment, question
                answers[pair] = stored(path) or failure
                progress(f"{errand.environment.engine} {errand.environment.version} · {question.name}")
    measured = sum(len(errand.questions) for errand in errands)
    return Answers({pair: answers[pair] for pair in paths}, measured)


def _errands(left: Mapping[Asked, Path], jobs: int) -> list[Errand]:
    """Return one errand for each release. The processes are shared equally among the releases, at least one for each."""
    releases = dict.fromkeys(environment for environment, _ in left)
    share = max(1, jobs // max(1, len(releases)))
    return [
        Errand(
            release, tuple((question, path) for (environment, question), path in left.items() if environment == release), share
        )
        for release in releases
    ]


def _path(environment: Environment, question: Question) -> Path:
    """Return the file of an answer, whose name is a digest of everything that determines the answer."""
    decides = _context(environment.engine), _contents(environment), question, _tolerated(question)
    return user_cache.folder() / "measurements" / f"{sha256(repr(decides).encode()).hexdigest()}.json"


@cache
def _contents(environment: Environment) -> tuple[object, ...]:
    """Return the contents of an environment: the environment, with the path of its interpreter, and its packages."""
    packages = ("lib/*/site-packages/*.dist-info", "Lib/site-packages/*.dist-info")
    return environment, sorted({path.name for pattern in packages for path in environment.python.parents[1].glob(pattern)})


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
