"""Compare the physics of case files: body, initial state, surroundings and run, but not titles or expectations."""

import json
from collections.abc import Iterator, Mapping
from hashlib import sha256
from typing import Any

from bodycheck.casefile.content import Case
from bodycheck.casefile.mechanisms.model import standalone
from bodycheck.casefile.mechanisms.stored import loads
from bodycheck.reference.mechanisms.mechanism import Mechanism

#: Tables and keys of a case file that do not affect the motion.
NOT_PHYSICS = {"format", "name", "title", "source", "tags", "extremes", "ensemble", "expect"}


def physics(case: Case) -> dict[str, Any]:
    """Return the tables of a case that affect the motion, with the bodies and joints of a robot model instead of its file."""
    document = standalone(loads(case.text))
    tables = {name: value for name, value in document.items() if name not in NOT_PHYSICS}
    until = case.scene.stops_until if isinstance(case.scene, Mechanism) else None
    return tables if until is None else tables | {"stops_until": until}


def identity(case: Case) -> str:
    """Return a SHA-256 digest of the tables of a case that affect the motion."""
    return sha256(json.dumps(physics(case), sort_keys=True).encode()).hexdigest()


def keys(case: Case) -> dict[str, str]:
    """Return the dotted keys of a case that affect the motion, with their values as JSON."""
    return dict(_leaves(physics(case)))


def changed_keys(base: Mapping[str, str], now: Mapping[str, str]) -> list[tuple[str, str | None, str | None]]:
    """Return the keys that differ between two cases, as `keys` returns them, with both values; None for a missing key."""
    return [(key, base.get(key), now.get(key)) for key in {**base, **now} if base.get(key) != now.get(key)]


def _leaves(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{prefix}{name}.")
        elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
            for number, item in enumerate(value, start=1):
                yield from _leaves(item, f"{prefix}{name}[{number}].")
        else:
            yield prefix + name, json.dumps(value)
