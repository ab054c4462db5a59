"""The rows of the study of heights."""

from dataclasses import dataclass
from typing import Annotated

from bodycheck.results.tables import RUN, Meaning, table_of

#: The file with the records of the study.
RECORDS = "last_height.jsonl"


@dataclass(frozen=True)
class Row:
    """The height of a body at the end of a run."""

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    height: Annotated[float | None, Meaning("Height", "height at the end; empty if the run failed", "m", signed=True)]


HEIGHTS = table_of(Row, "last_height", "heights at the end", key=RUN)

#: The tables of the study.
TABLES = (HEIGHTS,)
