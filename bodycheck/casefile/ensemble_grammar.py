"""The grammar of the table `[ensemble]` of case files: the number of members, and the distributions for drawing them."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from bodycheck.casefile.values import (
    MAX_CHOICES,
    MAX_MEMBERS,
    MAX_SEED,
    MAX_VARIATIONS,
    Label,
    NonNegative,
    Number,
    Positive,
    Table,
)

#: The largest number of components of a vector that can be drawn: four, for a quaternion.
MAX_COMPONENTS = 4


def _form(value: Any) -> str:
    return "numbers" if isinstance(value, list | tuple) else "number"


Several = Field(min_length=1, max_length=MAX_COMPONENTS)
AnyNumber = Annotated[
    Annotated[Number, Tag("number")] | Annotated[tuple[Number, ...], Several, Tag("numbers")], Discriminator(_form)
]
AnyPositive = Annotated[
    Annotated[Positive, Tag("number")] | Annotated[tuple[Positive, ...], Several, Tag("numbers")], Discriminator(_form)
]
AnyNonNegative = Annotated[
    Annotated[NonNegative, Tag("number")] | Annotated[tuple[NonNegative, ...], Several, Tag("numbers")], Discriminator(_form)
]

#: The names that pydantic adds to the path of a fault for the members of the unions above.
FORMS = ("number", "numbers")

#: The description of every parameter that may be a number or a vector.
EACH = "one number, or one for each component"


class VariationTable(Table):
    """The keys of every distribution of a number or vector."""

    key: Label = Field(
        description="path of the number or vector in this file, e.g. initial.angular_velocity or body.semi_axes.0"
    )


class UniformTable(VariationTable):
    """The same probability everywhere between two limits, each component independently."""

    distribution: Literal["uniform"]
    low: AnyNumber = Field(description=f"lower limit; {EACH}")
    high: AnyNumber = Field(description=f"upper limit; {EACH}")


class LogUniformTable(VariationTable):
    """A logarithm with the same probability everywhere between those of two limits, each component independently."""

    distribution: Literal["log-uniform"]
    low: AnyPositive = Field(description=f"lower limit; {EACH}")
    high: AnyPositive = Field(description=f"upper limit; {EACH}")


class NormalTable(VariationTable):
    """The normal distribution, each component independently."""

    distribution: Literal["normal"]
    mean: AnyNumber = Field(description=EACH)
    standard_deviation: AnyNonNegative = Field(description=EACH)


class OnSphereTable(VariationTable):
    """A vector of three components, uniformly on the surface of a sphere about 0."""

    distribution: Literal["sphere"]
    radius: Positive = Field(description="length of the vector")


class AttitudeTable(Table):
    """The initial attitude, uniformly over all rotations."""

    distribution: Literal["attitude"]


class ChoiceTable(VariationTable):
    """One of some values, each with the same probability."""

    distribution: Literal["choice"]
    values: Annotated[tuple[AnyNumber, ...], Field(min_length=1, max_length=MAX_CHOICES)] = Field(
        description="numbers or vectors; one that stands twice is drawn twice as often"
    )


DISTRIBUTIONS: dict[str, type[Table]] = {
    "uniform": UniformTable,
    "log-uniform": LogUniformTable,
    "normal": NormalTable,
    "sphere": OnSphereTable,
    "attitude": AttitudeTable,
    "choice": ChoiceTable,
}

AnyVariation = Annotated[
    UniformTable | LogUniformTable | NormalTable | OnSphereTable | AttitudeTable | ChoiceTable,
    Field(discriminator="distribution"),
]


class EnsembleTable(Table):
    """Many cases drawn from this one, for `bodycheck ensemble`."""

    members: Annotated[int, Field(strict=True, ge=1, le=MAX_MEMBERS)] = Field(description="how many")
    seed: Annotated[int, Field(strict=True, ge=0, le=MAX_SEED)] = Field(
        default=0, description="of the random numbers; the same seed draws the same members"
    )
    vary: Annotated[tuple[AnyVariation, ...], Field(min_length=1, max_length=MAX_VARIATIONS)] = Field(
        description="what differs between them, a table a key"
    )


def distribution_of(variation: Any) -> str:
    """Return the name of the distribution of a raw table, or an empty text if it is invalid; the grammar reports that."""
    name = variation.get("distribution") if isinstance(variation, dict) else None
    return name if isinstance(name, str) else ""
