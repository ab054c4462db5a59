"""Types of the values in case files: numbers, texts, arrays and tables, with the limits that the grammar sets."""

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from bodycheck.adapters.engine_name import EngineName as NameOfEngine
from bodycheck.adapters.method import Method
from bodycheck.adapters.roles import alias
from bodycheck.errors import BadInput

#: Limits of the numbers, texts and arrays of a case file.
MAX_SAMPLES = 100_001
MAX_PARTS = 1000
MAX_NAME_LENGTH = 100
MAX_TEXT_LENGTH = 1000
MAX_NOTICE_LENGTH = 2000
MAX_TAGS = 50
MAX_PUSHES = 50
MAX_CONTACTS = 1000
MAX_SENSORS = 100
MAX_EXPECTATIONS = 1000
#: The largest number of instants of the truth, over all time steps that the expectations of a file need: each takes 20 to 100
#: us.
MAX_INSTANTS = 50 * MAX_SAMPLES
MAX_VALUES = 50
MAX_POINTS = 500
#: Limits of ensembles: the number of members, the seed of random numbers, the number of keys that vary, and of values of a
#: choice.
MAX_MEMBERS = 10**9
MAX_SEED = 2**63 - 1
MAX_VARIATIONS = 50
MAX_CHOICES = 1000
#: Largest absolute value of a number. Its inverse is the smallest except 0, so that squares and products do not overflow.
MAX_NUMBER = 1e100


class Table(BaseModel):
    """A table that allows no unknown keys."""

    # Models are built when the first document is checked: most worker processes never check any.
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


def _not_vanishing(value: float) -> float:
    if 0 < abs(value) < 1 / MAX_NUMBER:
        raise ValueError(f"should be 0, or at least {1 / MAX_NUMBER:g} in size")
    return value


def _printable(value: str) -> str:
    if not value.isprintable():
        raise ValueError("should be printable, on one line")
    return value


def _spelling(value: str) -> str:
    if alias(value) is not None:
        raise ValueError(
            f"{value!r} stands for another method in each engine; allowed: the spelling and the time step of the method, which "
            "`bodycheck engines` lists"
        )
    try:
        Method.parse(value, 0.0)
    except BadInput as error:
        raise ValueError(str(error)) from error
    return value


def _engine(value: str) -> str:
    try:
        return str(NameOfEngine.parse(value))
    except BadInput as error:
        raise ValueError(str(error)) from error


Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Number = Annotated[Finite, Field(ge=-MAX_NUMBER, le=MAX_NUMBER), AfterValidator(_not_vanishing)]
Positive = Annotated[Finite, Field(gt=0, le=MAX_NUMBER), AfterValidator(_not_vanishing)]
NonNegative = Annotated[Finite, Field(ge=0, le=MAX_NUMBER), AfterValidator(_not_vanishing)]
Ratio = Annotated[Finite, Field(ge=1e-20, le=1)]
Factor = Annotated[Finite, Field(ge=1e-10, le=1e10)]
Text = Annotated[str, Field(strict=True, max_length=MAX_TEXT_LENGTH), AfterValidator(_printable)]
#: A sentence on a robot model.
Notice = Annotated[str, Field(strict=True, max_length=MAX_NOTICE_LENGTH), AfterValidator(_printable)]
#: The patterns of names of cases, and of digests.
NAME, DIGEST = r"^[a-z0-9-]+$", r"^[0-9a-f]{64}$"
#: What each of these patterns allows, in words.
CHARACTERS = {NAME: "small letters, digits and hyphens", DIGEST: "64 digits from 0 to 9 and a to f"}
Name = Annotated[str, Field(strict=True, pattern=NAME, max_length=MAX_NAME_LENGTH)]
Label = Annotated[str, Field(strict=True, min_length=1, max_length=MAX_NAME_LENGTH), AfterValidator(_printable)]
#: The name of a body, in which * stands for any characters.
BodyPattern = Label
Spelling = Annotated[Label, AfterValidator(_spelling)]
EngineName = Annotated[Label, AfterValidator(_engine)]
Vector = tuple[Number, Number, Number]
Quaternion = tuple[Number, Number, Number, Number]
PositiveVector = tuple[Positive, Positive, Positive]


def _distinct(values: tuple[float, ...]) -> tuple[float, ...]:
    if not values:
        raise ValueError("has no values")
    if len(set(values)) < len(values):
        raise ValueError("has a value twice")
    return values


Several, Distinct = Field(max_length=MAX_VALUES), AfterValidator(_distinct)
Values = Annotated[tuple[Positive, ...], Several, Distinct]
NonNegativeValues = Annotated[tuple[NonNegative, ...], Several, Distinct]
Ratios = Annotated[tuple[Ratio, ...], Several, Distinct]
Factors = Annotated[tuple[Factor, ...], Several, Distinct]
