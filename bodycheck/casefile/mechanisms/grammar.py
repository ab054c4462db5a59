"""The grammar of case files, format 2, as pydantic models: bodies, the joints between them, and loops."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, cast, get_args

from pydantic import BeforeValidator, Discriminator, Field, Tag, create_model

from bodycheck.casefile import grammar
from bodycheck.casefile.grammar import WORD
from bodycheck.casefile.mechanisms.control_grammar import ControllerTable, ReadSignalTable, StopsTable
from bodycheck.casefile.robots.reading import Ignored, Used
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import (
    DIGEST,
    MAX_PUSHES,
    Label,
    NonNegative,
    Notice,
    Number,
    Positive,
    Quaternion,
    Table,
    Text,
    Vector,
)
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES, JointForm, StartKeys

#: Version of the format of case files of mechanisms.
FORMAT = 2

#: The name of the world among the bodies.
WORLD = "world"

#: The largest numbers of bodies and joints, and of loops.
MAX_BODIES = 200
MAX_LOOPS = 200

#: Limits of a model: the number of files that are read for it and of notices, the number of a keyframe, and of words of ignore.
MAX_FILES = 1000
MAX_NOTICES = 200
MAX_KEYFRAME = 10**6
MAX_IGNORED = 50

#: The largest number of tendons with limits.
MAX_TENDONS = 1000

#: The largest number of columns that are read of files of signals: each signal of each controller has one.
MAX_COLUMNS = 3 * MAX_BODIES

NonNegativeVector = tuple[NonNegative, NonNegative, NonNegative]
Pair = tuple[Number, Number]
AnyInertia = Annotated[
    Annotated[NonNegativeVector, Tag("moments")] | Annotated[grammar.Matrix, Tag("tensor")],
    Discriminator(grammar.kind_of_inertia),
]


#: The name of a body or joint: any printable text. In key paths, names of other characters than `PLAIN_NAME` are quoted.
PartName = Label

#: The words of the key `ignore`.
IGNORED: tuple[Ignored, ...] = get_args(Ignored)

#: The words of the key `use`.
USED: tuple[Used, ...] = get_args(Used)


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
    kinds: dict[int, Any] = {0: Number, 2: Pair, 3: Vector, 4: Quaternion}
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
    quaternion: Quaternion | None = Field(default=None, description="w, x, y, z, the joint's axes to the frame of the parent")


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
    limits: StopsTable | None = Field(default=None, description="the stops at which the coordinate ends")
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


class FileTable(Table):
    """A file that was read for a model."""

    name: Text = Field(description="its path from the folder of the model, or in a package")
    sha256: Annotated[str, Field(strict=True, pattern=DIGEST)] = Field(description="digest of its content")


class RangeTable(Table):
    """The limits of a joint, which the mechanics of a case does not have."""

    joint: PartName = Field(description="its name")
    lower: Number | None = Field(default=None, description="smallest coordinate, rad or m")
    upper: Number | None = Field(default=None, description="largest coordinate, rad or m")


class TendonTable(Table):
    """The limits of a fixed tendon, which the mechanics of a case does not have."""

    name: PartName = Field(description="its name")
    terms: Annotated[tuple[tuple[PartName, Number], ...], Field(min_length=1, max_length=MAX_BODIES)] = Field(
        description="joints, and the coefficients of their coordinates in the length"
    )
    lower: Number | None = Field(default=None, description="smallest length")
    upper: Number | None = Field(default=None, description="largest length")


#: Tables of bodies, joints or loops in `[model.stored]`, which are checked where they stand in for those of a case file.
StoredTables = Annotated[tuple[dict[str, Any], ...], Field(max_length=MAX_BODIES)]


class StoredTable(Table):
    """What was read of a model, as bodycheck stores it with the case."""

    files: Annotated[tuple[FileTable, ...], Field(max_length=MAX_FILES)] = Field(
        default=(), description="the files that were read, the model first"
    )
    bodies: StoredTables = Field(default=(), description="tables as in [[bodies]]")
    joints: StoredTables = Field(default=(), description="tables as in [[joints]]")
    loops: StoredTables = Field(default=(), description="tables as in [[loops]]")
    controllers: StoredTables = Field(default=(), description="tables as in [[controllers]]")
    base: PartName | None = Field(default=None, description="name of the joint of the free base, if there is one")
    timestep: Positive | None = Field(default=None, description="of the file, s")
    stops_until: Positive | None = Field(default=None, description="from when on ranges are no stops any more, s")
    without: Annotated[tuple[Ignored, ...], Field(max_length=len(IGNORED))] = Field(
        default=(), description="words of ignore that leave out something that the file has"
    )
    notices: Annotated[tuple[Notice, ...], Field(max_length=MAX_NOTICES)] = Field(
        default=(), description="sentences on parts of the file that are no mechanics of the case"
    )
    ranges: Annotated[tuple[RangeTable, ...], Field(max_length=MAX_BODIES)] = Field(default=(), description="limits of joints")
    tendons: Annotated[tuple[TendonTable, ...], Field(max_length=MAX_TENDONS)] = Field(
        default=(), description="limits of fixed tendons"
    )
    touching: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="whether bodies have shapes that may touch"
    )
    texts: Annotated[tuple[tuple[str, str], ...], Field(max_length=MAX_FILES)] = Field(
        default=(), description="names and contents of the files that are texts"
    )
    text: str | None = Field(default=None, description="content of the model; earlier versions stored nothing else")


def _kind_of_keyframe(value: Any) -> str:
    return WORD if isinstance(value, str) else "number"


Keyframe = Annotated[
    Annotated[Text, Tag(WORD)] | Annotated[int, Field(strict=True, ge=0, le=MAX_KEYFRAME), Tag("number")],
    Discriminator(_kind_of_keyframe),
]


class ModelTable(Table):
    """A robot model in the place of bodies and joints."""

    file: Text = Field(description="URDF or MJCF, in the folder of the case file")
    base: Literal["fixed", "free"] = Field(default="fixed", description="as the file says, or free: the root link floats")
    ignore: Annotated[tuple[Ignored, ...], Field(max_length=MAX_IGNORED)] = Field(
        default=(), description="what is left out on purpose"
    )
    use: Annotated[tuple[Used, ...], Field(max_length=MAX_IGNORED)] = Field(
        default=(), description="what is taken over beside bodies and joints: ranges as rigid stops, actuators as controllers"
    )
    keyframe: Keyframe | None = Field(
        default=None, description="of MJCF, by its name or its number from 0, at which the joints start"
    )
    upright: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="of MJCF: the axes of the world are turned so that the gravity of the file is along -z"
    )
    stored: StoredTable | None = Field(default=None, description="what was read of it; bodycheck writes it")


class BaseStartTable(Table):
    """The state at t = 0 of a free base: of the origin of the root link, not of its centre of mass."""

    position: Vector | None = Field(default=None, description="of the origin of the root link, world frame, m")
    velocity: Vector | None = Field(default=None, description="of the origin of the root link, world frame, m/s")
    euler_zxz: Vector | None = Field(default=None, description="phi, theta, psi, rad")
    quaternion: Quaternion | None = Field(default=None, description="w, x, y, z, root link to world")
    angular_velocity: Vector | None = Field(default=None, description="along the axes of the root link, rad/s")


class ModelStartTable(Table):
    """The state at t = 0 of a model: of its free base, and of its joints, a table a joint. The keyframe has the others."""

    base: BaseStartTable | None = Field(default=None, description="the state of a free base")
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
    controllers: Annotated[tuple[ControllerTable, ...], Field(max_length=MAX_BODIES)] = Field(
        default=(), description="what drives the joints, a table a joint"
    )
    signals: Annotated[tuple[ReadSignalTable, ...], Field(max_length=MAX_COLUMNS)] = Field(
        default=(), description="what was read of files of signals; bodycheck writes it"
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
    ("model", "stored", "files"): FileTable,
    ("model", "stored", "ranges"): RangeTable,
    ("model", "stored", "tendons"): TendonTable,
    ("initial",): ModelStartTable,
    ("initial", "base"): BaseStartTable,
    ("joints", "mimic"): MimicTable,
    ("joints", "limits"): StopsTable,
    ("controllers",): ControllerTable,
    ("signals",): ReadSignalTable,
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
