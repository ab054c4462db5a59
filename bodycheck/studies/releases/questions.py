"""Questions to releases of an engine, and how they are put to one: in its environment, with an answer in a file.

Little is imported here, for every question is put from a process of its own.
"""

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from subprocess import TimeoutExpired
from typing import Any, Literal

from bodycheck.environments import environments
from bodycheck.environments.environments import Environment, Unobtainable
from bodycheck.running.outcome import Crashed, TimedOut
from bodycheck.studies.orders import Order

PROGRAM = "bodycheck.studies.releases.measurement"

#: Seconds that one question to one release may take. Every run that it takes has a limit of its own.
TIME_LIMIT = 3600.0


@dataclass(frozen=True)
class Question:
    """What is asked of a release, on one case.

    kind: its figures with these methods; or how one integrator converges, over the ladder of the case. name, text: of the case.
    integrators: all that it has where none is named. timesteps: s, those of `bodycheck.running.plan.plan` where none is given.
    """

    kind: Literal["figures", "orders"]
    name: str
    text: str
    integrators: tuple[str, ...] = ()
    timesteps: tuple[float, ...] = ()


@dataclass(frozen=True)
class Answer:
    """What a release gives.

    Parameters
    ----------
    offered
        Spellings of the methods that it has for the scene.
    lacking
        Of the methods that were asked for, those that it does not have, with the reasons.
    rows, orders
        Figures with their allowances, or the orders of the quantities.
    status, failure
        Why there is nothing else; empty where there is.
    """

    offered: tuple[str, ...] = ()
    lacking: Mapping[str, str] = field(default_factory=dict)
    rows: tuple[dict[str, Any], ...] = ()
    orders: tuple[Order, ...] = ()
    status: str = "ok"
    failure: str = ""


@dataclass(frozen=True)
class Errand:
    """Questions to one release, with the files for the answers."""

    environment: Environment
    questions: tuple[tuple[Question, Path], ...]
    jobs: int


def put(errand: Errand) -> Answer:
    """Have a release answer its questions into their files; what to say of those that it leaves without an answer."""
    questions = [(asdict(question), str(path)) for question, path in errand.questions]
    request = {"engine": errand.environment.engine, "jobs": errand.jobs, "questions": questions}
    limit = TIME_LIMIT * len(questions)
    try:
        done = environments.run(errand.environment, PROGRAM, (), stdin=json.dumps(request), timeout=limit)
    except TimeoutExpired:
        return failed(TimedOut(limit))
    except Unobtainable as error:
        return failed(Crashed(str(error)))
    last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return failed(Crashed(f"its process ended without an answer: {last}"))


def failed(outcome: Crashed | TimedOut) -> Answer:
    """What there is to say where no answer came."""
    return Answer(status=outcome.status, failure=outcome.reason)


def store(answer: Answer, path: Path) -> None:
    """Write an answer into a file, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(f".{os.getpid()}.part")
    part.write_text(json.dumps(asdict(answer)), "utf-8")
    os.replace(part, path)


def stored(path: Path) -> Answer | None:
    """The answer in a file; None where none is there, or none that can be read."""
    try:
        known = json.loads(path.read_text("utf-8"))
        orders = tuple(Order(**order) for order in known["orders"])
        return Answer(**known | {"offered": tuple(known["offered"]), "rows": tuple(known["rows"]), "orders": orders})
    except (OSError, ValueError, TypeError, KeyError):
        return None


def question_of(asked: dict[str, Any]) -> Question:
    """A question from its parts as JSON has them."""
    lists = {"integrators": tuple(asked["integrators"]), "timesteps": tuple(asked["timesteps"])}
    return Question(**asked | lists)
