"""Controllers of joints, and the stops at which joints end: what a case says of them.

A controller gives the joint an effort along its coordinate, in addition to the effort of the joint itself. With the coordinate
q, its velocity v, and the error e = target - q, the law "pd" is

    kp e + kd (target_velocity - v) + ki (integral of e) + effort,

and the law "effort" is the effort alone. The result is saturated: in the direction of v it is cut to effort_limit
max(0, 1 - |v| / no_load_speed), against it to effort_limit; without `no_load_speed` to effort_limit in both directions.

A controller with a rate computes the law and its saturation at the instants k / rate, k = 0, 1, ..., from the state of that
instant; the integral is the sum of e over the instants so far, the present one included, divided by the rate. The result acts
from (k + delay) / rate until (k + 1 + delay) / rate. Before delay / rate the controller exerts nothing.

At such an instant a time of a table with held values counts as reached if it is later by at most `SLACK` of a period: at 500 Hz
the value of 0.1 s holds from the instant 50 / 500 on, although the double nearest to 0.1 is larger.

A stop is where the coordinate leaves the interval from `lower` to `upper`. A rigid stop is an impact, which reverses the
velocity and multiplies it by the restitution; without rebound the joint stays at the stop until its force changes sign. An
elastic stop, with x beyond the stop, pushes back with max(0, stiffness x + damping x') while x > 0.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

#: The part of a period within which an instant of a controller, and a step or a time of a table, count as the same.
SLACK = Fraction(1, 10**9)


@dataclass(frozen=True)
class Sine:
    """The signal offset + amplitude sin(angular_frequency t + phase). Units: of the signal, rad/s and rad."""

    amplitude: float
    angular_frequency: float
    phase: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True)
class Samples:
    """A signal that is given at ascending times (s), with the first and the last value outside of them.

    Between two times it is the value at the earlier one ("hold"), or changes linearly ("linear").
    """

    times: tuple[float, ...]
    values: tuple[float, ...]
    between: Literal["hold", "linear"] = "hold"


#: A quantity of a controller over time: a number is constant.
Signal = float | Sine | Samples


@dataclass(frozen=True)
class Controller:
    """The controller of a revolute or prismatic joint: see the docstring of the module.

    Attributes
    ----------
    joint
        The index of the joint in `Mechanism.joints`; no other controller has it.
    law
        "pd", or "effort" for feed-forward alone, whose gains are zero.
    kp, kd, ki
        The gains (N m/rad, N m s/rad and N m/(rad s) of a revolute joint; N/m, N s/m and N/(m s) of a prismatic one).
    target, target_velocity, effort
        The signals (rad or m; rad/s or m/s; N m or N).
    rate
        The number of instants a second (Hz); None for a continuous law.
    delay
        The number of periods from an instant until its result acts; 0 without a rate.
    effort_limit
        The largest effort (N m or N); None for no limit. With a no-load speed it is the stall effort.
    no_load_speed
        The speed at which the effort in the direction of motion is zero (rad/s or m/s); None for no such line.
    """

    joint: int
    law: Literal["pd", "effort"] = "pd"
    kp: float = 0.0
    kd: float = 0.0
    ki: float = 0.0
    target: Signal = 0.0
    target_velocity: Signal = 0.0
    effort: Signal = 0.0
    rate: float | None = None
    delay: int = 0
    effort_limit: float | None = None
    no_load_speed: float | None = None


@dataclass(frozen=True)
class Stops:
    """The stops of a revolute or prismatic joint: rigid ones have a restitution, elastic ones a stiffness.

    Attributes
    ----------
    lower, upper
        The smallest and the largest coordinate (rad or m); None where the joint has no stop.
    restitution
        The speed after an impact divided by the speed before it, from 0 to 1; None for elastic stops.
    stiffness, damping
        The coefficients of elastic stops (N m/rad and N m s/rad, or N/m and N s/m); zero for rigid ones.
    """

    lower: float | None
    upper: float | None
    restitution: float | None = 0.0
    stiffness: float = 0.0
    damping: float = 0.0

    @property
    def rigid(self) -> bool:
        """True if the stops are rigid."""
        return self.restitution is not None
