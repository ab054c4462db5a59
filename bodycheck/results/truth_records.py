"""The record of a truth in the journal, apart from its trajectory: the methods that computed it, and its events."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from bodycheck.figures.definition import InterfaceLoad
from bodycheck.reference.contact.motion import Event, Interface
from bodycheck.reference.planar import Stop
from bodycheck.reference.truths import Truth

#: The vectors of an event of bodies in contact.
EVENT_VECTORS = ("position", "velocity", "spin")


def told(truth: Truth) -> dict[str, Any]:
    """Return the entries of a truth for a record; values that the truth does not have are left out."""
    record: dict[str, Any] = {"model": truth.model, "why": truth.reason}
    record |= {"backend": truth.backend, "witnesses": truth.witnesses}
    if truth.stop is not None:
        record["stop"] = asdict(truth.stop)
    if truth.events:
        record["events"] = [_event_told(event) for event in truth.events]
    if truth.friction:
        record["friction"] = truth.friction
    if truth.interfaces:
        record["interfaces"] = [asdict(interface) for interface in truth.interfaces]
    return record


def ways(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes of `Truth` in a record, which say how the truth was found, by name."""
    return {
        "model": record["model"],
        "reason": record["why"],
        "backend": record["backend"],
        "witnesses": tuple(record["witnesses"]),
        "stop": stop(record.get("stop")),
        "events": tuple(_event(one) for one in record.get("events", ())),
        "friction": record.get("friction", 0.0),
        "interfaces": tuple(Interface(tuple(one["bodies"]), one["load"]) for one in record.get("interfaces", ())),
    }


def stop(record: Mapping[str, Any] | None) -> Stop | None:
    """Return the stop in a record of a truth or of a stop; None for None."""
    return None if record is None else Stop(record["time"], tuple(record["position"]), record["yaw"])


def loads(record: Mapping[str, Any]) -> tuple[InterfaceLoad, ...] | None:
    """Return the loads between bodies at rest in the record of a run; earlier versions recorded none."""
    stored = record.get("interfaces")
    return None if stored is None else tuple(InterfaceLoad(tuple(one["bodies"]), one["load"], one["losses"]) for one in stored)


def _event(record: Mapping[str, Any]) -> Event:
    vectors = {name: tuple(math.nan if one is None else one for one in record[name]) for name in EVENT_VECTORS}
    return Event(**({**record} | vectors))


def _event_told(event: Event) -> dict[str, Any]:
    """Return an event for a record. Values that mechanics does not determine are null."""
    record = asdict(event)
    return record | {name: [None if math.isnan(one) else one for one in record[name]] for name in EVENT_VECTORS}
