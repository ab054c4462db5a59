"""The witnesses of a flight: its motion computed in other ways, where the cost and the error are known beforehand.

- Euler-Lagrange: the equations that follow from the Lagrangian in Euler angles, from the exact start of the truth.
- Quasi-coordinates: Euler's equations, and the translation, by separate code that starts from the case file: see `independent`.

A motion that lasts longer than a period of the angular velocity is continued from one period (`integration.periods`). If even
one period turns the body too far, or amplifies rounding too much, the integration is left out. The second closed form
(`independent.closed_form`) is then used instead, and also where the integrations have lost too many digits.
"""

import contextlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.errors import OutOfReach, within_range
from bodycheck.reference.exact.start import Start, start
from bodycheck.reference.flight.amplification import amplification
from bodycheck.reference.flight.torque_free import half_period, polhode_of
from bodycheck.reference.independent import closed_form
from bodycheck.reference.independent.border import border
from bodycheck.reference.independent.closed_form import parabola
from bodycheck.reference.independent.directions import exact_quaternion
from bodycheck.reference.inertia import along_principal_axes, in_body_frame
from bodycheck.reference.integration import lagrangian, quasi_coordinates
from bodycheck.reference.integration.periods import Motion, periodic, searched_period
from bodycheck.reference.integration.rotation import Rotation, WideArray
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reference.witness import DOUBLE_DIGITS, Witness

if TYPE_CHECKING:
    from bodycheck.reference.independent.integration import Arithmetic

#: Roundings of an integration by Taylor's method, before they are amplified.
TAYLOR_ROUNDINGS = 32.0

#: Roundings of an attitude that is only stored in NumPy's widest type.
STORED_ROUNDINGS = 4.0

#: Roundings of an integration by DOP853 with its tolerance, before they are amplified.
DOP853_ROUNDINGS = 200.0

#: Largest angle (rad) that an integration may turn through; this takes some 10 ms in 80-bit arithmetic.
FARTHEST_RAD = 300.0

#: Name of SciPy's solver in results.
DOP853_NAME = "scipy-dop853"

#: Decimal digits of NumPy's widest type.
EXTENDED_DIGITS = math.ceil(-math.log10(float(np.finfo(np.longdouble).eps)))

#: Largest number of instants at which DOP853 is a witness: a step ends at each instant, and so many steps take some two
#: seconds.
DOP853_INSTANTS = 10_000

#: Number of periods beyond which a motion is continued from one period.
FEW_PERIODS = 1.2

#: Largest error (rad) that an integration may have as a witness.
LARGEST_ERROR = 1e-3

#: Error (rad) of the integrations above which the second closed form is worth its cost.
ACCURATE = 1e-10


#: A function that computes a witness of a scene at ascending times (n,) >= 0, s.
Way = Callable[[Scene, Array], Witness]


@dataclass(frozen=True, eq=False)
class Course:
    """The properties of a rotation that are known before it is integrated.

    Attributes
    ----------
    period
        The period of the angular velocity (s), in the widest type; infinite on the separatrix, any time for a steady spin.
    repeats
        Whether the motion is continued from one period.
    speed
        Bound of the angular velocity (rad/s).
    turning
        Bound of the angle through which the integration turns (rad).
    in_period
        Error (rad) after one period, per unit of relative rounding error made at all earlier times.
    growth
        (n,) the same error at the instants.
    growth_until
        A function that gives the same error at any times (n,), for a motion that is integrated from the start and not continued
        from one period.
    """

    period: Any
    repeats: bool
    speed: float
    turning: float
    in_period: float
    growth: Array
    growth_until: Callable[[Array], Array]


def course(begin: Start, times: Array, few_periods: float = FEW_PERIODS) -> Course:
    """Return the properties of the rotation from a start that is not at rest, until ascending times (n,) >= 0, s.

    A rounding of the moments also changes the rate of the polhode, lambda of `torque_free`, by the rounding divided by the
    difference of the two moments to which the rate is proportional.

    few_periods: the number of periods beyond which the rotation is continued from one period.
    """
    motion = polhode_of(begin)
    if motion is None:
        speed, libration = math.hypot(*(float(rate) for rate in begin.rates)), 0.0
        period = np.longdouble(2 * np.pi / speed)
    else:
        speed = float(motion.unit) * math.hypot(
            *(size / moment for size, moment in zip(motion.size, motion.moments, strict=True))
        )
        period = 2 * half_period(motion)
        apart = motion.gaps[1] if motion.p == 2 else motion.gaps[0]
        libration = float(motion.rate * motion.unit * max(motion.moments) / apart)

    def growth(t: Array) -> Array:
        return np.asarray(amplification(begin, t) + libration * t)

    end = float(np.max(times, initial=0.0))
    if not end > few_periods * period:
        direct = growth(times)
        return Course(period, False, speed, speed * end, float(np.max(direct, initial=0.0)), direct, growth)
    one = float(growth(np.array([float(period)]))[0])
    with np.errstate(over="ignore"):  # infinite growth is out of reach of every integration
        continued = (1 + times / float(period)) * one
    return Course(period, True, speed, speed * float(period), one, continued, growth)


