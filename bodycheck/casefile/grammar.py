"""The grammar of case files, format 1, as pydantic models: what a key may hold, and nothing about what it means.

Rules that join several keys stand in `contradictions`, which looks at the raw document, so that they are reported together
with the faults of single keys.
"""

from datetime import date
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag

from bodycheck.adapters.method import Method
from bodycheck.casefile.toml_positions import Path
from bodycheck.errors import BadInput

FORMAT = 1
MOST_SAMPLES = 100_001
MOST_STEPS = 1e9
MOST_PARTS = 1000
LONGEST_NAME = 100
LONGEST_TEXT = 1000
MOST_TAGS = 50
MOST_EXPECTATIONS = 1000
MOST_VALUES = 50
MOST_POINTS = 500
#: No number of a case may exceed this in size, nor, other than zero, fall below its inverse: squares and products exist.
LARGEST = 1e100


def _not_vanishing(value: float) -> float:
    if 0 < abs(value) < 1 / LARGEST:
        raise ValueError(f"should be 0, or at least {1 / LARGEST:g} in size")
    return value


def _printable(value: str) -> str:
    if not value.isprintable():
        raise ValueError("should be printable, on one line")
    return value


def _spelling(value: str) -> str:
    try:
        Method.parse(value, 0.0)
    except BadInput as error:
        raise ValueError(str(error)) from error
    return value


Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Number = Annotated[Finite, Field(ge=-LARGEST, le=LARGEST), AfterValidator(_not_vanishing)]
Positive = Annotated[Finite, Field(gt=0, le=LARGEST), AfterValidator(_not_vanishing)]
NonNegative = Annotated[Finite, Field(ge=0, le=LARGEST), AfterValidator(_not_vanishing)]
Ratio = Annotated[Finite, Field(ge=1e-20, le=1)]
Factor = Annotated[Finite, Field(ge=1e-10, le=1e10)]
Text = Annotated[str, Field(strict=True, max_length=LONGEST_TEXT), AfterValidator(_printable)]
Name = Annotated[str, Field(strict=True, pattern=r"^[a-z0-9-]+$", max_length=LONGEST_NAME)]
Label = Annotated[str, Field(strict=True, min_length=1, max_length=LONGEST_NAME), AfterValidator(_printable)]
Spelling = Annotated[Label, AfterValidator(_spelling)]
Vector = tuple[Number, Number, Number]
PositiveVector = tuple[Positive, Positive, Positive]


def _kind_of_inertia(value: Any) -> str:
    return "tensor" if isinstance(value, list | tuple) and any(isinstance(row, list | tuple) for row in value) else "moments"


Matrix = tuple[Vector, Vector, Vector]
Quaternion = tuple[Number, Number, Number, Number]


class Table(BaseModel):
    """A table whose unknown keys are faults."""

    model_config = ConfigDict(extra="forbid", frozen=True)


INERTIA = "principal moments A, B, C, or the whole tensor along I, J, K, kg m^2"
AnyInertia = Annotated[
    Annotated[PositiveVector, Tag("moments")] | Annotated[Matrix, Tag("tensor")], Discriminator(_kind_of_inertia)
]


