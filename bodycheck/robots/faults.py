"""Violations of a file format's specification."""

from dataclasses import dataclass, field, replace
from typing import Literal

from bodycheck.reference.robots.model import RobotModel
from bodycheck.robots.elements import Element, place, quoted

#: The quantity that a fault is about: "effort_limit" for all of <limit>, "joint_type" also for <mimic>, "parent" also for
#: names; empty for faults of the file as a whole.
FaultyQuantity = Literal[
    "mass", "center_of_mass", "inertia", "pose", "axis", "parent", "joint_type", "damping", "friction", "effort_limit", ""
]

#: The largest number of faults reported for one file. A file of a stranger may have a fault in every element.
MAX_FAULTS = 200


@dataclass(frozen=True)
class FileFault:
    """A violation of the specification in a file.

    Attributes
    ----------
    subject
        The name of the link or joint that has the fault, or "model".
    quantity
        The quantity that the fault is about.
    text
        The fault in one line of printable characters, which names the file and the line.
    """

    subject: str
    quantity: FaultyQuantity
    text: str


@dataclass(frozen=True, eq=False)
class FileReading:
    """A robot model as read by the specification of its file's format.

    Attributes
    ----------
    model
        The model; None if no tree of links and joints can be made of the file.
    faults
        The violations of the specification, in the order in which they were found.
    """

    model: RobotModel | None
    faults: tuple[FileFault, ...]


@dataclass(frozen=True)
class About:
    """The link or joint that is being read, or the model.

    Attributes
    ----------
    subject
        Its name, or "model".
    quaternions
        Whether `quat_xyzw` has a meaning in the file, as from URDF 1.1 on.
    faults
        The faults of the file so far.
    """

    subject: str
    quaternions: bool = False
    faults: list[FileFault] = field(default_factory=list)

    def of(self, subject: str) -> "About":
        """Return a copy for another subject, with the same file and list of faults."""
        return replace(self, subject=subject)

    def add(self, quantity: FaultyQuantity, element: Element, attribute: str | None, text: str) -> None:
        """Add a fault of an element or of its attribute."""
        if len(self.faults) < MAX_FAULTS:
            self.faults.append(FileFault(self.subject, quantity, f"{place(element, attribute)}: {text}"))
        elif len(self.faults) == MAX_FAULTS:
            self.faults.append(FileFault("model", "", f"{element.file}: has more faults, which are not listed"))

    def only(self, quantity: FaultyQuantity, holder: Element, tag: str) -> Element | None:
        """Return the first child with a tag; None if there is none. Several are a fault."""
        children = list(holder.all(tag))
        if len(children) > 1:
            self.add(quantity, children[1], None, f"a second <{tag}> of one <{quoted(holder.tag)[1:-1]}>; allowed: one")
        return children[0] if children else None