@dataclass(frozen=True)
class Backend:
    """A solver of two forms of the equations of motion of a body that rotates in free flight.

    Attributes
    ----------
    name
        Name of the solver in results.
    euler_lagrange, quasi_coordinates
        Map a scene and ascending times (n,) >= 0, s, to the witness by these equations. They raise `OutOfReach`.
    """

    name: str
    euler_lagrange: Way
    quasi_coordinates: Way


def backend() -> Backend:
    """The best solver that is installed: heyoka's Taylor series in NumPy's widest type, otherwise SciPy's DOP853."""
    try:
        from bodycheck.reference.independent.integration import EXTENDED
        from bodycheck.reference.integration.heyoka_solver import EXTENDED_NAME
    except ImportError:
        return dop853()
    return Backend(
        EXTENDED_NAME,
        lambda scene, times: euler_lagrange(scene, times, EXTENDED_NAME),
        lambda scene, times: independent(scene, times, EXTENDED, EXTENDED_NAME),
    )


def dop853() -> Backend:
    """The solver that is always installed: SciPy's DOP853 in double precision."""
    return Backend(
        DOP853_NAME,
        lambda scene, times: in_doubles("euler-lagrange", lagrangian.integrate, scene, times),
        lambda scene, times: in_doubles("quasi-coordinates", quasi_coordinates.integrate, scene, times),
    )


def witnesses(scene: Scene, times: Array, solver: Backend) -> list[Witness]:
    """The witnesses of the flight of a scene at ascending times (n,) >= 0, s.

    They are the integrations of the solver that can follow the motion. If one of them cannot, or neither is accurate, the
    second closed form is added. The translation always has a witness, unless there is drag.
    """
    if not any(start(scene).rates):
        return [unmoved(scene, times, turns=False)]
    ways, collected = (solver.euler_lagrange, solver.quasi_coordinates), []
    for way in ways:
        with contextlib.suppress(OutOfReach), within_range("the integration"):
            collected.append(way(scene, times))
    if len(collected) < len(ways) or min(float(np.max(each.error, initial=0.0)) for each in collected) > ACCURATE:
        collected.append(closed_form.witness(scene, times))
    complete = scene.drag or any(each.position is not None for each in collected)
    return collected if complete else [*collected, unmoved(scene, times, turns=True)]


def wide_witness(scene: Scene, times: Array, bits: int) -> Witness:
    """The independent way of a body that rotates, in multiprecision arithmetic with a mantissa of `bits` bits (heyoka).

    Its states are rounded to the widest type of NumPy. Raises `OutOfReach` where it cannot follow the motion, and `ImportError`
    where heyoka is not installed.
    """
    from bodycheck.reference.independent.integration import multiprecision

    return independent(scene, times, multiprecision(bits), f"heyoka-{bits}-bit")


def euler_lagrange(scene: Scene, times: Array, name: str) -> Witness:
    """The Euler-Lagrange equations in the widest type of NumPy, as a witness of attitude and rates. Raises `OutOfReach`."""
    from bodycheck.reference.integration import taylor

    begin, rounding = start(scene), TAYLOR_ROUNDINGS * float(np.finfo(np.longdouble).eps)
    expected = course(begin, times)
    _require(expected, rounding)
    motion = taylor.tumbling(begin, np.longdouble)
    rotation, error = followed(motion, taylor.momentum_axis(begin, np.longdouble), expected, times, rounding)
    return _witness(f"euler-lagrange, {name}", taylor.in_body_frame(begin, rotation), expected, error, digits=EXTENDED_DIGITS)


