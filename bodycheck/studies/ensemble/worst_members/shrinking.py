"""Make a case simpler while it still fails in the same way: shorter, with fewer nonzero numbers, and with rounder numbers.

The search is delta debugging over the keys of the case file: it tries candidates with a part left out, takes candidates that
still fail, and repeats this until no candidate fails. A. Zeller and R. Hildebrandt, "Simplifying and isolating failure-inducing
input", IEEE Transactions on Software Engineering 28 (2002). The search is deterministic, with a bounded number of
trials.
"""

from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import islice
from typing import Any

import numpy as np

from bodycheck.reference.kinematics import euler_from_quaternion

#: A case file as `tomllib` reads it.
Document = dict[str, Any]

#: The place of a key, or of an element of an array, in a document.
Path = tuple[str | int, ...]

#: A function that returns for each of some documents whether it is a case that fails in the same way.
Fails = Callable[[Sequence[Document]], Sequence[bool]]

#: Most trials for one case.
MOST_TRIALS = 300

#: The number of candidates that are tried at once to find one that fails, unless failing trials are costly.
BLOCK = 8

#: The numbers of samples, and the numbers of significant digits, that are tried.
SAMPLES = (2, 3, 6, 11, 21, 51, 101, 201, 501, 1001)
DIGITS = (1, 2, 3, 4, 6)

#: Most durations that are tried, and most solids or particles of a body that are left out one by one.
MOST_DURATIONS, MOST_PARTS = 12, 30

#: The tables with numbers that are left out and rounded.
TABLES = ("body", "initial", "scene")


@dataclass
class Search:
    """The simplest document so far that fails.

    Attributes
    ----------
    document
        The document.
    fails
        Function that returns for each of some documents whether it fails in the same way.
    left
        The number of trials that are left.
    block
        The number of candidates that are tried at once.
    known
        The results of all trials so far, by the text of the document.
    """

    document: Document
    fails: Fails
    left: int
    block: int = BLOCK
    known: dict[str, bool] = field(default_factory=dict)

    def tried(self, candidates: Sequence[Document]) -> list[bool]:
        """Return for each candidate whether it fails in the same way; False for candidates for which no trial is left."""
        new = {key: one for one in candidates if (key := repr(one)) not in self.known}
        new = dict(islice(new.items(), self.left))
        self.left -= len(new)
        if new:
            self.known |= zip(new, self.fails(list(new.values())), strict=True)
        return [self.known.get(repr(one), False) for one in candidates]

    def take(self, candidates: Sequence[Document]) -> bool:
        """Take the first candidate that fails in the same way, and return whether there is one. The simplest comes first."""
        others = [one for one in candidates if one != self.document]
        for first in range(0, len(others), self.block):
            block = others[first : first + self.block]
            for candidate, failing in zip(block, self.tried(block), strict=True):
                if failing:
                    self.document = candidate
                    return True
        return False


def shrink(document: Document, fails: Fails, shortest: float, most: int = MOST_TRIALS, block: int = BLOCK) -> Document:
    """Return the simplest document among all trials that fails in the same way.

    Parameters
    ----------
    document
        A case file that fails.
    fails
        Function that returns for each of some documents whether it fails in the same way. An invalid case does not.
    shortest
        The shortest duration (s) that is tried, a time step.
    most
        The largest number of trials.
    block
        The number of candidates that are tried at once. With 1, hardly any candidate fails without being taken.
    """
    search = Search(_tidy(deepcopy(document)), fails, most, block)
    if search.document != document and not search.tried([search.document])[0]:
        search.document = deepcopy(document)
    before = None
    while search.left > 0 and search.document != before:
        before = search.document
        _shorten(search, shortest)
        _leave_out(search, list(_parts(search.document)))
        _name_angles(search)
        _round(search)
        search.take([_with(search.document, {("run", "samples"): n}) for n in SAMPLES if n < search.document["run"]["samples"]])
    return search.document


def _shorten(search: Search, shortest: float) -> None:
    """Take the shortest of some round durations with which the document still fails."""
    present: float = search.document["run"]["duration"]
    exponents = range(-12, 13)
    durations = [float(f"{digit}e{exponent}") for exponent in exponents for digit in (1, 2, 5)]
    allowed = [one for one in durations if shortest <= one < present][-MOST_DURATIONS:]
    search.take([_with(search.document, {("run", "duration"): one}) for one in allowed])


