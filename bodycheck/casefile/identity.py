"""Compare the physics of case files, and look up the certificates of shipped cases by it.

The physics are body, initial state, surroundings and run, but not titles or expectations. A proof of a truth takes up to
minutes, so that runs do not make it: `python docs/proved.py` writes the certificates.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.resources import files
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


#: The file beside the cases.
FILE = "certificates.json"


@dataclass(frozen=True)
class Certified:
    """The certificate of a shipped case.

    Attributes
    ----------
    identity
        The digest of the content of the case that affects its motion.
    word
        "enclosed", "cross-checked" or "estimated".
    until
        The instant (s) until which the motion is enclosed; None if all of it is, or nothing.
    distance
        The largest proved distance of a printed attitude from the exact one (rad), to two digits; None without a proof.
    radius
        The largest radius of a ball of the proof, before anything is rounded to doubles; None without a proof.
    way
        The method of the proof with the precision of its arithmetic; empty without a proof.
    seconds
        The processor time of the proof (s); None without a proof.
    reason
        Why there is no proof, as a noun phrase; empty if there is one.
    """

    identity: str
    word: str
    until: float | None = None
    distance: float | None = None
    radius: float | None = None
    way: str = ""
    seconds: float | None = None
    reason: str = ""


@cache
def certificates() -> dict[str, Certified]:
    """Return the certificates of the shipped cases by their names."""
    records = json.loads(files("bodycheck.cases").joinpath(FILE).read_text("utf-8"))
    return {name: Certified(**record) for name, record in records.items()}


def certificate_of(case: Case) -> Certified | None:
    """Return the certificate of a case; None if it is not a shipped one, or has another content."""
    known = certificates().get(case.name)
    return known if known is not None and known.identity == identity(case) else None


def word_of(case: Case, *, compared: bool) -> str:
    """Return the word that says how well the truth of a case is known, without a proof of its own.

    compared: whether the truth was compared with another way.
    """
    known = certificate_of(case)
    if known is not None:
        return known.word
    return "cross-checked" if compared else "estimated"
