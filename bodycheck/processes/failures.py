"""The outcomes of a failed call in a worker process: it crashed, or it exceeded its time limit."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from bodycheck.processes.limits import shortage


@dataclass(frozen=True)
class Crashed:
    """The engine raised an error or its process died."""

    reason: str
    status: ClassVar[Literal["crashed"]] = "crashed"
    failed: ClassVar[bool] = True


@dataclass(frozen=True)
class TimedOut:
    """The run, or the computation of its truth, was stopped at its time limit (s), as the default reason says."""

    limit: float
    reason: str = ""
    status: ClassVar[Literal["timeout"]] = "timeout"
    failed: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not self.reason:
            object.__setattr__(self, "reason", f"stopped after {self.limit:g} s")


def crash(error: BaseException) -> Crashed:
    """Return the outcome for an exception of an engine, with its message as valid UTF-8."""
    text = f"{shortage()}: {error}" if isinstance(error, MemoryError) else f"{type(error).__name__}: {error}"
    return Crashed(text.removesuffix(": ").encode("utf-8", "backslashreplace").decode("utf-8"))
