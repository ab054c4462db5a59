"""The grammar of controllers and stops of joints in case files of format 2."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from bodycheck.casefile.values import DIGEST, Label, NonNegative, Number, Positive, Table, Text

#: The largest numbers of values of a signal, and of periods of a delay.
MAX_SIGNAL = 10_000
MAX_DELAY = 1000


class StopsTable(Table):
    """The stops of a joint: rigid ones with a restitution, or elastic ones with a stiffness and a damping."""

    lower: Number | None = Field(default=None, description="smallest coordinate, rad or m")
    upper: Number | None = Field(default=None, description="largest coordinate, rad or m")
    restitution: Annotated[NonNegative, Field(le=1)] | None = Field(
        default=None, description="of rigid stops, from 0 to 1; default 0 without stiffness"
    )
    stiffness: Positive | None = Field(default=None, description="of elastic stops, N m/rad or N/m")
    damping: NonNegative | None = Field(default=None, description="of elastic stops, N m s/rad or N s/m; default 0")


class SineTable(Table):
    """A signal that is a sine: offset + amplitude sin(angular_frequency t + phase)."""

    amplitude: Number = Field(description="in the unit of the signal")
    angular_frequency: Number = Field(description="rad/s")
    phase: Number = Field(default=0.0, description="rad")
    offset: Number = Field(default=0.0, description="in the unit of the signal")


class SamplesTable(Table):
    """A signal by its values at some times; outside of these times it has the first and the last value."""

    times: Annotated[tuple[Number, ...], Field(min_length=1, max_length=MAX_SIGNAL)] = Field(description="ascending, s")
    values: Annotated[tuple[Number, ...], Field(min_length=1, max_length=MAX_SIGNAL)] = Field(description="a value a time")
    between: Literal["hold", "linear"] = Field(default="hold", description="of the times: the value before, or linear")


class FileSignalTable(Table):
    """A signal by a column of a CSV file, whose first column `t` has the times."""

    file: Text = Field(description="CSV, in the folder of the case file or below it")
    column: Text = Field(description="heading of the column with the values")
    between: Literal["hold", "linear"] = Field(default="hold", description="of the times: the value before, or linear")


#: The kinds of signals that are tables, by the tag of the kind, and the keys of which one shows a kind.
SIGNAL_TABLES: dict[str, type[Table]] = {"sine": SineTable, "samples": SamplesTable, "file": FileSignalTable}
SHOWING = {"sine": ("amplitude", "angular_frequency"), "samples": ("times", "values"), "file": ("file", "column")}

#: The keys of a controller that are signals.
SIGNALS = ("target", "target_velocity", "effort")


def kind_of_signal(value: Any) -> str | None:
    """Return the tag of the kind of a signal; None for a table without a key that shows its kind."""
    if not isinstance(value, dict):
        return "number"
    return next((kind for kind, keys in SHOWING.items() if any(key in value for key in keys)), None)


AnySignal = Annotated[
    Annotated[Number, Tag("number")]
    | Annotated[SineTable, Tag("sine")]
    | Annotated[SamplesTable, Tag("samples")]
    | Annotated[FileSignalTable, Tag("file")],
    Discriminator(kind_of_signal),
]


class ReadSignalTable(Table):
    """A column of a CSV file, as it was read."""

    file: Text = Field(description="its path from the folder of the case file")
    sha256: Annotated[str, Field(strict=True, pattern=DIGEST)] = Field(description="digest of its content")
    column: Text = Field(description="heading of the column")
    times: Annotated[tuple[Number, ...], Field(min_length=1, max_length=MAX_SIGNAL)] = Field(description="ascending, s")
    values: Annotated[tuple[Number, ...], Field(min_length=1, max_length=MAX_SIGNAL)] = Field(description="a value a time")


class ControllerTable(Table):
    """The controller of a revolute or prismatic joint."""

    joint: Label = Field(description="name of the joint, which has no other controller")
    law: Literal["pd", "effort"] = Field(description="pd, or effort: feed-forward alone")
    kp: NonNegative = Field(default=0.0, description="on target - coordinate, N m/rad or N/m")
    kd: NonNegative = Field(default=0.0, description="on target_velocity - velocity, N m s/rad or N s/m")
    ki: NonNegative = Field(default=0.0, description="on the integral of target - coordinate, N m/(rad s) or N/(m s)")
    target: AnySignal = Field(default=0.0, description="rad or m: a number, a sine, values at times, or a column of a file")
    target_velocity: AnySignal = Field(default=0.0, description="rad/s or m/s, as target")
    effort: AnySignal = Field(default=0.0, description="feed-forward, N m or N, as target")
    rate: Positive | None = Field(default=None, description="of a sampled law, Hz; without it the law is continuous")
    delay: Annotated[int, Field(strict=True, ge=0, le=MAX_DELAY)] = Field(
        default=0, description="periods between computing and acting, with rate"
    )
    effort_limit: NonNegative | None = Field(default=None, description="largest effort in both directions, N m or N")
    no_load_speed: Positive | None = Field(
        default=None, description="at which the effort along the velocity is 0, rad/s or m/s, with effort_limit"
    )
