"""The bodies and joints of an MJCF file, as far as they have been read for a case."""

from dataclasses import dataclass, field

from bodycheck.casefile.robots.mjcf.features import Features
from bodycheck.casefile.robots.mjcf.geoms import Shapes
from bodycheck.casefile.robots.mjcf.joints import JointOfFile
from bodycheck.casefile.robots.mjcf.parts import Classes
from bodycheck.casefile.robots.mjcf.settings import Settings
from bodycheck.casefile.robots.tables import Pose
from bodycheck.reference.exact.inertia import MassProperties
from bodycheck.robots.elements import Element


@dataclass(frozen=True, eq=False)
class Carrier:
    """The body of the case that carries the elements of a body of the file, and the pose of their frame in it.

    Attributes
    ----------
    name
        The name of the body of the case, or of the world.
    pose
        The pose of the frame of the body of the file in the frame of the body of the case.
    world
        The pose of the frame of the body of the file in the world, in the pose of the file.
    moves
        Whether the body of the case moves.
    """

    name: str
    pose: Pose
    world: Pose
    moves: bool = False


@dataclass(eq=False)
class Tree:
    """The bodies and joints that have been read.

    Attributes
    ----------
    rules, classes
        The settings and the default classes of the file.
    shapes
        The meshes and height fields of the file.
    features
        What is no mechanics of a case.
    inertias
        The mass properties of the bodies of the case by their names, in their frames, in the order of the file.
    joints
        The joints of the case, in the order of the file; the `element` of one that fixes a body is this body.
    carriers
        The bodies of the file by their names.
    sites
        The sites by their names: the name of their body, and their pose in its frame.
    masks
        The bits of `contype` and of `conaffinity` of all geoms of each body of the case, and whether it moves.
    tendons
        The tendons by their names.
    taken
        The names of the joints of the case, and of the bodies of the file and of the case.
    """

    rules: Settings
    classes: Classes
    shapes: Shapes
    features: Features
    inertias: dict[str, MassProperties] = field(default_factory=dict)
    joints: list[JointOfFile] = field(default_factory=list)
    carriers: dict[str, Carrier] = field(default_factory=dict)
    sites: dict[str, tuple[str, Pose]] = field(default_factory=dict)
    masks: dict[str, tuple[int, int, bool]] = field(default_factory=dict)
    tendons: dict[str, Element] = field(default_factory=dict)
    taken: tuple[set[str], set[str]] = field(default_factory=lambda: (set(), set()))
