"""Compare the physics of case files: body, initial state, surroundings and run, but not titles or expectations."""

import json
import tomllib
from collections.abc import Iterator, Mapping
from hashlib import sha256
from typing import Any

from bodycheck.casefile.case import Case

#: Tables and keys of a case file that do not affect the motion.
NOT_PHYSICS = {"format", "name", "title", "source", "tags", "extremes", "expect"}


def physics(case: Case) -> dict[str, Any]:
    """Return the tables of a case file that affect the motion."""
    return {name: value for name, value in tomllib.loads(case.text).items() if name not in NOT_PHYSICS}


def identity(case: Case) -> str:
    """Return a SHA-256 digest of the tables of a case that affect the motion."""
    return sha256(json.dumps(physics(case), sort_keys=True).encode()).hexdigest()


def differences(one: Case, other: Case) -> list[tuple[str, Any, Any]]:
    """Return the dotted keys that affect the motion and differ between two cases, with both values; None for a missing key."""
    here, there = dict(_leaves(physics(one))), dict(_leaves(physics(other)))
    return [(key, here.get(key), there.get(key)) for key in {**here, **there} if here.get(key) != there.get(key)]


def _leaves(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value
