"""The grammar of case files, format 1, as pydantic models: the allowed keys and values.

The module `contradictions` checks rules that connect several keys. It checks the raw document, so that their faults are
reported together with the faults of single keys.
"""

import math
from datetime import date
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, create_model

from bodycheck.casefile.axes import AXES
from bodycheck.casefile.ensemble_grammar import EnsembleTable
from bodycheck.casefile.sensors.grammar import Sensors
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import (
    MAX_CONTACTS,
    MAX_EXPECTATIONS,
    MAX_PARTS,
    MAX_PUSHES,
    MAX_SAMPLES,
    MAX_SENSORS,
    MAX_TAGS,
    BodyPattern,
    EngineName,
    Finite,
    Label,
    Name,
    NonNegative,
    Positive,
    PositiveVector,
    Quaternion,
    Spelling,
    Table,
    Text,
    Vector,
)
from bodycheck.figures.columns import LIMITED
from bodycheck.reference.scene import Cone

#: Version of the format of case files.
FORMAT = 1


def kind_of_inertia(value: Any) -> str:
    """Return the tag of the form in which a value gives an inertia."""
    return "tensor" if isinstance(value, list | tuple) and any(isinstance(row, list | tuple) for row in value) else "moments"


Matrix = tuple[Vector, Vector, Vector]


#: Description of the key `inertia`.
INERTIA = "principal moments A, B, C, or the whole tensor along I, J, K with Ixy = -(sum of m x y), kg m^2"
AnyInertia = Annotated[
    Annotated[PositiveVector, Tag("moments")] | Annotated[Matrix, Tag("tensor")], Discriminator(kind_of_inertia)
]


class BodyTable(Table):
    """The keys of every solid."""

    mass: Positive = Field(description="kg")
    inertia: AnyInertia | None = Field(default=None, description=INERTIA)


class BrickTable(BodyTable):
    """A rectangular block."""

    shape: Literal["brick"]
    semi_axes: PositiveVector = Field(description="half-lengths along I, J, K, m")


class EllipsoidTable(BodyTable):
    """A solid ellipsoid."""

    shape: Literal["ellipsoid"]
    semi_axes: PositiveVector = Field(description="along I, J, K, m")


class CylinderTable(BodyTable):
    """A solid cylinder about K."""

    shape: Literal["cylinder"]
    radius: Positive = Field(description="m")
    half_length: Positive = Field(description="m")


class SphereTable(BodyTable):
    """A solid sphere."""

    shape: Literal["sphere"]
    radius: Positive = Field(description="m")


class ParticleTable(Table):
    """A point mass."""

    mass: Positive = Field(description="kg")
    position: Vector = Field(description="in the frame of the body, from any origin, m")


class PartTable(Table):
    """A homogeneous solid that is part of a body, rigidly joined to the others."""

    shape: Literal["brick", "ellipsoid", "cylinder", "sphere"]
    semi_axes: PositiveVector | None = Field(default=None, description="of a brick or ellipsoid, along I, J, K, m")
    radius: Positive | None = Field(default=None, description="of a cylinder or sphere, m")
    half_length: Positive | None = Field(default=None, description="of a cylinder, m")
    mass: Positive = Field(description="kg")
    position: Vector = Field(default=(0.0, 0.0, 0.0), description="of its centre, in the frame of the body, from any origin, m")
    euler_zxz: Vector | None = Field(default=None, description="of its axes in the frame of the body, rad")
    quaternion: Quaternion | None = Field(default=None, description="w, x, y, z, its axes to the frame of the body")


class ShapelessTable(Table):
    """A body of which only mass and inertia matter: these themselves, or particles, or parts that make them."""

    shape: Literal["none"] = "none"
    mass: Positive | None = Field(default=None, description="kg, with inertia")
    inertia: AnyInertia | None = Field(default=None, description=INERTIA)
    particles: Annotated[tuple[ParticleTable, ...], Field(min_length=1, max_length=MAX_PARTS)] | None = Field(
        default=None, description="point masses that make it"
    )
    parts: Annotated[tuple[PartTable, ...], Field(min_length=1, max_length=MAX_PARTS)] | None = Field(
        default=None, description="solids that make it"
    )


SHAPE_TABLES: dict[str, type[Table]] = {
    "brick": BrickTable,
    "ellipsoid": EllipsoidTable,
    "cylinder": CylinderTable,
    "sphere": SphereTable,
    "none": ShapelessTable,
}


def with_shape(body: Any) -> Any:
    """Return a body table with `shape = "none"` added if it consists of particles or parts and gives no shape."""
    is_composed = isinstance(body, dict) and "shape" not in body and ("particles" in body or "parts" in body)
    return {**body, "shape": "none"} if is_composed else body


AnyBody = Annotated[
    BrickTable | EllipsoidTable | CylinderTable | SphereTable | ShapelessTable,
    Field(discriminator="shape"),
    BeforeValidator(with_shape),
]


