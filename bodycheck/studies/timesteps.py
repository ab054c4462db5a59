"""The ladders at which methods are measured: time steps that suit a case, and accuracies that suit an integrator."""

import math
from fractions import Fraction
from functools import reduce
from itertools import count

import numpy as np

from bodycheck.casefile.content import Case
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism

#: The largest time step of any ladder.
LARGEST_STEP_S = 0.02

#: Largest rotation of the body in the largest step; with a larger rotation, no order of convergence is visible.
LARGEST_TURN_RAD = 0.25

#: Largest number of steps of a run. So many steps take some seconds with engines that are stepped from Python.
MAX_STEPS = 100_000

#: Smallest number of time steps in a ladder, regardless of the number of steps of a run.
MIN_LADDER_LENGTH = 6

#: Largest number of periods of controllers in a case whose time steps divide these periods: smaller steps are then possible.
MOST_PERIODS = MAX_STEPS // 20

#: The leading digits of time steps.
MANTISSAS = (5.0, 2.0, 1.0)


#: The accuracies at which methods with error control are measured, the largest first, and those of methods whose claimed order
#: is at most 1 or not known, which need 300 times as many steps for an accuracy that is smaller by 1e-5.
ACCURACIES = tuple(float(f"1e-{digits}") for digits in range(2, 11))
ACCURACIES_OF_ORDER_1 = tuple(float(f"1e-{digits}") for digits in range(1, 7))


#: The accuracies among which that of a method with error control is searched for, the largest first: 0.1 to 1e-12, three in a
#: decade, and one more at both ends, so that each of them has neighbours.
FINE_ACCURACIES = (0.2, *(float(f"{digit}e-{power}") for power in range(1, 13) for digit in (1, 0.5, 0.2)))[:-1]


def accuracies(order: int | None) -> tuple[float, ...]:
    """Return the accuracies at which a method with error control and a claimed order is measured, the largest first."""
    return ACCURACIES if order is not None and order > 1 else ACCURACIES_OF_ORDER_1


def fastest_spin(scene: AnyScene) -> float:
    """Return the magnitude of the initial angular velocity (rad/s) of the body, or the largest of a mechanism's bodies."""
    if isinstance(scene, Mechanism):
        return float(np.linalg.norm(kinematics.initial(scene).angular_velocity, axis=-1).max())
    return math.hypot(*scene.initial.angular_velocity)


def control_period(scene: AnyScene) -> Fraction | None:
    """Return the largest time (s) that divides the periods of all controllers of a scene; None if none has a rate."""
    rates = [each.rate for each in scene.controllers if each.rate is not None] if isinstance(scene, Mechanism) else []
    return reduce(_divisor, (1 / decimal(rate) for rate in rates)) if rates else None


def decimal(number: float) -> Fraction:
    """Return the simplest fraction near a number of a case, such as 1/3 for its double."""
    return Fraction(number).limit_denominator(MAX_STEPS)


def _divisor(one: Fraction, other: Fraction) -> Fraction:
    """Return the largest number that divides two numbers."""
    return Fraction(
        math.gcd(one.numerator * other.denominator, other.numerator * one.denominator), one.denominator * other.denominator
    )


def ladder(case: Case) -> tuple[float, ...]:
    """Return the time steps (s) for a case, the largest first: 20, 10, 5, 2, 1 ms and so on, or values near these.

    Every time step divides the sampling interval of the case or is a multiple of it, so that runs with different time steps
    have common instants. If controllers have rates, time steps divide their periods too, unless these are very short.
    """
    interval = case.duration / (case.samples - 1)
    spin = fastest_spin(case.scene)
    largest = min(LARGEST_STEP_S, case.duration / 10, LARGEST_TURN_RAD / spin if spin else math.inf)
    if (period := control_period(case.scene)) is not None:
        common = float(_divisor(period, decimal(interval)))
        if case.duration / common <= MOST_PERIODS:
            interval, largest = common, min(largest, common)
    steps: list[float] = []
    for decade in count(0):
        for mantissa in MANTISSAS:
            wanted = mantissa * 10.0 ** (math.floor(math.log10(largest)) - decade)
            if wanted > largest * (1 + 1e-9):
                continue
            step = fitted(wanted, interval)
            if case.duration / step > MAX_STEPS * (1 + 1e-9) and len(steps) >= MIN_LADDER_LENGTH:
                return tuple(steps)
            if not steps or step < steps[-1]:
                steps.append(step)
    raise AssertionError("counting does not end")


def fitted(wanted: float, interval: float) -> float:
    """Return the time step (s) closest to a wanted time step (s) that divides an interval (s) or is a multiple of it."""
    step = interval / round(interval / wanted) if wanted < interval else interval * round(wanted / interval)
    return float(f"{step:.12g}")
