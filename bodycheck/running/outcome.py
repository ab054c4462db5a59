"""How a run ended: a closed family of frozen types that answer the same questions."""

from dataclasses import dataclass, field
from typing import ClassVar, Literal, Protocol

from bodycheck.adapters.contract import Method
from bodycheck.figures.definition import Load
from bodycheck.reference.scene import Plane
from bodycheck.reference.trajectory import Trajectory
from bodycheck.running.key import RunKey
from bodycheck.running.limits import shortage


class Stored(Protocol):
    """A trajectory that is kept outside memory."""

    def read(self) -> Trajectory:
        """Return the trajectory. Raises `BadFolder` if it cannot be read."""


@dataclass(frozen=True, eq=False)
class Completed:
    """The engine stepped to the end.

    Attributes
    ----------
    states
        The trajectory of a run made in this process, or where that of stored results can be read.
    steps
        Number of steps taken.
    wall_time
        Wall time of stepping alone (s).
    load
        The load of the contact; None in free flight, and where the engine does not report it.
    """

    states: Trajectory | Stored
    steps: int
    wall_time: float
    load: Load | None = None
    status: ClassVar[str] = "ok"
    failed: ClassVar[bool] = False
    reason: ClassVar[str] = ""

    @property
    def trajectory(self) -> Trajectory:
        """The states at the sampled instants; those of stored results are read from disk each time and not kept."""
        return self.states if isinstance(self.states, Trajectory) else self.states.read()


@dataclass(frozen=True)
class Unsupported:
    """The engine cannot model what the scene requires; also the outcome of a run that has no truth to be compared with."""

    reason: str
    status: ClassVar[str] = "unsupported"
    failed: ClassVar[bool] = False


@dataclass(frozen=True)
class Diverged:
    """Not a number, an energy out of all bounds, or a silent reset.

    signal: what the engine itself told of it: nothing, or that it gave up or started over. trajectory: the states until then
    and the first one after it, as far as there are any.
    """

    reason: str
    signal: Literal["none", "gave up", "reset"] = "none"
    trajectory: Trajectory | None = field(default=None, compare=False, repr=False)
    status: ClassVar[str] = "diverged"
    failed: ClassVar[bool] = True


@dataclass(frozen=True)
class Crashed:
    """The engine raised an error or its process died."""

    reason: str
    status: ClassVar[str] = "crashed"
    failed: ClassVar[bool] = True


@dataclass(frozen=True)
class TimedOut:
    """The run was stopped after its time limit (s)."""

    limit: float
    status: ClassVar[str] = "timeout"
    failed: ClassVar[bool] = True
    reason: str = field(init=False, default="")

    def __post_init__(self) -> None:
        object.__setattr__(self, "reason", f"stopped after {self.limit:g} s")


Outcome = Completed | Unsupported | Diverged | Crashed | TimedOut


def crash(error: BaseException) -> Crashed:
    """What an error that an engine raised says, in text that every file can hold."""
    text = f"{shortage()}: {error}" if isinstance(error, MemoryError) else f"{type(error).__name__}: {error}"
    return Crashed(text.removesuffix(": ").encode("utf-8", "backslashreplace").decode("utf-8"))


@dataclass(frozen=True, eq=False)
class Run:
    """One engine x one method x one case, and how it ended.

    contact_law: the friction that the engine's contacts would make on the scene's plane if they were rigid; None without a
    plane, and where it is no law of the reference.
    """

    case: str
    engine: str
    version: str
    method: Method
    outcome: Outcome
    contact_law: Plane | None = None

    @property
    def key(self) -> RunKey:
        """Which run it is."""
        return RunKey(self.case, self.engine, self.method)