class InitialTable(Table):
    """The state at t = 0."""

    position: Vector | None = Field(
        default=None, description="of the centre of mass, world frame, m; default 0, or on a plane lying on it"
    )
    velocity: Vector = Field(default=(0.0, 0.0, 0.0), description="of the centre of mass, world frame, m/s")
    euler_zxz: Vector | None = Field(default=None, description="phi, theta, psi, rad")
    quaternion: Quaternion | None = Field(default=None, description="w, x, y, z, body to world")
    euler_rates: Vector | None = Field(default=None, description="dphi, dtheta, dpsi, rad/s")
    angular_velocity: Vector | None = Field(default=None, description="X, Y, Z in the body frame, rad/s")


#: The tag of a word in a union of a word and a number.
WORD = "word"


def _kind_of_friction(value: Any) -> str:
    return WORD if isinstance(value, str) else "coefficient"


Friction = Annotated[
    Annotated[NonNegative, Tag("coefficient")] | Annotated[Literal["no-slip"], Tag(WORD)], Discriminator(_kind_of_friction)
]
Restitution = Annotated[Finite, Field(ge=0, le=1)]


class PlaneTable(Table):
    """The plane z = 0, or one through the origin that is turned about y."""

    friction: Friction = Field(default=0.0, description="Coulomb's coefficient, or no-slip where nothing slips")
    incline: Annotated[Finite, Field(ge=0, lt=math.pi / 2)] = Field(
        default=0.0, description="turns the plane about y, so that x points downhill, rad"
    )
    restitution: Restitution = Field(default=0.0, description="ratio of the normal velocities after and before an impact")
    rolling_friction: NonNegative = Field(default=0.0, description="largest moment along the plane over the normal force, m")
    torsional_friction: NonNegative = Field(default=0.0, description="largest moment about the normal over the normal force, m")
    cone: Cone | None = Field(
        default=None, description="limits of friction and moments: each its own (product, the default), or one for all"
    )
    law: Literal["area", "corners", "decoupled"] = Field(
        default="area", description="where it touches: the whole face, its corners, or as if slide and spin were each alone"
    )
    pressure: Literal["uniform", "balanced"] = Field(
        default="uniform", description="balanced: the load shifts to balance the tipping moment of friction"
    )


class DragTable(Table):
    """Resistance of the air."""

    quadratic: NonNegative = Field(description="k in F = -k |v| v at the centre of mass, kg/m")


class ForceTable(Table):
    """A constant force on a body."""

    force: Vector = Field(description="world frame, N")
    point: Vector = Field(default=(0.0, 0.0, 0.0), description="where it acts, from the centre of mass along I, J, K, m")


def with_times(force: type[ForceTable], name: str) -> Any:
    """Return the table of a constant force on a body for some time; `from`, the name of a key, is no Python identifier."""
    begins = NonNegative, Field(default=0.0, description="when it begins, s")
    ends = optional(NonNegative, "when it ends, s; default never")
    return create_model(
        name, __base__=force, __doc__="A constant force on a body for some time.", **{"from": begins, "until": ends}
    )


def optional(kind: Any, description: str) -> Any:
    """Return the definition of a key that may be absent, as an argument of `pydantic.create_model`."""
    return kind | None, Field(default=None, description=description)


if TYPE_CHECKING:  # type checkers cannot see the keys of a table that is made while the program runs
    PushTable = ForceTable
else:
    PushTable = with_times(ForceTable, "PushTable")


class ContactTable(Table):
    """How two bodies touch, or a body and the plane. What no table names touches as the plane says."""

    bodies: tuple[BodyPattern, BodyPattern] = Field(description="names; plane is the plane, and * stands for any characters")
    friction: Friction | None = Field(default=None, description="as that of the plane, which is the default")
    restitution: Restitution | None = Field(default=None, description="as that of the plane, which is the default")
    rolling_friction: NonNegative | None = Field(default=None, description="as that of the plane, which is the default, m")
    torsional_friction: NonNegative | None = Field(default=None, description="as that of the plane, which is the default, m")
    cone: Cone | None = Field(default=None, description="as that of the plane, which is the default")


Pushes = Annotated[tuple[PushTable, ...], Field(max_length=MAX_PUSHES)]
Contacts = Annotated[tuple[ContactTable, ...], Field(max_length=MAX_CONTACTS)]


class SceneTable(Table):
    """The surroundings."""

    gravity: NonNegative = Field(default=0.0, description="along -z, m/s^2")
    plane: PlaneTable | None = None
    drag: DragTable | None = None
    contacts: Contacts = Field(default=(), description="how pairs touch, a table a pair; the body is called body")
    push: Pushes = Field(default=(), description="constant forces, a table a force")


class RunTable(Table):
    """How long to look, and how often."""

    duration: Positive = Field(description="s")
    samples: Annotated[int, Field(strict=True, ge=2, le=MAX_SAMPLES)] = Field(description="evenly spaced, both ends included")


