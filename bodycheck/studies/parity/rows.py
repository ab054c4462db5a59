"""The rows of the table of a parity study."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Annotated

from bodycheck.results.tables import Meaning, table_of
from bodycheck.robots.elements import printable
from bodycheck.studies.parity.quantities import FAILED, FILE, Cause, Quantity, Source, Status

#: The most characters of a text in a row. Messages of engines and lists of joints repeat the names in a stranger's file.
LONGEST = 1000


@dataclass(frozen=True)
class Compared:
    """A quantity as an engine has it and as the file has it.

    Parameters
    ----------
    status
        The result of the comparison.
    quantity
        The quantity; empty in a row about a file that an engine does not read at all.
    subject
        The name of the body or joint; "model" for the whole.
    engine_value, truth_value
        The numbers or words of both sides. Of a quantity that is compared at states, they are the values with the
        largest difference.
    difference
        The largest difference of a component, in the unit of the quantity; None where there are no numbers.
    relative
        The difference relative to the size of the quantity, which the tolerance limits; None where there are no numbers.
    cause
        Why it differs.
    convention
        The convention in which the engine writes the quantity, if that differs from bodycheck's.
    source
        The origin of the engine's value.
    """

    status: Status
    quantity: Quantity | None
    subject: str
    engine_value: str = ""
    truth_value: str = ""
    difference: float | None = None
    relative: float | None = None
    cause: Cause = ""
    convention: str = ""
    source: Source = ""


@dataclass(frozen=True)
class ParityRow:
    """A row of parity.csv: what was compared, with the model and the engine; see `Compared`.

    The engine of a row about the file itself is "file".
    """

    model: Annotated[str, Meaning("Model", "file of the robot")]
    engine: str
    version: str
    status: Annotated[Status, Meaning("Status", "what came of the comparison with the file")]
    quantity: Annotated[
        Quantity | None,
        Meaning("Quantity", "what the numbers of the row are of; empty for a file that an engine does not read at all"),
    ]
    subject: Annotated[str, Meaning("Subject", "body or joint; model for the whole")]
    engine_value: Annotated[str, Meaning("Engine", "numbers or words of the engine, at the state with the largest difference")]
    truth_value: Annotated[str, Meaning("File", "numbers or words of the file, at the same state")]
    difference: Annotated[
        float | None,
        Meaning("Difference", "largest difference of a component, in the unit of the quantity; empty if it is not finite"),
    ]
    relative: Annotated[
        float | None,
        Meaning("Relative difference", "difference relative to the size of the quantity; empty if it is not finite"),
    ]
    cause: Annotated[Cause, Meaning("Cause", "why it differs; empty where it does not")]
    convention: Annotated[
        str,
        Meaning(
            "Convention",
            "convention in which the engine writes the quantity, which is decided at states that are not compared; empty if it "
            "is that of bodycheck",
        ),
    ] = ""
    source: Annotated[
        Source,
        Meaning(
            "Source",
            "behaviour: the engine computes the value, or moves accordingly; told: it is in the engine's records of the model, "
            "and was not tried",
        ),
    ] = ""


READINGS = table_of(
    ParityRow,
    "parity",
    "readings of robot models",
    filled=("model", "engine", "status", "subject"),
    later=("convention", "source"),
)

#: The tables of the study.
TABLES = (READINGS,)


def comparisons(rows: Iterable[ParityRow]) -> Iterator[dict[str, str]]:
    """Yield for each row of an engine its engine, its status, "ok" if it compares a quantity, and the words of the engine."""
    for one in rows:
        if one.engine != FILE:
            yield {"engine": one.engine, "status": "ok" if is_compared(one) else one.status, "reason": one.engine_value}


def is_compared(one: ParityRow) -> bool:
    """Return whether a row compares a quantity of an engine with the file, so that it could have differed."""
    always_agrees = one.quantity == "order" or (one.quantity == "gravity" and not one.truth_value)
    return one.status in ("agrees", "differs", "accepted-unphysical") and one.quantity is not None and not always_agrees


def row(model: str, engine: str, version: str, compared: Compared) -> ParityRow:
    """Return a row of the table, in which names of bodies and joints and texts of engines are made printable and shortened.

    Differences that are not finite are left out; the values of both sides show why.
    """
    shown = replace(
        compared,
        subject=_shown(compared.subject),
        engine_value=_shown(compared.engine_value),
        truth_value=_shown(compared.truth_value),
        difference=_finite(compared.difference),
        relative=_finite(compared.relative),
    )
    return ParityRow(_shown(model), engine, version, **asdict(shown))


def failed(one: ParityRow | Compared) -> bool:
    """Return whether a row says that something differs, is refused, or could not be read or compared."""
    return one.status in FAILED


def _finite(difference: float | None) -> float | None:
    return difference if difference is not None and math.isfinite(difference) else None


def _shown(text: str) -> str:
    whole = printable(text)
    return whole if len(whole) <= LONGEST else f"{whole[: LONGEST - 1]}…"
