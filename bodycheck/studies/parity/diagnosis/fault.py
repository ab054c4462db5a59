"""Suspected faults in an engine's reading of a file, and the model of the file with such faults."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from bodycheck.reference.robots.model import RobotModel, with_joint, with_link
from bodycheck.studies.parity.quantities import Cause, Quantity
from bodycheck.studies.parity.rows import Compared

Changes = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Fault:
    """A part of a robot model that an engine has read differently from the file.

    Attributes
    ----------
    cause, quantity, subject
        The cause, the quantity, and the name of the body or joint.
    link, joint
        The attributes of the link, or of the joint, named `subject`, as the engine has them; empty if none change.
    row
        A row that names the subject, for a fault that no number reported by the engine shows.
    """

    cause: Cause
    quantity: Quantity
    subject: str
    link: Changes = field(default_factory=dict)
    joint: Changes = field(default_factory=dict)
    row: Compared | None = None


def changed(model: RobotModel, faults: Iterable[Fault]) -> RobotModel:
    """Return a model with faults put into it. Faults of links and joints that the model lacks are left out."""
    links, joints = {link.name for link in model.links}, {joint.name for joint in model.joints}
    for fault in faults:
        if fault.link and fault.subject in links:
            model = with_link(model, fault.subject, **fault.link)
        if fault.joint and fault.subject in joints:
            model = with_joint(model, fault.subject, **fault.joint)
    return model