def _leave_out(search: Search, parts: Sequence[Path]) -> None:
    """Leave out all of some parts or, if the failure needs any of them, the parts of each half that it does not need."""
    if not parts or search.take([_without(search.document, parts)]) or len(parts) == 1:
        return
    middle = len(parts) // 2
    _leave_out(search, parts[middle:])  # the end first, so that the indices of the others stay valid
    _leave_out(search, parts[:middle])


def _name_angles(search: Search) -> None:
    """Replace a quaternion, whose components cannot be rounded one by one, by round Euler angles, if the failure remains."""
    quaternion = search.document.get("initial", {}).get("quaternion")
    if quaternion is None:
        return
    angles = euler_from_quaternion(np.array(quaternion) / np.linalg.norm(quaternion))
    other = _without(search.document, [("initial", "quaternion")])
    rounded = [[round(float(angle), digits) + 0.0 for angle in angles] for digits in DIGITS]
    search.take([_tidy(_with(other, {("initial", "euler_zxz"): each})) for each in rounded])


def _round(search: Search) -> None:
    """Round all numbers at once, and then each number as far as the failure remains."""
    numbers = dict(_numbers(search.document))
    together = [{path: _rounded(value, digits) for path, value in numbers.items()} for digits in DIGITS]
    search.take([_tidy(_with(search.document, changes)) for changes in together])
    for path, value in dict(_numbers(search.document)).items():
        if (present := _digits(value)) > 1:
            simpler = [_rounded(value, digits) for digits in DIGITS if digits < present]
            search.take([_tidy(_with(search.document, {path: one})) for one in simpler])


def _parts(document: Document) -> Iterator[Path]:
    """Yield the paths of all that may be left out of a document: keys, components of vectors, and parts of a composed body."""
    for table in ("scene", "initial"):
        for key, value in document.get(table, {}).items():
            yield table, key
            if isinstance(value, list) and key != "quaternion":
                yield from ((table, key, index) for index, component in enumerate(value) if component != 0)
    body = document["body"]
    if "shape" in body and "inertia" in body:
        yield "body", "inertia"
    for key in ("particles", "parts"):
        if 1 < len(body.get(key, ())) <= MOST_PARTS:
            yield from (("body", key, index) for index in range(len(body[key])))


def _numbers(document: Document) -> Iterator[tuple[Path, float]]:
    """Yield the paths and values of the numbers that may be rounded one by one: all but zeros and quaternions."""
    left: list[tuple[Path, Any]] = [((table,), document.get(table, {})) for table in TABLES]
    while left:
        path, value = left.pop(0)
        if isinstance(value, dict):
            left += [((*path, key), one) for key, one in value.items() if key != "quaternion"]
        elif isinstance(value, list):
            left += [((*path, index), one) for index, one in enumerate(value)]
        elif isinstance(value, float | int) and value != 0:
            yield path, float(value)


def _with(document: Document, changes: dict[Path, Any]) -> Document:
    """Return a document with other values at some paths; missing tables are added."""
    changed = deepcopy(document)
    for (*path, last), value in changes.items():
        table: Any = changed
        for key in path:
            table = table.setdefault(key, {}) if isinstance(table, dict) else table[key]
        table[last] = value
    return changed


def _without(document: Document, parts: Sequence[Path]) -> Document:
    """Return a document without some parts; a component of a vector becomes zero."""
    shorter = deepcopy(document)
    for *path, last in reversed(parts):
        table: Any = shorter
        for key in path:
            table = table.get(key, {}) if isinstance(table, dict) else table[key]
        if isinstance(table, dict):
            table.pop(last, None)
        elif isinstance(table[last], dict):
            del table[last]
        else:
            table[last] = 0.0
    return _tidy(shorter)


def _tidy(document: Document) -> Document:
    """Remove zero initial values, the identity quaternion, zero gravity and empty tables from a document, and return it."""
    initial, scene = document.get("initial", {}), document.get("scene", {})
    zero = [key for key, value in initial.items() if not any(value) and (key != "position" or "plane" not in scene)]
    for key in zero:
        del initial[key]
    if abs(initial.get("quaternion", [0])[0]) == 1.0:
        del initial["quaternion"]
    if scene.get("gravity") == 0:
        del scene["gravity"]
    for table in ("initial", "scene"):
        if not document.get(table, True):
            del document[table]
    return document


def _rounded(value: float, digits: int) -> float:
    """Return a number rounded to this many significant digits."""
    return float(f"{value:.{digits - 1}e}")


def _digits(value: float) -> int:
    """Return the number of significant digits of a number as it is written."""
    return len(Decimal(repr(value)).normalize().as_tuple().digits)
