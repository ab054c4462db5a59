"""The rows of classes.csv: which methods are the same algorithm."""

from dataclasses import asdict, dataclass
from typing import Any

from bodycheck.adapters.contract import Kind

#: The columns of classes.csv.
COLUMNS = ("kind", "class", "scheme", "engine", "version", "integrator", "distance", "scene_timestep")


@dataclass(frozen=True)
class ClassRow:
    """A method, and the class that it is in on scenes of one kind.

    Parameters
    ----------
    kind
        The kind of the scenes.
    name
        The name of the class: its scheme, or "not identified" with a number. No other class of the kind has it.
    scheme
        The textbook scheme with which the class agrees; empty if there is none.
    engine, version, integrator
        The method.
    distance
        The largest difference of the motions of two methods in the class; see `judging.classes.MethodClass`.
    scene_timestep
        The time step (s) of the scenes.
    """

    kind: Kind
    name: str
    scheme: str
    engine: str
    version: str
    integrator: str
    distance: float
    scene_timestep: float

    @property
    def record(self) -> dict[str, Any]:
        """The row by the columns of classes.csv."""
        return {("class" if name == "name" else name): value for name, value in asdict(self).items()}


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
