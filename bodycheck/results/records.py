"""The required contents of the records of saved results.

Records are checked when they are read, because a folder may come from anyone.
"""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Annotated, Any, Literal, TypeVar, cast

from pydantic import AfterValidator, Field, TypeAdapter, ValidationError

from bodycheck.adapters.contract import Efforts
from bodycheck.adapters.method import Method, current
from bodycheck.casefile.values import EngineName, Finite, Name
from bodycheck.errors import BadInput
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.contact.motion import EventKind
from bodycheck.results.outcome import Completed, Diverged, Unsupported

T = TypeVar("T")

#: The statuses of runs that measured nothing, because their process died or exceeded a limit.
LOST = (Crashed.status, TimedOut.status)


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError("should be printable, on one line")
    return text


def _spelling(text: str) -> str:
    try:
        Method.parse(current(text), 0.0)
    except BadInput as error:
        raise ValueError(str(error)) from error
    return text


Printable = Annotated[str, Field(strict=True), AfterValidator(_printable)]
Spelling = Annotated[Printable, AfterValidator(_spelling)]
Timestep = Annotated[Finite, Field(gt=0)]
Duration = Annotated[Finite, Field(ge=0)]
Count = Annotated[int, Field(strict=True, ge=0)]
#: The index of a body, or -1 for the world.
Place = Annotated[int, Field(strict=True, ge=-1)]


@dataclass(frozen=True)
class HeaderRecord:
    """The origin of results, which every report states; see `bodycheck.results.header`."""

    bodycheck: Printable
    command: list[str]
    started: Printable
    machine: dict[str, Printable]
    packages: dict[str, Printable]
    engines: dict[str, Printable]
    missing: dict[str, str]
    environments: dict[Printable, dict[Printable, Printable]] = field(default_factory=dict)
    demonstrations: dict[Printable, dict[Printable, Printable]] = field(default_factory=dict)
    precisions: dict[Printable, Literal["float64", "float32"]] = field(default_factory=dict)
    defaults: dict[Printable, dict[Printable, Printable]] = field(default_factory=dict)
    soft: dict[Printable, dict[Printable, Printable]] = field(default_factory=dict)
    without_method: dict[Printable, dict[Name, Printable]] = field(default_factory=dict)
    robots: dict[Name, list[Printable]] = field(default_factory=dict)
    departures: dict[Name, Duration] = field(default_factory=dict)


@dataclass(frozen=True)
class CaseRecord:
    """A case in the header."""

    name: Name
    text: str
    file: Printable = ""
    packages: list[Printable] = field(default_factory=list)


@dataclass(frozen=True)
class UncheckedRecord:
    """An expectation in the header that no run could check."""

    case: Name
    engine: EngineName
    integrator: Spelling
    timestep: Timestep
    reason: str
    tolerated: Printable


@dataclass(frozen=True)
class CasesRecord:
    """The cases in the header, and their expectations that no run could check."""

    cases: list[CaseRecord]
    unchecked: list[UncheckedRecord] = field(default_factory=list)


@dataclass(frozen=True)
class RevisionsRecord:
    """The revisions of the figures in a journal whose definition had ever changed. Earlier versions stored none."""

    revisions: dict[Printable, int] = field(default_factory=dict)


@dataclass(frozen=True)
class LawRecord:
    """A plane with a law of friction."""

    friction: Duration
    law: Literal["area", "corners", "decoupled"]
    pressure: Literal["uniform", "balanced"]


@dataclass(frozen=True)
class StopRecord:
    """The position and the time at which a body stops."""

    time: Duration
    position: tuple[Finite, Finite, Finite]
    yaw: Finite


@dataclass(frozen=True)
class LoadRecord:
    """The load of the contact."""

    mean_load: float
    peak_load: float
    time_in_contact: float


@dataclass(frozen=True)
class EventRecord:
    """An event of bodies in contact. Values of the state after it that mechanics does not determine are null."""

    kind: EventKind
    time: Duration
    error: Duration
    body: Count
    position: tuple[Finite | None, Finite | None, Finite | None]
    velocity: tuple[Finite | None, Finite | None, Finite | None]
    spin: tuple[Finite | None, Finite | None, Finite | None]
    normal_speed: Finite


