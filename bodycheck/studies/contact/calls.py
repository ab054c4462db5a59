"""The work of a worker process in a study of contact: one probe of one method, a run, or truths.

It is separate from `measuring`, so that workers do not import the modules that only the study itself needs.
"""

from dataclasses import dataclass

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.results.outcome import Run
from bodycheck.running.tasks import Task, Truths, TruthTask, perform
from bodycheck.studies.audit.flights import Pilot
from bodycheck.studies.contact.probes import BY_NAME
from bodycheck.studies.contact.property import Property


@dataclass(frozen=True)
class ProbeCall:
    """A call of a probe for a method of an engine."""

    engine: str
    method: Method
    probe: str


#: The answer to the call of a probe.
Properties = tuple[Property, ...]

#: The work of a worker process.
Call = ProbeCall | Task | TruthTask


def make(call: Call) -> Properties | Run | Truths:
    """Make a probe, make a run or compute truths. Exceptions that the engine raises in a probe are passed on."""
    if isinstance(call, ProbeCall):
        return BY_NAME[call.probe](Pilot(registry.load(call.engine), call.method.name, call.method.timestep))
    return perform(call)


def group(call: Call) -> str | None:
    """Return the group of calls that share processes: the name of the engine, or None for truths."""
    return None if isinstance(call, TruthTask) else call.engine
