"""The physical content of a case of several bodies: bodies, the joints between them, loops, and gravity, in SI units.

World frame: z points up and gravity acts along -z. Each body has a frame, which coincides with the frame of its joint when the
joint's coordinates are zero, as in URDF. The bodies and joints form trees that begin at the world. A body that is the child of
no joint is free. The numbers are the numbers of the file and are meant exactly, as in `definition`; `exact` computes with them.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointForm, JointType
from bodycheck.reference.scene import Attitude, Cone, EulerRates, Given, Plane, Push, Scene, Shape, Vector

#: The index that denotes the world instead of a body.
WORLD = -1


@dataclass(frozen=True)
class BodyStart:
    """The initial state of a body that is the child of no joint.

    Attributes
    ----------
    position, velocity
        Position (m) and velocity (m/s) of its centre of mass, world frame.
    attitude
        Its attitude: the rotation from the body's frame to the world.
    rotation
        Its angular velocity in the body's frame (rad/s), or the rates of the attitude's Euler angles.
    """

    position: Vector = (0.0, 0.0, 0.0)
    attitude: Attitude = (1.0, 0.0, 0.0, 0.0)
    velocity: Vector = (0.0, 0.0, 0.0)
    rotation: Vector | EulerRates = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class JointedBody:
    """A body of a mechanism. A body without mass is a frame, such as one between two joints that move the same solid.

    Attributes
    ----------
    name
        Its name, unique in the mechanism.
    inertia
        Its mass distribution, in its frame: a solid at its centre of mass, an inertia tensor about the centre of mass, or
        several particles or solids at given positions. Moments of inertia may be zero, and so may the mass of a tensor of
        zeros, if the mass matrix of the mechanism is positive definite.
    center_of_mass
        The centre of mass in the body's frame (m), for an inertia tensor alone; solids and particles determine their own.
    start
        Its initial state; None if it is the child of a joint.
    shape
        Its shape about the centre of mass, along the axes of its frame; None if it has no shape, or the shape of its one solid.
    """

    name: str
    inertia: Given
    center_of_mass: Vector = (0.0, 0.0, 0.0)
    start: BodyStart | None = None
    shape: Shape | None = None


@dataclass(frozen=True)
class Mimic:
    """The rule by which a joint follows another joint: coordinate = multiplier * (coordinate of the other joint) + offset.

    Attributes
    ----------
    joint
        The index of the other joint in `Mechanism.joints`. Both are revolute or prismatic, and the other joint may follow a
        third one.
    multiplier, offset
        The numbers of the rule (in the units of the two coordinates).
    """

    joint: int
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Joint:
    """A joint between a parent and a child.

    Attributes
    ----------
    name, type
        Its name, unique in the mechanism, and its type.
    parent, child
        The indices of the two bodies in `Mechanism.bodies`; the parent may be `WORLD`.
    position, attitude
        The joint's frame in the parent's frame: its origin (m), and the rotation from its axes to the parent's axes.
    axis
        The axis of a revolute or prismatic joint in the joint's frame, of any length.
    armature
        Inertia that is added to the inertia of the joint's coordinate (kg m^2 or kg).
    damping
        Coefficient of the force against the joint's velocity (N m s/rad or N s/m).
    stiffness, rest
        Coefficient of the force towards the coordinate `rest` (N m/rad or N/m; rad or m).
    friction
        Largest dry friction against the joint's velocity, which can also hold the joint at rest (N m or N).
    effort
        Constant force along the coordinate (N m or N).
    start, start_velocity
        Initial coordinates and velocities as the file gives them, in the layout of `coordinates`; a quaternion may have any
        length.
    mimic
        The rule by which the joint follows another one without play; None if it moves by itself. Its initial coordinate and
        velocity follow from the rule, and `start` and `start_velocity` are the doubles nearest to them.
    stops
        The stops of a revolute or prismatic joint; None if its coordinate has no limits.
    """

    name: str
    type: JointType
    parent: int
    child: int
    position: Vector = (0.0, 0.0, 0.0)
    attitude: Attitude = (1.0, 0.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 1.0)
    armature: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    friction: float = 0.0
    effort: float = 0.0
    start: tuple[float, ...] = ()
    start_velocity: tuple[float, ...] = ()
    mimic: Mimic | None = None
    stops: Stops | None = None

    @property
    def form(self) -> JointForm:
        """The entry of the joint's type in `JOINT_TYPES`."""
        return JOINT_TYPES[self.type]


