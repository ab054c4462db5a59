"""Check that the expectations of a case file can be checked: their engines exist, and their limits can fail.

An expectation that nothing can break would pass for ever without saying anything. Texts that are stored in results are exempt,
because they may be of earlier versions of bodycheck and of other machines, on which other engines are known.
"""

import sys
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from bodycheck.adapters.engine_name import EngineName
from bodycheck.casefile.expectation import ORDER, unit
from bodycheck.casefile.raw_values import mapping, number
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_EXPECTATIONS
from bodycheck.errors import BadInput
from bodycheck.figures.columns import LIMITED, most_possible
from bodycheck.suggestion import did_you_mean


def uncheckable(document: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults of expectations that cannot be checked, as pairs of path and message.

    The raw document may have any other faults too.
    """
    duration = number(mapping(document.get("run")).get("duration"))
    expect = document.get("expect")
    for index, table in enumerate(expect[:MAX_EXPECTATIONS] if isinstance(expect, list) else []):
        expectation = mapping(table)
        if (fault := _unknown(expectation.get("engine"))) is not None:
            yield ("expect", index, "engine"), fault
        last = duration + number(expectation.get("timestep")) / 2  # the instants of a run are the nearest ends of steps
        for name in [name for name in expectation if name in LIMITED]:
            for path, message in _idle(name, expectation[name], last):
                yield ("expect", index, name, *path), message


def _unknown(engine: Any) -> str | None:
    """Return what is allowed for an engine that has no adapter; None if it has one, and for what the grammar reports."""
    try:
        adapter = EngineName.parse(engine).adapter if isinstance(engine, str) else None
    except BadInput:
        return None
    known = _known_engines(tuple(sys.path))
    if adapter is None or adapter in known:
        return None
    return f"there is no such engine; allowed: {', '.join(known)}{did_you_mean(engine, known)}"


@cache
def _known_engines(path: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of all engines that have an adapter on a path of modules, which is searched once by each process."""
    from bodycheck.adapters import registry  # stored cases are read without it: their engines need not be known

    return registry.names()


def _idle(name: str, allowed: Any, last: float) -> Iterator[tuple[Path, str]]:
    """Yield the ends of an allowed range that no run can break. last: the last instant of the run (s)."""
    ends = allowed if isinstance(allowed, dict) else {"at_most": allowed}
    path = ("at_most",) if isinstance(allowed, dict) else ()
    most = most_possible(name, last)
    if last > 0 and number(ends.get("at_most")) >= most:
        least = f"{most:.6g}{unit(name)}"
        yield path, f"this limit cannot fail, because no run has more than {least}; allowed: less than {least}"
    if list(ends) == ["at_least"] and ends["at_least"] == 0 and name != ORDER:
        yield ("at_least",), "this limit cannot fail, because no run has less than 0; allowed: more than 0, or at_most too"
