"""Write the steps of a run as a script for its engine alone, which can be shown to people without bodycheck."""

from dataclasses import dataclass
from importlib.metadata import version

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported, Scripts
from bodycheck.adapters.engine_name import in_words
from bodycheck.casefile.content import Case
from bodycheck.errors import Failed
from bodycheck.processes import pool
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.running import engines
from bodycheck.running.roles import method_of

#: Time limit (s) for writing a script, which takes as long as building the model.
TIME_LIMIT_S = 120.0

#: The first lines of a script. The title of the case is left out: it is a stranger's text.
HEADER = """\
# What bodycheck {bodycheck} runs as the case {case} in {engine} {version}
# with the method {method} and a time step of {timestep!r} s.
# This script needs the engine and NumPy alone. It prints the states as CSV.
"""


@dataclass(frozen=True)
class Question:
    """The run for which a script is requested: a case, the name of an engine as the user gave it, and a method."""

    case: Case
    engine: str
    method: Method


@dataclass(frozen=True)
class NoScript:
    """The answer that there is no script. The reason is a sentence."""

    reason: str


def script(case: Case, engine: str, integrator: str | None, timestep: float | None = None) -> str:
    """Return a Python script that makes the same steps as a run of a case, and needs only the engine and NumPy.

    The script is written in a worker process, which imports the engine.

    Parameters
    ----------
    case
        The case.
    engine
        The name of an engine that can be used.
    integrator
        The spelling of a method, or an alias; None for the first method that the engine offers for the scene.
    timestep
        The time step (s); None for the one that `simulate` chooses.

    Raises
    ------
    BadInput
        If the engine has no such method, the time step is not possible, or it is named beside an alias.
    Failed
        If the engine cannot model the scene, or no script can be written for it.
    EngineMissing
        If the engine cannot be used.
    """
    record = engines.record(engine)
    if integrator is None:
        names = offers.offered(record, case.scene)
        if not names:
            raise Failed(f"{case.name}: {engine} has no integrator for this scene")
        integrator = names[0]
    question = Question(case, engine, method_of(record, case, integrator, timestep))
    with pool.Workers(written, 1, TIME_LIMIT_S, group=_engine_of, home=engines.home) as workers:
        answer = workers.call(question)
    match answer:
        case str():
            return answer
        case NoScript(reason):
            raise Failed(f"{case.name}: {reason}")
        case Crashed() | TimedOut():
            raise Failed(f"{case.name}: {engine} fails when a script is asked for: {answer.reason}")


def written(question: Question) -> str | NoScript:
    """Return the script of a run, or the reason why there is none. This imports the engine into the process."""
    adapter, case, method = registry.load(question.engine), question.case, question.method
    named = in_words(question.engine, adapter.engine.version)
    record, scene = adapter.engine, case.scene
    lacking = offers.not_offered(record, scene, method) or offers.not_modelled(record, scene, method)
    if lacking is not None:
        return NoScript(f"{named} {lacking}")
    if not isinstance(adapter, Scripts):
        return NoScript(f"{named}: its adapter cannot write scripts")
    try:
        program = adapter.script(case.scene, method, case.duration, case.samples)
    except SceneUnsupported as error:
        return NoScript(str(error))
    header = HEADER.format(
        bodycheck=version("bodycheck"),
        case=case.name,
        engine=adapter.engine.name,
        version=adapter.engine.version,
        method=method.name,
        timestep=method.timestep,
    )
    return header + program


def _engine_of(question: Question) -> str:
    return question.engine
