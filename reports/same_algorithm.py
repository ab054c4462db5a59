"""Findings and names in a report for methods that are the same algorithm."""

from collections.abc import Mapping, Sequence

from bodycheck.adapters.contract import Kind
from bodycheck.judging.schemes.classes import MethodClass
from bodycheck.reports.finding import Finding
from bodycheck.reports.quantities import bound, listing, verb
from bodycheck.results.key import RunKey

#: Classes of methods that are the same algorithm, by kind of scene.
Classes = Mapping[Kind, Sequence[MethodClass]]
NO_CLASSES: Classes = {}

#: The kinds of scenes in sentences.
WORDS: Mapping[Kind, str] = {
    "flight": "in flight",
    "drag": "against drag",
    "plane": "on a plane",
    "contact": "where bodies touch",
    "mechanism": "on joints",
}

#: The most classes of a kind, and the most methods of a class, that a sentence names.
MOST_CLASSES, MOST_METHODS = 4, 6


def same_algorithm(classes: Classes) -> Finding | None:
    """Return a finding about methods that are the same algorithm, by kind of scene; None if no two methods are.

    Kinds of scenes with the same classes share a sentence.
    """
    by_members: dict[tuple[tuple[RunKey, ...], ...], list[Kind]] = {}
    largest: dict[tuple[RunKey, ...], float] = {}
    for kind, own in classes.items():
        several = sorted((one for one in own if len(one.methods) > 1), key=lambda one: -len(one.methods))
        for one in several:
            largest[one.methods] = max(one.distance, largest.get(one.methods, 0.0))
        if several:
            by_members.setdefault(tuple(one.methods for one in several), []).append(kind)
    if not by_members:
        return None
    told = [f"{listing([WORDS[kind] for kind in kinds])}, {_told(members, largest)}" for members, kinds in by_members.items()]
    return Finding("Same algorithm", " ".join(f"{text[0].upper()}{text[1:]}." for text in told))


def memberships(classes: Classes) -> dict[RunKey, set[tuple[Kind, int]]]:
    """Return the classes of each method, each as a kind of scene and an index.

    The keys are the methods over all cases and time steps. Two methods are the same algorithm in scenes of some kind if they
    have a class in common.
    """
    found: dict[RunKey, set[tuple[Kind, int]]] = {}
    for kind, members in classes.items():
        for place, own in enumerate(members):
            for method in own.methods:
                found.setdefault(method, set()).add((kind, place))
    return found


def firsts(classes: Sequence[MethodClass]) -> dict[RunKey, str]:
    """Return the name of the first method of its class for each later method of the class.

    The keys are the methods over all cases and time steps.
    """
    return {key: _name(own.methods[0]) for own in classes for key in own.methods[1:]}


def _told(members: Sequence[tuple[RunKey, ...]], largest: Mapping[tuple[RunKey, ...], float]) -> str:
    (first, apart), *others = [(_names(own), bound(largest[own], 1)) for own in members[:MOST_CLASSES]]
    left = len(members) - len(others) - 1
    return "; ".join(
        [
            f"{first} are one algorithm: their motions agree to rounding ({apart})",
            *(f"so are {names} ({apart})" for names, apart in others),
            *([f"and so are those of {left} more {verb(left, 'class', 'classes')}"] if left else []),
        ]
    )


def _names(methods: Sequence[RunKey]) -> str:
    return listing(list(map(_name, methods)), MOST_METHODS, "method")


def _name(key: RunKey) -> str:
    return f"{key.engine} {key.method.name}"
