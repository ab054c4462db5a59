"""The grammar of case files, format 2, as pydantic models: bodies, the joints between them, and loops."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, cast

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, create_model

from bodycheck.casefile import grammar
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import MAX_NAME_LENGTH, MAX_PUSHES, PART_NAME, NonNegative, Number, Table, Text, Vector
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointForm, StartKeys

#: Version of the format of case files of mechanisms.
FORMAT = 2

#: The name of the world among the bodies.
WORLD = "world"

#: The largest numbers of bodies and joints, and of loops.
MAX_BODIES = 200
MAX_LOOPS = 200

NonNegativeVector = tuple[NonNegative, NonNegative, NonNegative]
Pair = tuple[Number, Number]
AnyInertia = Annotated[
    Annotated[NonNegativeVector, Tag("moments")] | Annotated[grammar.Matrix, Tag("tensor")],
    Discriminator(grammar.kind_of_inertia),
]


def _not_a_number(value: str) -> str:
    if value.isdecimal():
        raise ValueError("should have more than digits, since a number counts bodies and joints")
    return value


#: The name of a body or joint. It may be a part of a dotted key path.
PartName = Annotated[str, Field(strict=True, pattern=PART_NAME, max_length=MAX_NAME_LENGTH), AfterValidator(_not_a_number)]


class JointedTable(Table):
    """The keys of every body of a mechanism."""

    name: PartName = Field(description="unique among the bodies")
    center_of_mass: Vector | None = Field(default=None, description="in the frame of the body, m; default 0")
    inertia: AnyInertia | None = Field(
        default=None, description=f"about the centre of mass: {grammar.INERTIA}; moments may be 0 where joints allow it"
    )
    initial: grammar.InitialTable | None = Field(
        default=None, description="state at t = 0 of a body that is the child of no joint"
    )


class BrickBody(JointedTable, grammar.BrickTable):
    """A rectangular block."""


class EllipsoidBody(JointedTable, grammar.EllipsoidTable):
    """A solid ellipsoid."""


class CylinderBody(JointedTable, grammar.CylinderTable):
    """A solid cylinder about K."""


class SphereBody(JointedTable, grammar.SphereTable):
    """A solid sphere."""


class ShapelessBody(JointedTable, grammar.ShapelessTable):
    """A body of which only mass and inertia matter: these themselves, or particles, or parts that make them."""

    mass: NonNegative | None = Field(default=None, description="kg, with inertia; 0 for a frame, whose inertia is 0")


BODY_TABLES: dict[str, type[Table]] = {
    "brick": BrickBody,
    "ellipsoid": EllipsoidBody,
    "cylinder": CylinderBody,
    "sphere": SphereBody,
    "none": ShapelessBody,
}


def with_shape(body: Any) -> Any:
    """Return a body table with `shape = "none"` added if it gives no shape."""
    return {**body, "shape": "none"} if isinstance(body, dict) and "shape" not in body else body


AnyBody = Annotated[
    BrickBody | EllipsoidBody | CylinderBody | SphereBody | ShapelessBody,
    Field(discriminator="shape"),
    BeforeValidator(with_shape),
]


def _start_table(keys: StartKeys) -> type[Table]:
    """Return the grammar of the table `initial` of a type of joint."""
    kinds: dict[int, Any] = {0: Number, 2: Pair, 3: Vector, 4: grammar.Quaternion}
    fields: dict[str, Any] = {
        key.name: (kinds[key.size], Field(default=key.default, description=key.description)) for key in keys.keys
    }
    about = f"The state at t = 0 of a {keys.joint} joint."
    return create_model(keys.table, __base__=Table, __doc__=about, **fields)


#: The table `initial` of each type of joint that has one.
STARTS: dict[str, type[Table]] = {}
_start_tables: dict[StartKeys, type[Table]] = {}
for _form in JOINT_TYPES.values():
    if _form.start is not None:
        STARTS[_form.name] = _start_tables.setdefault(_form.start, _start_table(_form.start))


class JointTable(Table):
    """The keys of every joint. The frame of the child is that of the joint where its coordinates are zero."""

    name: PartName = Field(description="unique among the joints")
    parent: PartName = Field(default=WORLD, description="name of a body, or world")
    child: PartName = Field(description="name of a body, which is the child of no other joint")
    position: Vector = Field(default=(0.0, 0.0, 0.0), description="of the joint in the frame of the parent, m")
    euler_zxz: Vector | None = Field(default=None, description="of the joint's axes in the frame of the parent, rad")
    quaternion: grammar.Quaternion | None = Field(
        default=None, description="w, x, y, z, the joint's axes to the frame of the parent"
    )


class MimicTable(Table):
    """The rule by which a joint follows another joint with one coordinate."""

    joint: PartName = Field(description="name of the other joint")
    multiplier: Number = Field(default=1.0, description="of its coordinate")
    offset: Number = Field(default=0.0, description="added to the product, rad or m")


class AxisTable(JointTable):
    """The keys of joints with one coordinate."""

    axis: Vector = Field(description="in the joint's frame, of any length")
    armature: NonNegative = Field(default=0.0, description="added to the inertia of the coordinate, kg m^2 or kg")
    damping: NonNegative = Field(default=0.0, description="N m s/rad or N s/m")
    stiffness: NonNegative = Field(default=0.0, description="of a spring, N m/rad or N/m")
    rest: Number = Field(default=0.0, description="the coordinate at which the spring is at rest, rad or m")
    friction: NonNegative = Field(default=0.0, description="dry friction, sticking included, N m or N")
    effort: Number = Field(default=0.0, description="constant torque or force along the coordinate, N m or N")
    mimic: MimicTable | None = Field(
        default=None, description="coordinate = multiplier * (that of the other joint) + offset, in place of initial"
    )


def _joint_table(form: JointForm) -> type[JointTable]:
    """Return the grammar of the table of a type of joint."""
    start = STARTS.get(form.name)
    keys: dict[str, Any] = {"type": (cast(Any, Literal)[form.name], ...)}
    initial: dict[str, Any] = {"initial": (start, Field(default_factory=start))} if start is not None else {}
    against = Field(default=0.0, description="against the relative angular velocity, N m s/rad")
    damping: dict[str, Any] = {"damping": (NonNegative, against)} if form.damped else {}
    base, fields = (AxisTable, initial | keys) if form.has_axis else (JointTable, keys | damping | initial)
    return create_model(f"{form.name.capitalize()}Table", __base__=base, __doc__=form.meaning, **fields)


#: The grammar of each type of joint.
JOINT_TABLES: dict[str, type[Table]] = {form.name: _joint_table(form) for form in JOINT_TYPES.values()}

if TYPE_CHECKING:  # type checkers cannot see the keys of tables that are made while the program runs
    AnyJoint = JointTable
else:
    AnyJoint = Annotated[Union[tuple(JOINT_TABLES.values())], Field(discriminator="type")]  # noqa: UP007


class LoopTable(Table):
    """What closes a chain: a point of one body stays on a point of another."""

    bodies: tuple[PartName, PartName] = Field(description="names of the two bodies; one may be world")
    points: tuple[Vector, Vector] = Field(description="the two points, each in the frame of its body, m")


class StoredTable(Table):
    """What was read of a model, as bodycheck stores it with the case."""

    text: str = Field(description="content of the file")


class ModelTable(Table):
    """A robot model in the place of bodies and joints."""

    file: Text = Field(description="URDF or MJCF, in the folder of the case file")
    stored: StoredTable | None = Field(default=None, description="what was read of it; bodycheck writes it")


class ModelStartTable(Table):
    """The state at t = 0 of the joints of a model, a table a joint."""

    joints: dict[str, dict[str, Any]] = Field(default={}, description="the keys of the table initial of a joint, by its name")


class BodyForceTable(grammar.ForceTable):
    """A constant force on a body."""

    body: PartName | None = Field(default=None, description="its name; default the only body")


if TYPE_CHECKING:
    BodyPushTable = BodyForceTable
else:
    BodyPushTable = grammar.with_times(BodyForceTable, "BodyPushTable")


class SurroundingsTable(Table):
    """The surroundings."""

    gravity: NonNegative = Field(default=0.0, description="along -z, m/s^2")
    plane: grammar.PlaneTable | None = None
    contacts: grammar.Contacts = Field(default=(), description="how pairs touch, a table a pair")
    push: Annotated[tuple[BodyPushTable, ...], Field(max_length=MAX_PUSHES)] = Field(
        default=(), description="constant forces, a table a force"
    )


class MechanismKeys(grammar.Heading):
    """A case file of a mechanism."""

    format: Literal[2] = Field(description="of the file")
    model: ModelTable | None = None
    initial: ModelStartTable | None = None
    bodies: Annotated[tuple[AnyBody, ...], Field(max_length=MAX_BODIES)] = Field(
        default=(), description="what moves, a table a body"
    )
    joints: Annotated[tuple[AnyJoint, ...], Field(max_length=MAX_BODIES)] = Field(
        default=(), description="what holds the bodies together, a table a joint"
    )
    loops: Annotated[tuple[LoopTable, ...], Field(max_length=MAX_LOOPS)] = Field(
        default=(), description="what closes chains, a table a point"
    )
    scene: SurroundingsTable = Field(default_factory=SurroundingsTable)


class MechanismTable(grammar.Conduct, MechanismKeys):
    """A whole case file of a mechanism."""


TABLES: dict[Path, type[Table]] = {
    **grammar.CONDUCT,
    (): MechanismTable,
    ("bodies", "particles"): grammar.ParticleTable,
    ("bodies", "parts"): grammar.PartTable,
    ("bodies", "initial"): grammar.InitialTable,
    ("model",): ModelTable,
    ("model", "stored"): StoredTable,
    ("initial",): ModelStartTable,
    ("joints", "mimic"): MimicTable,
    ("loops",): LoopTable,
    ("scene",): SurroundingsTable,
    ("scene", "plane"): grammar.PlaneTable,
    ("scene", "contacts"): grammar.ContactTable,
    ("scene", "push"): BodyPushTable,
}


def type_of(joint: Any) -> str:
    """Return the type of a joint, or an empty text if it is invalid; the grammar reports invalid types."""
    kind = joint.get("type") if isinstance(joint, dict) else None
    return kind if isinstance(kind, str) else ""
