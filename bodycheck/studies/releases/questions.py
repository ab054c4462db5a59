"""Questions to a release of an engine. A process in the environment of the release prints the answers.

The process also keeps each answer in the cache, unless it is no measurement: if a process died or exceeded a limit, or if the
environment changed meanwhile, the next study asks again.

This module imports little, because the questions to every release are asked from a separate process.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from datetime import datetime
from subprocess import TimeoutExpired
from typing import Any, Literal

from bodycheck.environments import environments, user_cache
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.studies.orders import Order

#: The module that answers questions in the environment of a release.
PROGRAM = "bodycheck.studies.releases.measurement"

#: The folder of answers in the cache.
MEASUREMENTS = "measurements"

#: Time limit (s) of one question to one release. In addition, each run has a time limit.
TIME_LIMIT_S = 3600.0


@dataclass(frozen=True)
class Question:
    """A request for results of a release on one case.

    Parameters
    ----------
    kind
        Either the figures of the runs, or the orders of convergence over the ladder of the case.
    name, text
        The name of the case, and the text of its file.
    integrators
        Spellings of methods; if it is empty, all methods that the release offers.
    timesteps
        Time steps (s). If it is empty, the default time steps: for figures, 2 ms and the time steps of the case's expectations;
        for orders, the ladder of the case.
    """

    kind: Literal["figures", "orders"]
    name: str
    text: str
    integrators: tuple[str, ...] = ()
    timesteps: tuple[float, ...] = ()


@dataclass(frozen=True)
class Answer:
    """The answer of a release to a question.

    Parameters
    ----------
    offered
        Spellings of the methods that the release offers for the scene.
    lacking
        The methods in the question that the release does not have, and the reasons.
    rows, orders
        The figures with their allowances, or the orders of the quantities.
    status, failure
        The status and the reason of a failure; `failure` is empty if the question was answered.
    lost
        Whether a process crashed or exceeded a limit, so that the answer, or a part of it, is no measurement.
    """

    offered: tuple[str, ...] = ()
    lacking: Mapping[str, str] = field(default_factory=dict)
    rows: tuple[dict[str, Any], ...] = ()
    orders: tuple[Order, ...] = ()
    status: str = "ok"
    failure: str = ""
    lost: bool = False


@dataclass(frozen=True)
class Errand:
    """The questions to one release.

    Parameters
    ----------
    environment
        The environment of the release.
    contents
        The digest of its packages.
    questions
        The questions, each with the name of its answer in the cache.
    jobs
        The number of processes.
    """

    environment: Environment
    contents: str
    questions: tuple[tuple[Question, str], ...]
    jobs: int


def put(errand: Errand) -> tuple[Answer, ...]:
    """Run the program of a release, and return its answers to all questions, in their order."""
    environment = errand.environment
    request = {
        "engine": environment.engine,
        "jobs": errand.jobs,
        "folders": [str(folder) for folder in environments.package_folders(environment)],
        "contents": errand.contents,
        "questions": [(asdict(question), name) for question, name in errand.questions],
    }
    limit = TIME_LIMIT_S * len(errand.questions)
    try:
        done = environments.run(environment, PROGRAM, (), stdin=json.dumps(request), timeout=limit)
    except TimeoutExpired as error:
        printed, failure = (error.stdout or b"").decode("utf-8", "replace"), failed(TimedOut(limit))
    except Unobtainable as error:
        printed, failure = "", failed(Crashed(str(error)))
    else:
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        printed, failure = done.stdout, failed(Crashed(f"its process ended without an answer: {last}"))
    answers = list(_printed(printed))
    return (*answers, *[failure] * (len(errand.questions) - len(answers)))


def failed(outcome: Crashed | TimedOut) -> Answer:
    """Return the answer for a question whose process failed."""
    return Answer(status=outcome.status, failure=outcome.reason, lost=True)


def text_of(answer: Answer) -> str:
    """Return an answer as one line of JSON."""
    return json.dumps(asdict(answer))


def kept(name: str) -> tuple[Answer, datetime] | None:
    """Return the answer of a name in the cache, and when it was measured; None if there is none."""
    try:
        return None if (entry := user_cache.kept(name)) is None else (_answer_of(entry.text), entry.time)
    except (ValueError, TypeError, KeyError, RecursionError):
        return None


def _printed(text: str) -> Iterator[Answer]:
    """Yield the answers in the output of the program of a release. Its last line is incomplete if it was killed."""
    for line in text.splitlines(keepends=True):
        if line.endswith("\n"):
            yield _answer_of(line)


def _answer_of(text: str) -> Answer:
    content = json.loads(text)
    orders = tuple(Order(**order) for order in content["orders"])
    return Answer(**content | {"offered": tuple(content["offered"]), "rows": tuple(content["rows"]), "orders": orders})


def question_of(record: dict[str, Any]) -> Question:
    """Return the question that a JSON object describes."""
    lists = {"integrators": tuple(record["integrators"]), "timesteps": tuple(record["timesteps"])}
    return Question(**record | lists)
