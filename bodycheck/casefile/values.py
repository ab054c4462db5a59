"""Kinds of values in case files: numbers, texts and arrays with the bounds that the grammar sets."""

from typing import Annotated

from pydantic import AfterValidator, Field

from bodycheck.adapters.method import Method
from bodycheck.errors import BadInput

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
