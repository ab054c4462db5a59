"""The result of reading a robot's file for a case: bodies and joints as tables, and all other parts of the file.

`urdf.tree` and `mjcf.tree` read files; `mechanisms.model` makes the document of a case from the result.
"""

from dataclasses import dataclass
from typing import Any, Literal, Protocol

from bodycheck.casefile.robot_notes import Ignored as Ignored
from bodycheck.casefile.robot_notes import JointRange, TendonRange
from bodycheck.casefile.robot_notes import Used as Used
from bodycheck.casefile.robots.tables import Tables
from bodycheck.reference.scene import Vector


class Files(Protocol):
    """The files that a robot's file may name: those in its folder or below, and in folders that the user named.

    Every file that is read is recorded with its digest. Both methods raise `named_files.NotFound` for a file that is missing or
    elsewhere, and `BadInput` for one that is too large.
    """

    def text(self, name: str, near: str) -> tuple[str, str]:
        """Return the path, from the folder of the robot, and the text of a named file. near: the path of the naming file."""
        ...

    def content(self, name: str) -> bytes:
        """Return the content of a named mesh. Its path is relative to the folder of the robot."""
        ...


#: The number of a keyframe that stands for the first one, or for the zeros of the joints if the file has none.
FIRST_IF_ANY = -1


@dataclass(frozen=True)
class Choice:
    """The way in which a robot's file is read: the keys of `[model]`.

    Attributes
    ----------
    files
        The files that it may name.
    ignore
        What is left out on purpose.
    base
        "free" if the root link floats, "fixed" if it is as the file says.
    keyframe
        The name or the number of the keyframe at which the joints start, or `FIRST_IF_ANY`; None for their zeros.
    upright
        Whether the axes of the world are turned so that the gravity of the file is along -z.
    use
        What the case takes over beside bodies and joints. A word that `ignore` has too leaves out what cannot be taken over.
    driven
        The names of the joints that have a controller of the case itself, in place of actuators of the file.
    """

    files: Files
    ignore: frozenset[Ignored] = frozenset()
    base: Literal["fixed", "free"] = "fixed"
    keyframe: str | int | None = None
    upright: bool = False
    use: frozenset[Used] = frozenset()
    driven: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Feature:
    """One kind of part of a robot's file that is no part of the mechanics of a case, or not yet.

    Attributes
    ----------
    word
        The word of `ignore` that leaves it out; None if no word does.
    acts
        Whether it acts from the beginning, so that a case is refused unless it ignores the word.
    text
        A clause about it that follows its number, such as "motors are without control and exert nothing".
    noun
        What one is, and what several are, such as ("motor", "motors"). A property of parts has {} in the place of their number,
        such as ("damping of {} joint", "damping of {} joints").
    lines
        Where the parts are, as pairs of file and line.
    """

    word: Ignored | None
    acts: bool
    text: str
    noun: tuple[str, str]
    lines: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Read:
    """The result of reading a robot's file.

    Attributes
    ----------
    tables
        The tables `bodies`, `joints` and `loops` of a case, with the initial states of the file or of its keyframe.
    base
        The name of the joint table of the free base, whose initial state `[initial.base]` replaces; None if no base floats.
    features
        The parts that are no mechanics, in the order of the file, those that are ignored on purpose included.
    ranges
        The limits of joints and of fixed tendons.
    touching
        Whether the file has shapes that may touch each other.
    welded
        Whether a root link with mass is fixed to the world, as the file names no joint between them.
    keyframes
        The names of the keyframes of the file, in its order; empty texts for keyframes without a name.
    gravity
        The gravitational acceleration of the file, in the world of the case (m/s^2); None if it states none.
    timestep
        The time step (s) that the file states; None if it states none.
    controllers
        The tables of the controllers that actuators of the file become, if the case uses them.
    """

    tables: Tables
    base: str | None = None
    features: tuple[Feature, ...] = ()
    ranges: tuple[JointRange | TendonRange, ...] = ()
    touching: bool = False
    welded: bool = False
    keyframes: tuple[str, ...] = ()
    gravity: Vector | None = None
    timestep: float | None = None
    controllers: tuple[dict[str, Any], ...] = ()
