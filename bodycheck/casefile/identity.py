"""What of a case file decides on what happens in it: its body, start and surroundings, not its title or expectations."""

import json
import tomllib
from collections.abc import Iterator, Mapping
from hashlib import sha256
from typing import Any

from bodycheck.casefile.case import Case

#: Tables and keys of a case file that do not change what happens in it.
NOT_PHYSICS = {"format", "name", "title", "source", "tags", "extremes", "expect"}


def physics(case: Case) -> dict[str, Any]:
    """What its file says of what happens."""
    return {name: value for name, value in tomllib.loads(case.text).items() if name not in NOT_PHYSICS}


def identity(case: Case) -> str:
    """A fingerprint of what happens in a case."""
    return sha256(json.dumps(physics(case), sort_keys=True).encode()).hexdigest()


def differences(one: Case, other: Case) -> list[tuple[str, Any, Any]]:
    """The dotted keys of two case files that decide on what happens and differ, with both values; None where there is none."""
    here, there = dict(_leaves(physics(one))), dict(_leaves(physics(other)))
    return [(key, here.get(key), there.get(key)) for key in {**here, **there} if here.get(key) != there.get(key)]


def _leaves(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value
