"""The work of a worker process in an audit: one probe of one method, or one run.

It is separate from `study`, so that workers do not import the modules that only the audit itself needs.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from bodycheck.adapters import registry
from bodycheck.results.outcome import Run
from bodycheck.running.plan import Task
from bodycheck.running.tasks import perform_run
from bodycheck.studies.audit import nondeterminism
from bodycheck.studies.audit.flights import Pilot
from bodycheck.studies.audit.probe import Finding
from bodycheck.studies.audit.probes import PROBES, long_run


@dataclass(frozen=True)
class Call:
    """A call of a probe for a method with a time step (s)."""

    engine: str
    integrator: str
    timestep: float
    probe: str


@dataclass(frozen=True)
class Found:
    """The answer to a call.

    Parameters
    ----------
    findings
        The findings of the probe.
    flights
        The states of flights that are compared with flights in other processes, by words that say when they were made.
    attitude_error
        The largest attitude error (rad) in the run of the flip; None for any other call.
    """

    findings: tuple[Finding, ...] = ()
    flights: Mapping[str, nondeterminism.States] = field(default_factory=dict)
    attitude_error: float | None = None


def make(call: Call | Task) -> Found | Run:
    """Make a probe or a run, and return its answer. Exceptions that the engine raises in a probe are passed on."""
    if isinstance(call, Task):
        return perform_run(call)
    pilot = _pilot(call.engine, call.integrator, call.timestep)
    if call.probe == nondeterminism.NAME:
        return Found(flights=nondeterminism.repeated(pilot))
    if call.probe == nondeterminism.ELSEWHERE:
        return Found(flights=nondeterminism.elsewhere(pilot))
    if call.probe == long_run.NAME:
        return Found(long_run.long_run(pilot))
    return Found(PROBES[call.probe](pilot))


@lru_cache(maxsize=1)
def _pilot(engine: str, integrator: str, timestep: float) -> Pilot:
    """Return the pilot of a method. It is kept until the next method is probed, because several probes use the same flights."""
    return Pilot(registry.load(engine), integrator, timestep)
