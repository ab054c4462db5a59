"""A robot model as an engine has it after its own reader has read the file.

Numbers are those of the engine, converted to the conventions of `bodycheck.reference.robots` and to the frames of the links,
but to nothing that the engine does not have: what it does not know is None.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, runtime_checkable

from bodycheck.reference.robots.model import Mimic
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector

#: Components xx, yy, zz, xy, xz, yz of an inertia tensor.
Components = tuple[float, float, float, float, float, float]


class ModelRefused(Exception):
    """The engine refuses a robot model; the text is that of the engine."""


class FormatUnknown(Exception):
    """The engine has no reader of a format; the text says so."""


@dataclass(frozen=True)
class RobotFile:
    """A robot model as its engine gets it: a file whose references to other files have been checked.

    Attributes
    ----------
    path
        The path of the file.
    format
        Its format.
    packages
        The folders in which an engine finds packages, by the names of the packages.
    """

    path: str
    format: Literal["urdf", "mjcf"]
    packages: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class ReadBody:
    """A body of the engine, which may be several links of the file that the engine has joined.

    Attributes
    ----------
    name
        The name of the link whose frame is that of the body.
    parent
        The name of the body that it hangs on; None for the root.
    mass, center_of_mass, inertia
        Mass (kg), centre of mass (m) and inertia about it (kg m^2), in the link's frame.
    """

    name: str
    parent: str | None
    mass: float | None = None
    center_of_mass: Vector | None = None
    inertia: Components | None = None


@dataclass(frozen=True)
class ReadJoint:
    """A joint of the engine, with the words of `RobotJoint`.

    Attributes
    ----------
    name, type
        The name and the type, in the words of `bodycheck.reference.robots.model.RobotJointType`, or else the engine's own word.
    child
        The name of the body that it moves.
    first, count
        The place of its first velocity among those of the engine, and how many it has; 0 for a joint that is fixed.
    axis
        The unit axis in the child's frame; None where there is none or the engine does not tell.
    """

    name: str
    type: str
    child: str
    first: int
    count: int
    axis: Vector | None = None
    armature: float | None = None
    damping: float | None = None
    friction: float | None = None
    stiffness: float | None = None
    effort_limit: float | None = None
    lower: float | None = None
    upper: float | None = None
    mimic: Mimic | None = None


@dataclass(frozen=True, eq=False)
class RobotReading:
    """A robot model as an engine has it, and what the engine computes with it.

    Attributes
    ----------
    bodies, joints
        The bodies that the engine keeps, its root included if it has one, and the joints that move, in its order.
    links
        The names of all links of the file that the engine knows, also of those that it has joined to others.
    velocities
        The number of velocities of the engine.
    gravity
        The gravitational acceleration that the engine uses if the user sets none (m/s^2, world).
    terms
        What the engine computes at each of the states that were asked for, with the gravity of the call.
    rounding
        The relative error that the engine's reader leaves in what it keeps, where it is larger than rounding in the engine's
        precision.
    notes
        What a user should know of this reading, such as a flag without which the engine ignores the inertia of the file.
    """

    bodies: tuple[ReadBody, ...]
    joints: tuple[ReadJoint, ...]
    links: tuple[str, ...]
    velocities: int
    gravity: Vector | None
    terms: tuple[Terms, ...]
    rounding: float = 0.0
    notes: tuple[str, ...] = ()


@runtime_checkable
class RobotModels(Protocol):
    """An adapter whose engine reads robot models from files."""

    def read_robot(self, file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
        """Return what the engine's own reader makes of a file, and what the engine computes with it at some states.

        The root of the robot is welded to the world where the engine leaves the choice to the user. Everything else is as the
        engine's reader has it without options, unless without an option the reader ignores what the file says of inertia.

        Parameters
        ----------
        file
            The file.
        states
            The states. Joints that the engine does not have are left out, and joints of the engine that a state does not have
            stay where they are without velocity.
        gravity
            The gravitational acceleration at these states, world frame (m/s^2).

        Raises
        ------
        ModelRefused
            If the engine refuses the file.
        FormatUnknown
            If the engine has no reader of the format.
        """
        ...