class BodyTable(Table):
    """What every solid has."""

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
    particles: Annotated[tuple[ParticleTable, ...], Field(min_length=1, max_length=MOST_PARTS)] | None = Field(
        default=None, description="point masses that make it"
    )
    parts: Annotated[tuple[PartTable, ...], Field(min_length=1, max_length=MOST_PARTS)] | None = Field(
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
    """A body made of particles or parts needs no shape to be given."""
    made = isinstance(body, dict) and "shape" not in body and ("particles" in body or "parts" in body)
    return {**body, "shape": "none"} if made else body


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


class PlaneTable(Table):
    """The plane z = 0."""

    friction: NonNegative = Field(default=0.0, description="Coulomb's coefficient")
    law: Literal["area", "corners", "decoupled"] = Field(
        default="area", description="where it touches: the whole face, its corners, or as if slide and spin were each alone"
    )
    pressure: Literal["uniform", "balanced"] = Field(
        default="uniform", description="balanced: the load shifts to balance the tipping moment of friction"
    )


class DragTable(Table):
    """Resistance of the air."""

    quadratic: NonNegative = Field(description="k in F = -k |v| v at the centre of mass, kg/m")


class SceneTable(Table):
    """The surroundings."""

    gravity: NonNegative = Field(default=0.0, description="along -z, m/s^2")
    plane: PlaneTable | None = None
    drag: DragTable | None = None


class RunTable(Table):
    """How long to look, and how often."""

    duration: Positive = Field(description="s")
    samples: Annotated[int, Field(strict=True, ge=2, le=MOST_SAMPLES)] = Field(description="evenly spaced, both ends included")


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


AnyLimit = Annotated[Annotated[NonNegative, Tag("limit")] | Annotated[RangeTable, Tag("range")], Discriminator(_kind_of_limit)]


Status = Literal["ok", "unsupported", "diverged", "crashed", "timeout"]


def limit(description: str) -> Any:
    """The field of a figure that may be limited."""
    return Field(default=None, description=description)


class ExpectTable(Table):
    """What must hold of one method: a figure's largest value over all samples is at most a number, or within a range."""

    engine: Label = Field(description="its name, as `bodycheck engines` lists it")
    integrator: Spelling = Field(description="by the engine's own name; options behind a colon, as in Euler:cone=elliptic")
    timestep: Positive = Field(description="s")
    status: Status | None = limit("how the run must end; default ok")
    position_error: AnyLimit | None = limit("m")
    velocity_error: AnyLimit | None = limit("m/s")
    attitude_error: AnyLimit | None = limit("rad")
    angular_velocity_error: AnyLimit | None = limit("rad/s")
    energy_drift: AnyLimit | None = limit("relative")
    rotational_energy_drift: AnyLimit | None = limit("relative")
    angular_momentum_drift: AnyLimit | None = limit("relative")
    energy_error: AnyLimit | None = limit("relative, with friction or drag")
    rotational_energy_error: AnyLimit | None = limit("relative, with friction or drag")
    angular_momentum_error: AnyLimit | None = limit("relative, with friction or drag")
    stop_time_error: AnyLimit | None = limit("s, of a body that slides to rest")
    stop_position_error: AnyLimit | None = limit("m")
    stop_yaw_error: AnyLimit | None = limit("rad")
    creep: AnyLimit | None = limit("m/s, after the stop")
    penetration: AnyLimit | None = limit("m, into the plane")
    tilt: AnyLimit | None = limit("rad, of K from the vertical")
    order: AnyLimit | None = limit("of the attitude error, from this step, its half and its quarter; a number within a quarter")
    known: Label | None = Field(default=None, description="where a discrepancy is discussed that breaks this")
    until: Annotated[Text, AfterValidator(_is_date)] | None = Field(default=None, description="last day on which it may")


LIMITS = tuple(
    name for name in ExpectTable.model_fields if name not in ("engine", "integrator", "timestep", "status", "known", "until")
)


def _distinct(values: tuple[float, ...]) -> tuple[float, ...]:
    if not values:
        raise ValueError("has no values")
    if len(set(values)) < len(values):
        raise ValueError("has a value twice")
    return values


Several, Distinct = Field(max_length=MOST_VALUES), AfterValidator(_distinct)
Values = Annotated[tuple[Positive, ...], Several, Distinct]
NonNegativeValues = Annotated[tuple[NonNegative, ...], Several, Distinct]
Ratios = Annotated[tuple[Ratio, ...], Several, Distinct]
Factors = Annotated[tuple[Factor, ...], Several, Distinct]


class ExtremesTable(Table):
    """How far the case may be pushed: axes, each with the values at which it is tried."""

    spin: Values | None = Field(default=None, description="size of the initial angular velocity, rad/s")
    timestep: Values | None = Field(default=None, description="s; with spin, every spin is tried with every step")
    steps: Values | None = Field(default=None, description="how many steps of 2 ms the run takes")
    moment_ratio: Ratios | None = Field(default=None, description="C / (A + B), stretched along K: 1 a disc, 0 a needle")
    mass: Values | None = Field(default=None, description="kg, the moments in proportion")
    size: Factors | None = Field(default=None, description="factor of all lengths of the body at its density")
    distance: Values | None = Field(default=None, description="how far the start is moved from the origin, along x, m")
    gravity: NonNegativeValues | None = Field(default=None, description="m/s^2")
    friction: NonNegativeValues | None = Field(default=None, description="Coulomb's coefficient of the plane")
    speed: Values | None = Field(default=None, description="size of the initial velocity, m/s")
    separatrix: Ratios | None = Field(default=None, description="wobble of a spin about the middle axis, relative to it")


class CaseTable(Table):
    """A whole case file."""

    format: Literal[1] = Field(description="of the file")
    name: Name = Field(description="unique among the cases of a run")
    title: Text = Field(description="what it is, in a few words")
    source: Text = Field(default="", description="where it comes from")
    tags: Annotated[tuple[Label, ...], Field(max_length=MOST_TAGS)] = Field(default=(), description="to group cases by")
    body: AnyBody = Field(description="what moves")
    initial: InitialTable = InitialTable()
    scene: SceneTable = SceneTable()
    run: RunTable
    extremes: ExtremesTable = ExtremesTable()
    expect: Annotated[tuple[ExpectTable, ...], Field(max_length=MOST_EXPECTATIONS)] = Field(
        default=(), description="what must hold, a table a method"
    )


TABLES: dict[Path, type[Table]] = {
    (): CaseTable,
    ("body", "particles"): ParticleTable,
    ("body", "parts"): PartTable,
    ("initial",): InitialTable,
    ("scene",): SceneTable,
    ("scene", "plane"): PlaneTable,
    ("scene", "drag"): DragTable,
    ("run",): RunTable,
    ("extremes",): ExtremesTable,
    ("expect",): ExpectTable,
    **{("expect", name): RangeTable for name in LIMITS},
}


def shape_of(body: Any) -> str:
    """The shape of a body or part where it is a word, else none: what else it may be is another fault."""
    shape = body.get("shape") if isinstance(body, dict) else None
    return shape if isinstance(shape, str) else ""


def table_at(path: Path, document: dict[str, Any]) -> type[Table] | None:
    """The grammar of the table at a path of a document; None where there is no table."""
    if path == ("body",):
        return SHAPE_TABLES.get(shape_of(with_shape(document.get("body"))))
    return TABLES.get(tuple(key for key in path if isinstance(key, str)))