def independent(scene: Scene, times: Array, arithmetic: "Arithmetic", name: str) -> Witness:
    """The independent way, as a witness of all states. Raises `OutOfReach`."""
    from bodycheck.reference.independent.integration import momentum_axis, spinning

    expected, rounding = course(start(scene), times), TAYLOR_ROUNDINGS * arithmetic.rounding
    _require(expected, rounding)
    begin = border(scene)
    motion = spinning(begin, arithmetic)
    rotation, error = followed(motion, momentum_axis(begin, arithmetic), expected, times, rounding)
    turned = Rotation(arithmetic.rounded(rotation.quaternion), arithmetic.rounded(rotation.angular_velocity))
    moved = {} if scene.drag else _translation(scene, times)
    return _witness(f"quasi-coordinates, {name}", turned, expected, error, digits=arithmetic.digits, **moved)


def in_doubles(name: str, integrate: Callable[[Scene, Array], Trajectory], scene: Scene, times: Array) -> Witness:
    """An integration by DOP853 in double precision, from the doubles of the scene. Raises `OutOfReach`."""
    rounding, expected = DOP853_ROUNDINGS * EPS, course(start(scene), times, few_periods=math.inf)
    _require(expected, rounding)
    if len(times) > DOP853_INSTANTS:
        raise OutOfReach(
            f"DOP853 would take a step at least for each of {len(times)} instants; {DOP853_INSTANTS} are the limit"
        )
    motion = in_body_frame(scene, integrate(along_principal_axes(scene), times))
    turned = Rotation(motion.quaternion, motion.angular_velocity)
    return _witness(f"{name}, {DOP853_NAME}", turned, expected, rounding * expected.growth, digits=DOUBLE_DIGITS)


def unmoved(scene: Scene, times: Array, *, turns: bool) -> Witness:
    """The parabola and, for a body that does not turn, its constant attitude, by separate code that starts from the file."""
    wide = np.longdouble
    states: dict[str, Any] = {} if scene.drag else _translation(scene, times)
    if not turns:
        attitude = exact_quaternion(border(scene).cosines).astype(wide)
        error = STORED_ROUNDINGS * float(np.finfo(wide).eps)
        states |= {"quaternion": np.tile(attitude, (len(times), 1)), "angular_velocity": np.zeros((len(times), 3), wide)}
        states["error"] = np.full(len(times), error)
    return Witness("parabola, numpy", **states)


def followed(motion: Motion, axis: WideArray, expected: Course, times: Array, rounding: float) -> tuple[Rotation, Array]:
    """A rotation at times (n,), and a bound (n,) of its error (rad), which is infinite where the rotation cannot be followed.

    axis: (3,) direction of the angular momentum in the world. rounding: the relative error made at all times.

    If the motion does not have the period of its course, one of the two is wrong. The period is then searched for. If none is
    found, the motion is followed as far as `FARTHEST_RAD` allows.
    """
    if not expected.repeats:
        return motion.follow(times.astype(axis.dtype)), rounding * expected.growth
    allowed = rounding * expected.in_period
    try:
        return periodic(motion, axis, expected.period, times, allowed), rounding * expected.growth
    except OutOfReach:
        horizon = min(float(np.max(times)), FARTHEST_RAD / expected.speed)
    try:
        period = searched_period(motion, horizon, axis.dtype)
        return periodic(motion, axis, period, times, allowed), rounding * expected.growth
    except OutOfReach:
        error = np.where(times <= horizon, rounding * expected.growth_until(times), np.inf)
        return motion.follow(np.minimum(times, horizon).astype(axis.dtype)), error


def _require(expected: Course, rounding: float) -> None:
    """Raise `OutOfReach` where an integration with this relative error turns too far, or its error would grow too large."""
    if expected.turning > FARTHEST_RAD:
        raise OutOfReach(
            f"an integration would turn through {expected.turning:.3g} rad, and {FARTHEST_RAD:.0f} rad are the limit"
        )
    if not rounding * float(np.max(expected.growth, initial=0.0)) <= LARGEST_ERROR:
        raise OutOfReach("rounding would grow too large")


def _witness(name: str, turned: Rotation, expected: Course, error: Array, digits: int, **moved: Any) -> Witness:
    """A witness of a rotation, and of a translation where one is given, with the bounds of its errors."""
    error = error + STORED_ROUNDINGS * float(np.finfo(turned.quaternion.dtype).eps)
    rates_error = expected.speed * error
    return Witness(
        name,
        turned.quaternion,
        turned.angular_velocity,
        error=error,
        angular_velocity_error=rates_error,
        digits=digits,
        **moved,
    )


def _translation(scene: Scene, times: Array) -> dict[str, Any]:
    """The parabola with the bounds of its errors, by the names of `Witness`."""
    position, velocity, position_error, velocity_error = parabola(scene, times)
    return {
        "position": position,
        "velocity": velocity,
        "position_error": position_error,
        "velocity_error": velocity_error,
    }
