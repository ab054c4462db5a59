"""The rows of classes.csv: which methods are the same algorithm."""

from dataclasses import dataclass
from typing import Annotated

from bodycheck.adapters.contract import Kind
from bodycheck.results.tables import Meaning, table_of


@dataclass(frozen=True)
class ClassRow:
    """A method, and the class that it is in on scenes of one kind."""

    kind: Annotated[Kind, Meaning("Kind", "kind of the scenes")]
    name: Annotated[
        str,
        Meaning(
            "Class",
            'name of the class: its scheme, or "not identified" with a number; no other class of the kind has it',
            column="class",
        ),
    ]
    scheme: Annotated[str, Meaning("Scheme", "textbook scheme with which the class agrees; empty if there is none")]
    engine: str
    version: str
    integrator: str
    distance: Annotated[
        float, Meaning("Distance", "largest difference of the motions of two methods in the class, relative to their size")
    ]
    scene_timestep: Annotated[float, Meaning("Time step", "time step of the scenes", "s")]


#: The table of classes.
CLASSES = table_of(ClassRow, "classes", "methods that are the same algorithm", key=("kind", "engine", "integrator"))


@dataclass(frozen=True)
class Unclassed:
    """A method that is in no class of a kind of scene, because a run of it failed or was refused, and why."""

    kind: Kind
    engine: str
    integrator: str
    reason: str


@dataclass(frozen=True)
class Classes:
    """The classes of methods: the rows class by class, the largest first, and the methods that are in none."""

    rows: tuple[ClassRow, ...]
    unclassed: tuple[Unclassed, ...]
