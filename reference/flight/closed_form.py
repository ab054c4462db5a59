"""Motion of a body in free flight in closed form: a parabola, and a rotation about the centre of mass without torque.

Nothing is integrated, so that every instant has the same cost. The motion is that of the exact numbers of the scene (see
`exact.start`). The rotation is computed from the simplest form that is exact for its moments and rates. All digits are
compared: a nearly symmetric body is treated as asymmetric, and the elliptic functions are accurate for it too.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.bounds import EPS, Bounds
from bodycheck.reference.exact.numbers import Vector3, Wide, doubles
from bodycheck.reference.exact.rotations import IDENTITY
from bodycheck.reference.exact.start import Start, start
from bodycheck.reference.flight import symmetric_top, torque_free
from bodycheck.reference.flight.turning import Turning
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.requirements import symmetry
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array, Trajectory

#: Attitude error (rad) of about ten roundings in double precision, whatever the duration; the largest observed is 7 eps.
STORED_ERROR_RAD = 16 * EPS

#: Attitude error (rad) per radian of the angles, which are computed and reduced to one turn in the wide type.
ERROR_PER_RADIAN = 4 * float(np.finfo(Wide).eps)

#: Relative error of the energy of a rotation and of its angular momentum, when they are computed from the states.
CONSERVED_ROUNDINGS = 20 * EPS

#: Relative error of a few roundings in double precision, for a vector that is rotated or a product that is formed.
ROUNDINGS = 8 * EPS


@dataclass(frozen=True)
class Form:
    """A closed form of a rotation without torque, along the principal axes.

    Attributes
    ----------
    name
        Name of the form in results.
    reason
        Why the form is exact, in a few words.
    rotation
        Maps a start and times (n,), s, to the rotation.
    """

    name: str
    reason: str
    rotation: Callable[[Start, Array], Turning]


def _no_rotation(begin: Start, times: Array) -> Turning:
    """The attitude at t = 0, repeated for all times."""
    attitude = np.tile(doubles(begin.attitude), (len(times), 1))
    return Turning(attitude, np.zeros((len(times), 3)), np.zeros(3), 0.0, 0.0)


#: The closed forms. Their names and reasons appear in results.
AT_REST = Form("constant attitude", "the body does not turn", _no_rotation)
SPHERE = Form("steady turn", "all moments are equal", torque_free.rotation)
PRINCIPAL = Form("steady turn", "it spins about a principal axis", torque_free.rotation)
SYMMETRIC = Form("symmetric top", "two moments are equal", symmetric_top.rotation)
ASYMMETRIC = Form("elliptic functions", "all moments differ", torque_free.rotation)


@dataclass(frozen=True, eq=False)
class Flight:
    """A motion in free flight, with the form of its rotation and the bounds of its error."""

    motion: Trajectory
    bounds: Bounds
    form: Form


@dataclass(frozen=True, eq=False)
class Numbers:
    """The numbers of a scene, or of m scenes with leading axes (m,), that the bounds depend on, in doubles.

    Attributes
    ----------
    mass, gravity
        (...) mass (kg) and gravitational acceleration (m/s^2).
    moments, rates
        (..., 3) principal moments (kg m^2) and initial angular velocity along the principal axes (rad/s).
    position, velocity
        (..., 3) initial position (m) and velocity (m/s), world frame.
    """

    mass: Array
    gravity: Array
    moments: Array
    rates: Array
    position: Array
    velocity: Array


def smallest_form(moments: Vector3, rates: Vector3) -> Form:
    """The simplest form that is exact for these principal moments (kg m^2) and this angular velocity (rad/s) along their axes.

    All digits are compared: nearly equal moments count as different.
    """
    kind = symmetry(moments)
    if not any(rates):
        return AT_REST
    if kind == "sphere":
        return SPHERE
    if len({moment for moment, rate in zip(moments, rates, strict=True) if rate}) == 1:
        return PRINCIPAL
    return SYMMETRIC if kind == "symmetric" else ASYMMETRIC


def flight(scene: Scene, times: Array) -> Flight:
    """The motion of a body in free flight at any times (n,), s, in any order, in the frame of the body of the scene.

    The drag and the plane of the scene are ignored. The translation is the parabola, computed in the wide type and rounded
    once.

    Raises `ValueError` or `OverflowError` for moments or angular velocities that are not finite.
    """
    begin = start(scene)
    form = smallest_form(begin.moments, begin.rates)
    turning = form.rotation(begin, times)
    attitude, angular_velocity = turning.attitude, turning.angular_velocity
    turned = begin.axes != IDENTITY
    if turned:
        axes = np.broadcast_to(np.array(doubles(begin.axes)), attitude.shape)
        attitude, angular_velocity = multiply(attitude, conjugate(axes)), rotate(axes, angular_velocity)
    position, velocity = parabola(scene, times)
    motion = Trajectory(times, position, attitude, velocity, angular_velocity)
    numbers = Numbers(
        mass=np.asarray(scene.body.mass),
        gravity=np.asarray(scene.gravity),
        moments=np.array(doubles(begin.moments)),
        rates=np.array(doubles(begin.rates)),
        position=np.array(scene.initial.position),
        velocity=np.array(scene.initial.velocity),
    )
    return Flight(motion, bounds(numbers, turning, motion, turned=turned), form)


def parabola(scene: Scene, times: Array) -> tuple[Array, Array]:
    """Positions (n, 3), m, and velocities (n, 3), m/s, world frame, at times (n,), s, under gravity alone."""
    initial = scene.initial
    return parabolas(np.array(initial.position), np.array(initial.velocity), np.asarray(scene.gravity), times)


def parabolas(position: Array, velocity: Array, gravity: Array, times: Array) -> tuple[Array, Array]:
    """Positions (..., n, 3), m, and velocities (..., n, 3), m/s, world frame, at times (n,), s, under gravity alone.

    position, velocity: (..., 3) at t = 0. gravity: (...), m/s^2, along -z. All values are computed in the wide type and rounded
    once.
    """
    t, half = times.astype(Wide), -gravity.astype(Wide)[..., None] / 2
    positions, velocities = (np.empty((*position.shape[:-1], len(t), 3)) for _ in range(2))
    for axis in range(3):
        first, speed = (vector[..., axis, None].astype(Wide) for vector in (position, velocity))
        positions[..., axis] = first + t * (speed + t * half if axis == 2 else speed)
        velocities[..., axis] = speed + t * (2 * half) if axis == 2 else speed
    return positions, velocities


def bounds(numbers: Numbers, turning: Turning, motion: Trajectory, *, turned: bool) -> Bounds:
    """The bounds of the errors of a motion in free flight, or of the motions of m bodies with leading axes (m,).

    Angles within one turn are in double precision. The angles before this reduction, such as the phase u = u0 + lambda t and
    the mean precession, have the accuracy of the wide type: 5e-20 per radian where it has 80 bits, 2e-16 where no type is wider
    than double precision. The separatrix needs no separate term: the error of a period there is the error of ln(4/k'), and k'
    is accurate to all digits. An error of the phase changes each component of the angular velocity by at most its amplitude
    times the error. It does not change the energy, and it changes the angular momentum only by the difference between the
    phases of attitude and angular velocity. A body frame that is not along the principal axes adds the rounding of rotated
    components.

    Parameters
    ----------
    numbers
        The numbers of the scene.
    turning
        The rotation along the principal axes.
    motion
        The motion, in the frame of the body.
    turned
        Whether this frame is not along the principal axes.
    """
    angles = np.asarray(turning.first_angle)[..., None] + np.asarray(turning.angle_rate)[..., None] * np.abs(motion.t)
    phase = ERROR_PER_RADIAN * angles
    attitude = (1.5 if turned else 1.0) * STORED_ERROR_RAD + phase
    amplitude, moments, rates = turning.amplitude, numbers.moments, numbers.rates
    speed = _length(amplitude)[..., None]
    frame = ROUNDINGS * speed if turned else 0.0
    momentum = (moments * amplitude).sum(axis=-1)[..., None] if turned else 0.0
    size = _length(moments)[..., None] if turned else 0.0
    rotational = _dot(moments, rates * rates)[..., None] / 2
    spin = _length(moments * rates)[..., None]
    position, velocity = translation_bounds(numbers, motion)
    speeds = _length(motion.velocity)
    heights = np.abs(motion.position[..., 2] - numbers.position[..., 2, None])
    mass = numbers.mass[..., None]
    weight = mass * numbers.gravity[..., None]
    translational = mass * speeds * (velocity + ROUNDINGS * speeds) + weight * (position + ROUNDINGS * heights)
    return Bounds(
        error=attitude,
        position_error=position,
        velocity_error=velocity,
        angular_velocity_error=speed * attitude + frame,
        energy_error=CONSERVED_ROUNDINGS * rotational + momentum * frame + translational,
        angular_momentum_error=spin * (CONSERVED_ROUNDINGS + 2 * phase) + size * frame,
    )


def translation_bounds(numbers: Numbers, motion: Trajectory) -> tuple[Array, Array]:
    """Bounds (..., n) of the errors of the position (m) and of the velocity (m/s) of the parabola.

    Position and velocity are each rounded to double once, after a few roundings of their terms in the wide type.
    """
    t, g = np.abs(motion.t), numbers.gravity[..., None]
    speed, wide_eps = _length(numbers.velocity)[..., None], 4 * float(np.finfo(Wide).eps)
    terms = _length(numbers.position)[..., None] + t * (speed + g * t / 2)
    position = EPS * _length(motion.position) + wide_eps * terms
    velocity = EPS * _length(motion.velocity) + wide_eps * (speed + g * t)
    return position, velocity


def _dot(one: Array, other: Array) -> Array:
    """Scalar products (...) of vectors (..., 3), with the terms added in the order of the axes, whatever the shape."""
    product = one * other
    return np.asarray(product[..., 0] + product[..., 1] + product[..., 2])


def _length(vectors: Array) -> Array:
    """Lengths (...) of vectors (..., 3)."""
    return np.asarray(np.sqrt(_dot(vectors, vectors)))


def flip_period(scene: Scene) -> float:
    """Time (s) between reversals of the spin about the axis of intermediate moment: half a period of the angular velocity.

    After this time the components about the intermediate axis and one extreme axis have changed sign, and the third component
    is the same as before. For a body with an axis of symmetry, this time is half a turn of the steady precession in the body
    frame, and the two components are those across the axis of symmetry. The time is infinite if nothing reverses: in a steady
    spin about any axis, for a sphere, and on the separatrix.
    """
    begin = start(scene)
    polhode = torque_free.polhode_of(begin) if any(begin.rates) else None
    if polhode is None or polhode.kc == 0:
        return float("inf")
    return float(torque_free.half_period(polhode))
