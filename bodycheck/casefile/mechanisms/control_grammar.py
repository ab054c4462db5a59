"""The grammar of controllers and stops of joints in case files of format 2."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from bodycheck.casefile.values import Label, NonNegative, Number, Positive, Table

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


def _kind_of_signal(value: Any) -> str:
    if not isinstance(value, dict):
        return "number"
    return "sine" if "amplitude" in value or "angular_frequency" in value else "samples"


AnySignal = Annotated[
    Annotated[Number, Tag("number")] | Annotated[SineTable, Tag("sine")] | Annotated[SamplesTable, Tag("samples")],
    Discriminator(_kind_of_signal),
]


class ControllerTable(Table):
    """The controller of a revolute or prismatic joint."""

    joint: Label = Field(description="name of the joint, which has no other controller")
    law: Literal["pd", "effort"] = Field(description="pd, or effort: feed-forward alone")
    kp: NonNegative = Field(default=0.0, description="on target - coordinate, N m/rad or N/m")
    kd: NonNegative = Field(default=0.0, description="on target_velocity - velocity, N m s/rad or N s/m")
    ki: NonNegative = Field(default=0.0, description="on the integral of target - coordinate, N m/(rad s) or N/(m s)")
    target: AnySignal = Field(default=0.0, description="rad or m: a number, a sine, or values at times")
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
