"""Take over the ranges of joints of a robot's file as rigid stops of restitution 0, where a case uses them.

The range of a joint that follows another one limits the other joint too: its stops are those of the joint that both follow, in
the coordinate of that joint.
"""

from dataclasses import replace
from fractions import Fraction
from math import isfinite
from typing import Any

from bodycheck.casefile.robot_notes import JointRange
from bodycheck.casefile.robots.reading import Feature, Read
from bodycheck.casefile.values import MAX_NUMBER

#: The types of joints that can have stops.
SINGLE = ("revolute", "prismatic")

#: The ends of a range, exact; None where it has none.
Ends = tuple[Fraction | None, Fraction | None]


def with_stops(read: Read) -> Read:
    """Return the result of reading a file with stops in its tables of joints instead of ranges.

    Limits of other joints are features that act. Ranges of tendons stay ranges.
    """
    tables = {joint["name"]: joint for joint in read.tables["joints"] if joint["type"] in SINGLE}
    ends: dict[str, Ends] = {}
    for each in read.ranges:
        if isinstance(each, JointRange) and each.joint in tables and (mapped := _of_leader(each, tables)) is not None:
            leader, stops = mapped
            ends[leader] = stops if leader not in ends else _narrower(ends[leader], stops)
    joints = [table | _limits(ends.get(table["name"], (None, None))) for table in read.tables["joints"]]
    features = tuple(_acting(feature) for feature in read.features)
    of_tendons = tuple(each for each in read.ranges if not isinstance(each, JointRange))
    return replace(read, tables={**read.tables, "joints": joints}, ranges=of_tendons, features=features)


def _limits(ends: Ends) -> dict[str, Any]:
    """Return the key `limits` of the table of a joint; none if there are no stops."""
    stated = zip(("lower", "upper"), ends, strict=True)
    limits = {name: float(end) for name, end in stated if end is not None and abs(end) <= MAX_NUMBER}
    return {"limits": limits} if limits else {}


def _of_leader(each: JointRange, joints: dict[str, dict[str, Any]]) -> tuple[str, Ends] | None:
    """Return the joint that another one follows at last, or the joint itself, and the range in its coordinate.

    None if the other joint does not move it, or does not exist, which is a fault that is reported elsewhere.
    """
    lower, upper = (None if end is None else Fraction(end) for end in (each.lower, each.upper))
    name, seen = each.joint, {each.joint}
    while (rule := joints[name].get("mimic")) is not None:
        if not all(isfinite(rule[key]) for key in ("multiplier", "offset")):
            return None
        multiplier, offset, name = Fraction(rule["multiplier"]), Fraction(rule["offset"]), rule["joint"]
        if not multiplier or name in seen or name not in joints:
            return None
        seen.add(name)
        lower, upper = (None if end is None else (end - offset) / multiplier for end in (lower, upper))
        if multiplier < 0:
            lower, upper = upper, lower
    return name, (lower, upper)


def _narrower(one: Ends, other: Ends) -> Ends:
    """Return the range that is in both of two ranges."""
    lower = max((end for end in (one[0], other[0]) if end is not None), default=None)
    upper = min((end for end in (one[1], other[1]) if end is not None), default=None)
    return lower, upper


def _acting(feature: Feature) -> Feature:
    """Return a feature, which acts if it has limits."""
    if feature.word != "limits":
        return feature
    return replace(feature, acts=True, text="act")
