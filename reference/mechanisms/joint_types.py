"""The types of joints: each has an entry in `JOINT_TYPES`, which determines its kinematics, coordinates, requirements and keys.

A joint lets the frame of its child move relative to its own frame by a chain of elementary motions: slides, followed by turns
or a ball. The motions determine how many coordinates and velocities the joint has, what each of them is, and how the child
moves. The witnesses (`lagrangian.border`, `loops.body_space`) do not read this table: each has its own derivation of every
type, so that an error here appears as a disagreement of two ways.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from bodycheck.reference.robots.model import RobotJointType

#: The names of the types, for type checkers; each has an entry in `JOINT_TYPES`.
JointType = Literal["revolute", "prismatic", "spherical", "free", "fixed", "planar", "universal"]

#: The elementary motions, and their axes: an axis of the joint's frame, or the axis that the key `axis` gives.
MotionKind = Literal["slide", "turn", "ball"]
Axis = Literal["x", "y", "z", "given"]

#: The meanings of the coordinates and of the velocities of an elementary motion, a letter each: length (l), angle (a), or
#: component of the quaternion of an attitude (q).
LETTERS: dict[MotionKind, tuple[str, str]] = {"slide": ("l", "l"), "turn": ("a", "a"), "ball": ("qqqq", "aaa")}


@dataclass(frozen=True)
class ElementaryMotion:
    """A slide along an axis, a turn about an axis, or a ball, which turns about any axis.

    The coordinate of a slide or a turn is its length (m) or angle (rad). The coordinates of a ball are the quaternion w, x, y,
    z from the frame after it to the frame before it, and its velocities are the angular velocity in the frame after it (rad/s).
    """

    kind: MotionKind
    axis: Axis = "given"


@dataclass(frozen=True)
class StartKey:
    """A key of the table `initial` of a joint: its name, how many numbers it has (0 for a single number), and its meaning."""

    name: str
    size: int
    description: str

    @property
    def default(self) -> float | tuple[float, ...]:
        """The value where the file leaves the key out: zeros, or the quaternion of no rotation."""
        if not self.size:
            return 0.0
        return (1.0 if self.name == "quaternion" else 0.0, *(0.0,) * (self.size - 1))


@dataclass(frozen=True)
class StartKeys:
    """The table `initial` of a type of joint.

    Attributes
    ----------
    table
        The name of the table in the JSON Schema of case files.
    joint
        The type of joint that has the table, in words.
    keys
        The keys in the order of the schema.
    position, velocity
        The names of the keys with the coordinates and with the velocities, in the order of the coordinates.
    """

    table: str
    joint: str
    keys: tuple[StartKey, ...]
    position: tuple[str, ...] = ("position",)
    velocity: tuple[str, ...] = ("velocity",)


@dataclass(frozen=True)
class JointForm:
    """A type of joint.

    Attributes
    ----------
    name, meaning
        The name, and a sentence that says what it is.
    motions
        The elementary motions from the joint's frame to the child's frame. Slides come first. After the slides, `kinematics`
        supports one turn, turns about x and y, or a ball.
    effect
        The name of the effect that an engine must model for this joint.
    heads
        The units of the coordinates and of the velocities for the heads of columns.
    start
        The table `initial` in a case file; None if the joint has no coordinates.
    damped
        Whether a case file may give it the key `damping`; joints with the key `axis` have this key and others in any case.
    robot, mjcf
        The corresponding type of joint in a robot model, as in URDF, and in MJCF; None if there is no such type. The joint is
        then written as its elementary motions.
    """

    name: JointType
    meaning: str
    motions: tuple[ElementaryMotion, ...]
    effect: str
    heads: tuple[str, str] = ("", "")
    start: StartKeys | None = None
    damped: bool = False
    robot: RobotJointType | None = None
    mjcf: str | None = None

    @cached_property
    def coordinates(self) -> str:
        """The meanings of the coordinates, as a string with a letter of `LETTERS` for each."""
        return "".join(LETTERS[motion.kind][0] for motion in self.motions)

    @cached_property
    def velocities(self) -> str:
        """The meanings of the velocities, as a string with a letter of `LETTERS` for each."""
        return "".join(LETTERS[motion.kind][1] for motion in self.motions)

    @property
    def slides(self) -> tuple[ElementaryMotion, ...]:
        """The slides of the joint."""
        return tuple(motion for motion in self.motions if motion.kind == "slide")

    @property
    def turns(self) -> tuple[ElementaryMotion, ...]:
        """The turns of the joint, or its ball."""
        return tuple(motion for motion in self.motions if motion.kind != "slide")

    @property
    def has_axis(self) -> bool:
        """True if a case file gives the axis of the joint."""
        return any(motion.axis == "given" for motion in self.motions if motion.kind != "ball")

    @property
    def has_quaternion(self) -> bool:
        """True if the last four coordinates are a quaternion."""
        return "q" in self.coordinates

    @property
    def transmits(self) -> bool:
        """True if a force can act between the bodies of the joint, because it has fewer than six velocities."""
        return len(self.velocities) < 6

    def columns(self, letter: str) -> slice:
        """The slice of the coordinates with a given letter, which are adjacent; an empty slice if no coordinate has it."""
        first = self.coordinates.find(letter)
        return slice(first, first + self.coordinates.count(letter)) if first >= 0 else slice(0, 0)


_ANGLES_OR_LENGTHS = StartKeys(
    "CoordinateStart",
    "revolute or prismatic",
    (StartKey("position", 0, "rad or m"), StartKey("velocity", 0, "rad/s or m/s")),
)
_UNIVERSAL_START = StartKeys(
    "UniversalStart",
    "universal",
    (
        StartKey("position", 2, "about x of the joint's frame, then about the turned y, rad"),
        StartKey("velocity", 2, "their rates, rad/s"),
    ),
)
_PLANAR_START = StartKeys(
    "PlanarStart",
    "planar",
    (
        StartKey("position", 3, "x and y, m, and the angle about z of the joint's frame, rad"),
        StartKey("velocity", 3, "their rates, m/s, m/s and rad/s"),
    ),
)
_SPHERICAL_START = StartKeys(
    "SphericalStart",
    "spherical",
    (
        StartKey("quaternion", 4, "w, x, y, z, child to joint's frame"),
        StartKey("velocity", 3, "angular velocity in the frame of the child, rad/s"),
    ),
    position=("quaternion",),
)
_FREE_START = StartKeys(
    "FreeStart",
    "free",
    (
        *_SPHERICAL_START.keys,
        StartKey("position", 3, "of the child's origin in the joint's frame, m"),
        StartKey("linear", 3, "velocity of the child's origin along the axes of the joint's frame, m/s"),
    ),
    position=("position", "quaternion"),
    velocity=("linear", "velocity"),
)

_X, _Y, _Z = (ElementaryMotion("slide", axis) for axis in ("x", "y", "z"))
_BALL = ElementaryMotion("ball")

#: The types of joints by their names, in the order of the grammar.
JOINT_TYPES: dict[JointType, JointForm] = {
    form.name: form
    for form in (
        JointForm(
            name="revolute",
            meaning="A hinge.",
            motions=(ElementaryMotion("turn"),),
            effect="revolute joints",
            heads=("rad", "rad/s"),
            start=_ANGLES_OR_LENGTHS,
            robot="revolute",
            mjcf="hinge",
        ),
        JointForm(
            name="prismatic",
            meaning="A slider.",
            motions=(ElementaryMotion("slide"),),
            effect="prismatic joints",
            heads=("m", "m/s"),
            start=_ANGLES_OR_LENGTHS,
            robot="prismatic",
            mjcf="slide",
        ),
        JointForm(
            name="spherical",
            meaning="A ball joint.",
            motions=(_BALL,),
            effect="ball joints",
            heads=("w x y z", "rad/s"),
            start=_SPHERICAL_START,
            damped=True,
            robot="spherical",
            mjcf="ball",
        ),
        JointForm(
            name="free",
            meaning="A joint that holds nothing.",
            motions=(_X, _Y, _Z, _BALL),
            effect="free joints",
            heads=("m, w x y z", "m/s, rad/s"),
            start=_FREE_START,
            robot="floating",
            mjcf="free",
        ),
        JointForm(
            name="fixed",
            meaning="A joint that lets nothing move.",
            motions=(),
            effect="fixed joints",
            robot="fixed",
        ),
        JointForm(
            name="planar",
            meaning="A child that moves in the plane x, y of the joint's frame and turns about its z.",
            motions=(_X, _Y, ElementaryMotion("turn", "z")),
            effect="planar joints",
            heads=("m m rad", "m/s m/s rad/s"),
            start=_PLANAR_START,
            robot="planar",
        ),
        JointForm(
            name="universal",
            meaning="Two hinges at right angles.",
            motions=(ElementaryMotion("turn", "x"), ElementaryMotion("turn", "y")),
            effect="universal joints",
            heads=("rad", "rad/s"),
            start=_UNIVERSAL_START,
        ),
    )
}
