"""Ask engines in a worker process whether they can be used, before this process imports them.

An engine may end its process, hang or crash when it is imported, or when it forms the record of its version and integrators.
What fails so in the worker is not imported here.
"""

import sys
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Adapter
from bodycheck.running import pool
from bodycheck.running.outcome import Crashed, TimedOut

#: Time limit for the import and the record of one engine. Some compile code when they are imported.
TIME_LIMIT_S = 60.0


@dataclass(frozen=True)
class Fault:
    """Why an engine cannot be used.

    Parameters
    ----------
    reason
        A sentence.
    broken
        Whether the engine is there but fails; False if it is not installed or unknown.
    """

    reason: str
    broken: bool


#: What was asked before, by the engine and the path on which it was searched: an engine is asked once by each process.
_known: dict[tuple[str, tuple[str, ...]], Fault | None] = {}


def faults(names: Sequence[str]) -> dict[str, Fault]:
    """Return why some of the engines cannot be used; the others can be imported here.

    One worker process asks all engines in turn. An engine that crashes or hangs ends the process, and the others are asked in
    another one.
    """
    path = tuple(sys.path)
    asked = [name for name in dict.fromkeys(names) if (name, path) not in _known]
    with closing(pool.call_all(_ask, asked, jobs=1, limit=TIME_LIMIT_S)) as answers:
        for name, answer in answers:
            if isinstance(answer, Crashed | TimedOut):
                answer = Fault(f"{name} fails when it is imported: {answer.reason}", broken=True)
            _known[name, path] = answer
    return {name: fault for name in names if (fault := _known[name, path]) is not None}


def load(names: Sequence[str]) -> tuple[dict[str, Adapter], dict[str, Fault]]:
    """Import the engines that can be used; return their adapters, and why the others cannot be used, by name."""
    found = faults(names)
    adapters: dict[str, Adapter] = {}
    for name in names:
        if name not in found:
            try:
                adapters[name] = registry.load(name)
            except registry.EngineMissing as error:
                found[name] = _fault(error)
    return adapters, found


def _ask(name: str) -> Fault | None:
    try:
        registry.load(name)
    except registry.EngineMissing as error:
        return _fault(error)
    return None


def _fault(error: registry.EngineMissing) -> Fault:
    return Fault(str(error), isinstance(error, registry.EngineBroken))
