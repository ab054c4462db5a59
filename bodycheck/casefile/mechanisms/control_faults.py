"""Check rules that connect several keys of controllers and stops, which the grammar of single keys cannot express."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.mechanisms.control_grammar import SIGNALS
from bodycheck.casefile.mechanisms.grammar import MAX_BODIES
from bodycheck.casefile.raw_values import mapping, number, tables_of
from bodycheck.casefile.toml_positions import Path
from bodycheck.suggestion import did_you_mean, first_names

#: The largest number of instants of all controllers with a rate together, in one run.
MAX_CONTROLS = 10**6

#: The types of joints that a controller drives.
DRIVEN = ("revolute", "prismatic")

#: The keys of a controller that belong to the law "pd".
OF_PD = ("kp", "kd", "ki", "target", "target_velocity")


def control_faults(document: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of controllers and stops of a raw document, which may also have other faults."""
    joints, controllers = tables_of(document, "joints", MAX_BODIES), tables_of(document, "controllers", 2 * MAX_BODIES)
    for index, joint in enumerate(joints):
        for path, message in _of_limits(joint):
            yield ("joints", index, "limits", *path), message
    by_name = {joint["name"]: joint for joint in joints if isinstance(joint.get("name"), str)}
    first: dict[str, int] = {}
    for index, controller in enumerate(controllers):
        name = controller.get("joint")
        if isinstance(name, str):
            # The joints of a model that could not be read are unknown.
            if ("joints" in document or "model" not in document) and (fault := _of_joint(name, by_name)) is not None:
                yield ("controllers", index, "joint"), fault
            if (before := first.setdefault(name, index)) != index:
                yield ("controllers", index, "joint"), f"has controller {before + 1} already; a joint has one controller"
        for path, message in _of_controller(controller):
            yield ("controllers", index, *path), message
    yield from _of_instants(document, controllers)


def _of_joint(name: str, joints: Mapping[str, Mapping[str, Any]]) -> str | None:
    """Return why a controller cannot drive the joint of a name; None if it can, or the grammar reports the fault."""
    fit = [other for other, joint in joints.items() if joint.get("type") in DRIVEN and "mimic" not in joint]
    listed = ", ".join(first_names(fit)) or "none, as no joint is revolute or prismatic and moves by itself"
    if name not in joints:
        return f"there is no such joint; allowed: {listed}{did_you_mean(name, fit)}"
    kind = joints[name].get("type")
    if isinstance(kind, str) and kind not in DRIVEN:
        return f"is of the type {kind}; a controller drives a revolute or prismatic joint; allowed: {listed}"
    if "mimic" in joints[name]:
        return f"the joint follows another one, which a controller can drive in its place; allowed: {listed}"
    return None


def _of_controller(controller: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults between keys of a controller, as pairs of path in its table and message."""
    if controller.get("law") == "effort":
        for key in OF_PD:
            if key in controller:
                yield (key,), 'belongs to the law "pd"; the law "effort" has only effort'
    if number(controller.get("delay")) > 0 and "rate" not in controller:
        yield ("delay",), "counts periods of a controller with a rate; give rate too, or leave delay out"
    if "no_load_speed" in controller and "effort_limit" not in controller:
        yield ("no_load_speed",), "needs effort_limit, which is the effort at rest"
    for key in SIGNALS:
        for path, message in _of_samples(mapping(controller.get(key))):
            yield (key, *path), message


def _of_samples(signal: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults of a raw table of a signal at some times, as pairs of path in the table and message."""
    times, values = signal.get("times"), signal.get("values")
    if not isinstance(times, list):
        return
    for index, (before, after) in enumerate(pairwise(times), start=1):
        if _is_number(before) and _is_number(after) and not before < after:
            yield ("times", index), f"is not later than the time before it, {before!r}; times ascend"
            break
    if isinstance(values, list) and len(values) != len(times):
        yield ("values",), f"has {len(values)} values for {len(times)} times; allowed: a value for each time"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _of_instants(document: Mapping[str, Any], controllers: Sequence[Mapping[str, Any]]) -> Iterator[tuple[Path, str]]:
    """Yield a fault if a run, or a run of the extremes of the case, has too many instants of controllers."""
    rates = [number(controller.get("rate")) for controller in controllers]
    total = sum(rate for rate in rates if rate > 0)
    duration = number(mapping(document.get("run")).get("duration"))
    if total * duration > MAX_CONTROLS:
        index = rates.index(max(rates))
        yield ("controllers", index, "rate"), _too_many(total * duration, f"in {duration:g} s")
    steps = mapping(document.get("extremes")).get("steps")
    for index, value in enumerate(steps if isinstance(steps, list) else []):
        if total * number(value) * DEFAULT_TIMESTEP > MAX_CONTROLS:
            instants = total * number(value) * DEFAULT_TIMESTEP
            yield ("extremes", "steps", index), _too_many(instants, f"in {number(value):g} steps")


def _too_many(instants: float, span: str) -> str:
    return f"all controllers together have {instants:.3g} instants {span}; allowed: at most {MAX_CONTROLS:.0e}"


def _of_limits(joint: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    """Yield the faults of the stops of a raw table of a joint, as pairs of path in the table `limits` and message."""
    if not isinstance(limits := joint.get("limits"), dict):
        return
    if "mimic" in joint:
        yield (), "the joint follows another one, whose own limits can hold both; leave them out here"
    if "stiffness" in limits and "restitution" in limits:
        yield ("restitution",), "stiffness is given too; rigid stops have a restitution, elastic ones a stiffness and a damping"
    if "damping" in limits and "stiffness" not in limits:
        yield ("damping",), "belongs to elastic stops; give stiffness too"
    if "lower" not in limits and "upper" not in limits:
        yield (), "has neither lower nor upper; give at least one of them"
    if "mimic" not in joint and (fault := unusable(joint)) is not None:
        path, message = fault
        yield path, message


def unusable(joint: Mapping[str, Any]) -> tuple[Path, str] | None:
    """Return why a joint cannot have its stops: they are not apart, or it starts outside of them; None if it can have them.

    joint: the raw table of a joint with one coordinate. The result is a path in its table `limits`, and a message.
    """
    limits = mapping(joint.get("limits"))
    lower, upper = (limits.get(key) if _is_number(limits.get(key)) else None for key in ("lower", "upper"))
    if lower is not None and upper is not None and not lower < upper:
        return ("lower",), f"is not below upper, {upper!r}"
    start = mapping(joint.get("initial")).get("position", 0.0)
    if not _is_number(start):
        return None
    if lower is not None and start < lower:
        return ("lower",), f"the joint starts outside, at {start!r}; allowed: a start of at least {lower!r}"
    if upper is not None and start > upper:
        return ("upper",), f"the joint starts outside, at {start!r}; allowed: a start of at most {upper!r}"
    return None
