"""Notes of a case on its robot's file beside the mechanics: parts that were left out, and parts that would act later.

Worker processes get these notes with the case; nothing here reads a file.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

#: What a case may leave out of a robot's file on purpose.
Ignored = Literal[
    "actuators", "tendons", "equalities", "mimic", "limits", "contacts", "friction", "damping", "gravity_compensation", "medium"
]

#: What a case may take over from a robot's file beside its bodies and joints.
Used = Literal["limits", "actuators"]


@dataclass(frozen=True)
class JointRange:
    """The limits of a joint that its file states, and that the mechanics of the case does not have.

    joint: its name. lower, upper: limits of its coordinate (rad or m); None where the file states none.
    """

    joint: str
    lower: float | None
    upper: float | None

    @property
    def name(self) -> str:
        """The name of the joint."""
        return self.joint

    @property
    def terms(self) -> tuple[tuple[str, float], ...]:
        """The joint with the coefficient 1."""
        return ((self.joint, 1.0),)


@dataclass(frozen=True)
class TendonRange:
    """The limits of a fixed tendon that its file states, and that the mechanics of the case does not have.

    name: its name after the word "tendon". terms: the joints whose coordinates its length sums up, by their names, each with
    its coefficient. lower, upper: limits of the length; None where the file states none.
    """

    name: str
    terms: tuple[tuple[str, float], ...]
    lower: float | None
    upper: float | None


@dataclass(frozen=True)
class RobotNotes:
    """Notes on the robot model of a case.

    Attributes
    ----------
    file
        The name of the file.
    without
        The words of `[model] ignore` that leave out something that the file has, such as "tendons".
    notices
        Sentences on parts of the file that do not act in a free motion, each kind of part once, with its number and lines.
    ranges
        The limits of joints and of fixed tendons, which would act from the instant on at which one is passed; empty if the case
        ignores limits.
    touching
        Whether bodies of the robot may touch each other or the world: the file has shapes for collisions, and the case does not
        ignore contacts.
    path, packages
        The path of the file, and folders of packages that the user named; None and empty if the case is read from results.
    """

    file: str
    without: tuple[str, ...] = ()
    notices: tuple[str, ...] = ()
    ranges: tuple[JointRange | TendonRange, ...] = ()
    touching: bool = False
    path: Path | None = field(default=None, compare=False)
    packages: tuple[Path, ...] = field(default=(), compare=False)
