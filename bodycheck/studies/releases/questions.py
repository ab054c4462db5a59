"""Questions to a release of an engine. A process in the environment of the release writes the answers into files.

This module imports little, because the questions to every release are asked from a separate process.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from subprocess import TimeoutExpired
from typing import Any, Literal

from bodycheck.environments import environments
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.files import writing
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.studies.orders import Order

#: The module that answers questions in the environment of a release.
PROGRAM = "bodycheck.studies.releases.measurement"

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
    """

    offered: tuple[str, ...] = ()
    lacking: Mapping[str, str] = field(default_factory=dict)
    rows: tuple[dict[str, Any], ...] = ()
    orders: tuple[Order, ...] = ()
    status: str = "ok"
    failure: str = ""


@dataclass(frozen=True)
class Errand:
    """The questions to one release, with the files for the answers and the number of processes."""

    environment: Environment
    questions: tuple[tuple[Question, Path], ...]
    jobs: int


def put(errand: Errand) -> Answer:
    """Run the program of a release, which writes answers into files, and return the answer for questions without a file."""
    questions = [(asdict(question), str(path)) for question, path in errand.questions]
    request = {"engine": errand.environment.engine, "jobs": errand.jobs, "questions": questions}
    limit = TIME_LIMIT_S * len(questions)
    try:
        done = environments.run(errand.environment, PROGRAM, (), stdin=json.dumps(request), timeout=limit)
    except TimeoutExpired:
        return failed(TimedOut(limit))
    except Unobtainable as error:
        return failed(Crashed(str(error)))
    last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return failed(Crashed(f"its process ended without an answer: {last}"))


def failed(outcome: Crashed | TimedOut) -> Answer:
    """Return the answer for a question whose process failed."""
    return Answer(status=outcome.status, failure=outcome.reason)


def store(answer: Answer, path: Path) -> None:
    """Write an answer into a file, completely or not at all."""
    writing.make_folder(path.parent)
    writing.write(path, json.dumps(asdict(answer)).encode("utf-8"))


def stored(path: Path) -> Answer | None:
    """Return the answer in a file; None if there is no file, or if it cannot be read."""
    try:
        content = json.loads(path.read_text("utf-8"))
        orders = tuple(Order(**order) for order in content["orders"])
        return Answer(**content | {"offered": tuple(content["offered"]), "rows": tuple(content["rows"]), "orders": orders})
    except (OSError, ValueError, TypeError, KeyError):
        return None


def question_of(record: dict[str, Any]) -> Question:
    """Return the question that a JSON object describes."""
    lists = {"integrators": tuple(record["integrators"]), "timesteps": tuple(record["timesteps"])}
    return Question(**record | lists)