@dataclass(frozen=True)
class InterfaceRecord:
    """The load between two bodies at rest."""

    bodies: tuple[Place, Place]
    load: Finite


@dataclass(frozen=True)
class BorneRecord(InterfaceRecord):
    """The load between two bodies in a run."""

    losses: Count


@dataclass(frozen=True)
class TruthRecord:
    """The truth of a case for a sampling; see `bodycheck.adapters.method.Method.sampling`."""

    case: Name
    timestep: Duration
    model: Printable
    why: str
    backend: Printable
    witnesses: list[str]
    stop: StopRecord | None = None
    events: list[EventRecord] = field(default_factory=list)
    friction: Duration = 0.0
    interfaces: list[InterfaceRecord] = field(default_factory=list)


@dataclass(frozen=True)
class NoTruthRecord:
    """The reason why there is no truth of a case for a sampling."""

    case: Name
    timestep: Duration
    reason: str
    limit: Duration | None = None
    crashed: bool = False


@dataclass(frozen=True)
class RunRecord:
    """A run with any outcome."""

    place: Count
    case: Name
    engine: EngineName
    version: Printable
    integrator: Spelling
    timestep: Timestep
    status: str
    contact_law: LawRecord | None
    role: Literal["", "default", "recommended", "default, recommended"] | None = field(default=None, kw_only=True)


@dataclass(frozen=True)
class CompletedRecord(RunRecord):
    """A completed run."""

    steps: Count
    wall_time: Duration
    load: LoadRecord | None
    quaternion_norm_error: Duration | None = None
    interfaces: list[BorneRecord] | None = None
    rejected: Count | None = None
    evaluations: Count | None = None
    efforts: Efforts = ""
    contact_terms: str = ""
    #: Why the engine does not read each sensor; empty if it does.
    sensors: list[str] | None = None


@dataclass(frozen=True)
class TimedOutRecord(RunRecord):
    """A run that was stopped."""

    limit: Duration


@dataclass(frozen=True)
class FailedRecord(RunRecord):
    """A run that ended in any other way."""

    reason: str


@dataclass(frozen=True)
class StoppedRecord:
    """The stop of the body of a case under a law of friction."""

    case: Name
    law: LawRecord
    stop: StopRecord | None


#: The required contents of the record of a run, by the status of the run.
RUNS: dict[str, type[RunRecord]] = {
    Completed.status: CompletedRecord,
    TimedOut.status: TimedOutRecord,
    **dict.fromkeys((Unsupported.status, Diverged.status, Crashed.status), FailedRecord),
}


def is_lost(record: Mapping[str, Any]) -> bool:
    """Return whether a record says that a process crashed or exceeded a limit, so that nothing was measured.

    This is a run, a truth or a stop of a results folder, or a record of a study that has a status.
    """
    limited = record.get("limit") is not None or record.get("crashed", False)
    return limited or record.get("status") in LOST or (record.get("record") == "stop" and "reason" in record)


def typed(kind: type[T], values: Any) -> T:
    """Return an instance of a dataclass with the values of a JSON object. Raises `ValueError` that names invalid values."""
    try:
        instance: T = _adapter(cast(Hashable, kind)).validate_python(values)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        names = [repr(name) for name in fault["loc"]]
        read = "" if fault["type"] == "missing" else f", read {fault['input']!r:.60}"
        raise ValueError(f"{', '.join(names) or 'a record'}: {fault['msg']}{read}") from error
    return instance


def check(record: dict[str, Any]) -> None:
    """Raise `ValueError` unless a record of a truth, a run or a stop has the required contents."""
    match record.get("record"):
        case "truth":
            typed(NoTruthRecord if "reason" in record else TruthRecord, record)
        case "run":
            if (kind := RUNS.get(str(record.get("status")))) is None:
                raise ValueError(f"the status {str(record.get('status'))!r} of a run; allowed: {', '.join(RUNS)}")
            typed(kind, record)
        case "stop":
            typed(StoppedRecord, record)
        case other:
            raise ValueError(f"a record of the unknown kind {other!r:.60}")


@cache
def _adapter(kind: Hashable) -> TypeAdapter[Any]:
    return TypeAdapter(cast(Any, kind))
