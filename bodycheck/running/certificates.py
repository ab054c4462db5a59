"""Look up how well the truth of a shipped case is known.

A proof of a truth takes up to minutes, so that runs do not make it: `python docs/proved.py` writes the certificates.
"""

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from bodycheck.casefile.content import Case
from bodycheck.casefile.identity import identity

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
