"""How a run ended: a closed family of frozen types that answer the same questions."""

from dataclasses import dataclass, field
from typing import ClassVar, Literal

from bodycheck.adapters.contract import Method
from bodycheck.figures.definition import Load
from bodycheck.reference.scene import Plane
from bodycheck.reference.trajectory import Trajectory
from bodycheck.running.key import RunKey
from bodycheck.running.limits import shortage


@dataclass(frozen=True, eq=False)
class Completed:
    """The engine stepped to the end. steps taken, and the wall time of stepping alone (s)."""

    trajectory: Trajectory
    steps: int
    wall_time: float
    load: Load | None = None
    status: ClassVar[str] = "ok"
    failed: ClassVar[bool] = False
    reason: ClassVar[str] = ""


@dataclass(frozen=True)
class Unsupported:
    """The engine, or the truth, cannot model what the scene requires."""

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
