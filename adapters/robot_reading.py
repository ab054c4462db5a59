"""A robot model as an engine has it after its own reader has read the file.

Numbers are those of the engine, converted to the conventions of `bodycheck.reference.robots` and to the frames of the links.
Numbers that the engine does not have are not filled in: they are None.
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
    """The engine refuses a robot model; the text is the engine's message."""


class FormatUnknown(Exception):
    """The engine has no reader of a format; the text says so."""


@dataclass(frozen=True)
class RobotFile:
    """A robot model as an engine receives it: a file whose references to other files have been checked.

    Attributes
    ----------
    path
        The path of the file.
    format
        Its format.
    packages
        The folders in which an engine finds packages, keyed by the names of the packages.
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
        The name of the link whose frame is the frame of the body.
    parent
        The name of the body's parent in the tree; None for the root.
    mass, center_of_mass, inertia
        Mass (kg), centre of mass (m) and inertia about the centre of mass (kg m^2), in the link's frame.
    """

    name: str
    parent: str | None
    mass: float | None = None
    center_of_mass: Vector | None = None
    inertia: Components | None = None


@dataclass(frozen=True)
class ReadJoint:
    """A joint of the engine; the attributes that are not listed here have the meanings and units that `RobotJoint` gives them.

    Attributes
    ----------
    name, type
        The name, and the type: a word of `bodycheck.reference.robots.model.RobotJointType`, or else the engine's own word.
    child
        The name of the body that the joint moves.
    first, count
        The index of the joint's first velocity among the velocities of the engine, and the number of its velocities, which is 0
        for a fixed joint.
    axis
        The unit axis in the child's frame; None if the joint has no axis or the engine does not report it.
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


#: The parts of a joint that motions can try.
Part = Literal["limits", "mimic", "damping", "friction"]


@dataclass(frozen=True)
class Behaviour:
    """A joint as it moves in the steps of the engine, whatever the engine's records say of it.

    Attributes
    ----------
    tried
        The parts that were tried; the attributes of other parts say nothing.
    lower, upper, mimic, damping, friction
        The limits at which the joint stops, the rule by which it follows another joint, and its damping and dry friction.
    """

    tried: frozenset[Part] = frozenset()
    lower: float | None = None
    upper: float | None = None
    mimic: Mimic | None = None
    damping: float | None = None
    friction: float | None = None


@dataclass(frozen=True, eq=False)
class RobotReading:
    """A robot model as an engine has it, and the terms that the engine computes with it.

    Attributes
    ----------
    bodies, joints
        The bodies that the engine keeps, including its root if it has one, and the joints that move, in the engine's order.
    links
        The names of all links of the file that the engine knows, including the links that it has joined to others.
    velocities
        The number of velocities of the robot in the engine.
    gravity
        The gravitational acceleration that the engine uses if the user sets none (m/s^2, world).
    terms
        The terms that the engine computes at each of the requested states, with the requested gravity.
    rounding
        The relative error that the engine's reader adds to the numbers of the file, if it is larger than rounding in the
        engine's precision; otherwise 0.
    notes
        Facts that a user should know about this reading, such as a flag without which the engine ignores the inertia of the
        file.
    behaviours
        The behaviour of joints in the steps of the engine, by the names of the joints; `running.robot_readings` adds it.
    """

    bodies: tuple[ReadBody, ...]
    joints: tuple[ReadJoint, ...]
    links: tuple[str, ...]
    velocities: int
    gravity: Vector | None
    terms: tuple[Terms, ...]
    rounding: float = 0.0
    notes: tuple[str, ...] = ()
    behaviours: Mapping[str, Behaviour] = field(default_factory=dict)


@runtime_checkable
class RobotModels(Protocol):
    """An adapter whose engine reads robot models from files."""

    def read_robot(self, file: RobotFile, states: Sequence[RobotState], gravity: Vector) -> RobotReading:
        """Return the robot model that the engine's own reader makes of a file, and the terms that the engine computes with it.

        The root of the robot is welded to the world if the engine leaves this choice to the user. The reader is used without
        options, except for an option without which it would ignore the inertia in the file.

        Parameters
        ----------
        file
            The file.
        states
            The states at which the terms are computed. Joints that the engine does not have are ignored. Joints of the engine
            that a state does not have keep their positions, with zero velocity.
        gravity
            The gravitational acceleration for all terms, world frame (m/s^2).

        Raises
        ------
        ModelRefused
            If the engine refuses the file.
        FormatUnknown
            If the engine has no reader of the format.
        """
        ...


@dataclass(frozen=True)
class JointStates:
    """Positions and velocities of revolute and prismatic joints, by the names of the joints (rad or m, and per second)."""

    positions: Mapping[str, float]
    velocities: Mapping[str, float]


@runtime_checkable
class RobotSteps(Protocol):
    """An adapter that can step a robot model, as the engine's reader has made it from a file, with the engine's own steps."""

    def step_robot(self, file: RobotFile, starts: Sequence[JointStates], timestep: float, steps: int) -> Sequence[JointStates]:
        """Return the state to which the engine steps a robot from each of several states.

        The steps contain everything that the reader made of the joints in the file: limits, rules of following, damping and
        friction. There is neither gravity nor contact, and what an engine adds of its own to slow every motion, such as the
        damping of links and motors that hold joints, is switched off. Joints that a state does not have start at their default
        positions at rest.

        Parameters
        ----------
        file
            The file, which `read_robot` has read.
        starts
            The states.
        timestep
            The time step (s).
        steps
            The number of steps.

        Raises
        ------
        ModelRefused
            If the engine can read the robot, but not step it.
        """
        ...


@dataclass(frozen=True)
class Touch:
    """The first of several states of a robot in which shapes touch.

    Attributes
    ----------
    index
        The index of the state.
    pairs
        The names of the bodies that touch, or of the shapes of the world.
    """

    index: int
    pairs: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Touches:
    """The result of a search for contacts in states of a robot.

    Attributes
    ----------
    first
        The first state in which shapes touch; None if none do.
    unseen
        The bodies with shapes that may touch, but were left out because a mesh is not at hand, each with the reason.
    """

    first: Touch | None
    unseen: Mapping[str, str]
