"""The laws of controllers with a rate: the effort is computed at each instant from the state, and held.

The numbers are floats, or numbers of a hundred digits.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from bodycheck.reference.exact.numbers import Real, real
from bodycheck.reference.mechanisms.control import SLACK, Controller, Samples, Signal
from bodycheck.reference.mechanisms.hybrid.signals import value


@dataclass(frozen=True)
class Memory:
    """The memory of a controller with a rate.

    Attributes
    ----------
    count
        The number of instants at which it has computed its law.
    total
        The sum of the errors at these instants (rad or m).
    waiting
        The efforts that were computed and do not act yet, in the order in which they will act.
    acting
        The effort that acts (N m or N).
    """

    count: int = 0
    total: Any = 0.0
    waiting: tuple[Any, ...] = ()
    acting: Any = 0.0


def signals_at(controller: Controller, time: Real) -> tuple[Real, Real, Real]:
    """Return the target, its velocity and the effort of a controller at one of its instants (s), in exact arithmetic."""
    assert controller.rate is not None, "a continuous law has no instants"
    reached = time + real(SLACK / Fraction(controller.rate))

    def at_instant(signal: Signal) -> Real:
        held = isinstance(signal, Samples) and signal.between == "hold"
        return value(signal, reached if held else time)

    return at_instant(controller.target), at_instant(controller.target_velocity), at_instant(controller.effort)


def computed(controller: Controller, memory: Memory, given: tuple[Any, Any, Any], q: Any, v: Any) -> Memory:
    """Return what a controller remembers after an instant.

    given: the values of its signals at this instant. q, v: the coordinate and the velocity of its joint there.
    """
    assert controller.rate is not None, "a continuous law has no instants"
    target, target_velocity, effort = given
    error = target - q
    total = memory.total + error
    wanted = controller.kp * error + controller.kd * (target_velocity - v) + controller.ki * (total / controller.rate) + effort
    waiting = (*memory.waiting, saturated(controller, wanted, v))
    if len(waiting) <= controller.delay:
        return Memory(memory.count + 1, total, waiting, memory.acting)
    return Memory(memory.count + 1, total, waiting[1:], waiting[0])


def saturated(controller: Controller, effort: Any, v: Any) -> Any:
    """Return an effort within what a controller can exert at a velocity of its joint."""
    if controller.effort_limit is None:
        return effort
    along = 1 if v > 0 else -1
    limit = against = controller.effort_limit
    if controller.no_load_speed is not None:
        limit = against * max(0, 1 - abs(v) / controller.no_load_speed)
    highest, lowest = (limit, -against) if along > 0 else (against, -limit)
    return min(max(effort, lowest), highest)