class RangeTable(Table):
    """The range that a figure must be in."""

    at_least: NonNegative | None = Field(default=None, description="in the figure's unit")
    at_most: NonNegative | None = Field(default=None, description="in the figure's unit")


def _kind_of_limit(value: Any) -> str:
    return "range" if isinstance(value, dict | RangeTable) else "limit"


def _is_date(value: str) -> str:
    try:
        date.fromisoformat(value)
    except ValueError as error:
        raise ValueError('should be a date such as "2027-06-01"') from error
    return value


#: The largest errors of sensors, by their names.
SensorLimits = Annotated[dict[Label, NonNegative], Field(min_length=1, max_length=MAX_SENSORS)]

AnyLimit = Annotated[Annotated[NonNegative, Tag("limit")] | Annotated[RangeTable, Tag("range")], Discriminator(_kind_of_limit)]


Status = Literal["ok", "unsupported", "diverged", "crashed", "timeout"]


class MethodTable(Table):
    """The method of which something is expected, and how its run must end."""

    engine: EngineName = Field(description="its name, as `bodycheck engines` lists it")
    integrator: Spelling = Field(description="by the engine's own name; options behind a colon, as in Euler:cone=elliptic")
    timestep: Positive = Field(description="s")
    version: Label | None = Field(
        default=None, description="of the engine with which the limits were measured, as `bodycheck expect` writes it"
    )
    status: Status | None = Field(default=None, description="how the run must end; default ok")


if TYPE_CHECKING:
    LimitsTable = MethodTable
    AxesTable = Table
else:
    LimitsTable = create_model(
        "LimitsTable",
        __base__=MethodTable,
        **{name: optional(AnyLimit, column.description) for name, column in LIMITED.items()},
    )
    AxesTable = create_model(
        "AxesTable", __base__=Table, **{name: optional(axis.values, axis.description) for name, axis in AXES.items()}
    )


class ExpectTable(LimitsTable):
    """What must hold of one method: a figure's largest value over all samples is at most a number, or within a range."""

    sensors: SensorLimits | None = Field(
        default=None, description="largest error of each sensor by its name, in its unit; of a wrench in N and N m"
    )
    known: Label | None = Field(default=None, description="where a discrepancy is discussed that breaks this")
    until: Annotated[Text, AfterValidator(_is_date)] | None = Field(default=None, description="last day on which it may")


class ExtremesTable(AxesTable):
    """The axes along which the case is pushed to extremes, each with the values that are tried."""


#: The keys `tags` and `expect` of a case file.
Tags = Annotated[tuple[Label, ...], Field(max_length=MAX_TAGS)]
Expectations = Annotated[tuple[ExpectTable, ...], Field(max_length=MAX_EXPECTATIONS)]


class Heading(Table):
    """The beginning of a case file, in any format."""

    format: int = Field(description="of the file")
    name: Name = Field(description="unique among the cases of a run")
    title: Text = Field(description="what it is, in a few words")
    source: Text = Field(default="", description="where it comes from")
    tags: Tags = Field(default=(), description="to group cases by")


class Conduct(Table):
    """The keys that say what is done with the scene of a case file, in any format."""

    sensors: Sensors = Field(default=(), description="what is read of the motion, a table a sensor")
    run: RunTable
    extremes: ExtremesTable = Field(default_factory=ExtremesTable)
    ensemble: EnsembleTable | None = None
    expect: Expectations = Field(default=(), description="what must hold, a table a method")


class BodyKeys(Heading):
    """A case file of one body."""

    format: Literal[1] = Field(description="of the file")
    body: AnyBody = Field(description="what moves")
    initial: InitialTable = Field(default_factory=InitialTable)
    scene: SceneTable = Field(default_factory=SceneTable)


class CaseTable(Conduct, BodyKeys):
    """A whole case file."""


#: The tables for the use of a scene, in any format.
CONDUCT: dict[Path, type[Table]] = {
    ("run",): RunTable,
    ("extremes",): ExtremesTable,
    ("ensemble",): EnsembleTable,
    ("expect",): ExpectTable,
    **{("expect", name): RangeTable for name in LIMITED},
}

TABLES: dict[Path, type[Table]] = {
    (): CaseTable,
    ("body", "particles"): ParticleTable,
    ("body", "parts"): PartTable,
    ("initial",): InitialTable,
    ("scene",): SceneTable,
    ("scene", "plane"): PlaneTable,
    ("scene", "drag"): DragTable,
    ("scene", "contacts"): ContactTable,
    ("scene", "push"): PushTable,
    **CONDUCT,
}


def shape_of(body: Any) -> str:
    """Return the shape of a body or part, or an empty text if it is invalid; the grammar reports invalid types."""
    shape = body.get("shape") if isinstance(body, dict) else None
    return shape if isinstance(shape, str) else ""