@dataclass(frozen=True)
class Loop:
    """A point of one body that coincides with a point of another body.

    Attributes
    ----------
    bodies
        The indices of the two bodies; one may be `WORLD`.
    points
        The two points, each in the frame of its body (m).
    """

    bodies: tuple[int, int]
    points: tuple[Vector, Vector]


@dataclass(frozen=True)
class PairContact:
    """The contact of two bodies with each other, if there is no plane or it differs from their contact with the plane.

    Attributes
    ----------
    bodies
        The indices of the two bodies; one may be `WORLD`, which denotes the plane.
    friction, restitution, rolling_friction, torsional_friction, cone
        As in `scene.Plane`.
    """

    bodies: tuple[int, int]
    friction: float
    restitution: float
    rolling_friction: float = 0.0
    torsional_friction: float = 0.0
    cone: Cone = "product"


@dataclass(frozen=True)
class Mechanism:
    """Bodies on joints, or free bodies that touch each other and a plane.

    Attributes
    ----------
    bodies, joints
        The bodies and the joints, in the order of the file.
    loops
        The closures of chains of joints.
    gravity
        Magnitude of the gravitational acceleration, along -z (m/s^2).
    plane
        The plane that bodies lie on or fall on; None if there is no plane. Without a plane, only the pairs of `contacts` touch,
        and all other bodies pass through each other.
    contacts
        The pairs whose friction and restitution differ from those of the plane; without a plane, all pairs that touch.
    pushes
        Constant forces on bodies.
    controllers
        The controllers of joints, in the order of the file.
    stops_until
        The time (s) from which on rigid stops no longer act; None if they always act.
    """

    bodies: tuple[JointedBody, ...]
    joints: tuple[Joint, ...] = ()
    loops: tuple[Loop, ...] = ()
    gravity: float = 0.0
    plane: Plane | None = None
    contacts: tuple[PairContact, ...] = ()
    pushes: tuple[Push, ...] = ()
    controllers: tuple[Controller, ...] = ()
    stops_until: float | None = None

    @property
    def conserves(self) -> bool:
        """True if energy is conserved: there is no damping, dry friction, stop, controller, plane, contact or push."""
        loses = any(joint.damping or joint.friction or joint.stops for joint in self.joints)
        return not (loses or self.plane is not None or self.contacts or self.pushes or self.controllers)

    @property
    def contact_laws(self) -> tuple[Plane | PairContact, ...]:
        """The law of the plane, if there is one, and those of the pairs with laws of their own."""
        return (*(() if self.plane is None else (self.plane,)), *self.contacts)

    @property
    def driven(self) -> tuple[int, ...]:
        """The indices of the joints that have a controller or elastic stops, in the order of the file."""
        controlled = {controller.joint for controller in self.controllers}
        elastic = {index for index, joint in enumerate(self.joints) if joint.stops is not None and not joint.stops.rigid}
        return tuple(sorted(controlled | elastic))

    @property
    def joint_of(self) -> tuple[Joint | None, ...]:
        """The joint whose child each body is; None for a free body."""
        by_child = {joint.child: joint for joint in self.joints}
        return tuple(by_child.get(index) for index in range(len(self.bodies)))


def breadth_first(mechanism: Mechanism) -> list[int]:
    """The indices of all bodies, each after its parent: those on the world first, then those that hang on them, and so on."""
    children: dict[int, list[int]] = {}
    for body, joint in enumerate(mechanism.joint_of):
        children.setdefault(WORLD if joint is None else joint.parent, []).append(body)
    order = list(children.get(WORLD, []))
    for body in order:
        order += children.get(body, [])
    return order


def depth_first(mechanism: Mechanism) -> Iterator[int]:
    """The indices of all bodies, each followed by all bodies that hang on it, children in the order of the file."""
    children: dict[int, list[int]] = {}
    for body, joint in enumerate(mechanism.joint_of):
        children.setdefault(WORLD if joint is None else joint.parent, []).append(body)
    waiting = children.get(WORLD, [])[::-1]
    while waiting:
        yield (body := waiting.pop())
        waiting += children.get(body, [])[::-1]


#: The physical content of any case.
AnyScene = Scene | Mechanism


def alone(scene: AnyScene) -> Scene:
    """Return the scene, which must be of a single body. Raises `TypeError` for a mechanism; callers exclude these before."""
    if isinstance(scene, Mechanism):
        raise TypeError("a mechanism where a single body is meant")
    return scene


def shape_of(body: JointedBody) -> Shape | None:
    """The shape of a body, or of the one solid that it is made of; None if it has no shape."""
    return body.shape or getattr(body.inertia, "shape", None)
