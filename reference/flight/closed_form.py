"""Motion of a body in free flight in closed form: a parabola, and a rotation about the centre of mass without torque.

Nothing is integrated, so that every instant has the same cost. The rotation is computed from the simplest form that is exact
for its moments and rates, all digits being compared: a nearly symmetric body is treated as asymmetric, and the elliptic
functions are accurate for it too. The motion is that of the exact floating-point numbers of the scene; `bound` does not
include the sensitivity to errors in the initial state.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.flight import symmetric_top, torque_free
from bodycheck.reference.flight.elliptic import Wide
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.requirements import symmetry
from bodycheck.reference.scene import Body, Quaternion, Scene, Vector
from bodycheck.reference.trajectory import Array, Trajectory

#: Attitude error (rad) of about ten roundings in double precision, whatever the duration; the largest observed is 7 eps.
STORED_ERROR_RAD = 16 * float(np.finfo(float).eps)

#: Attitude error (rad) per radian of the angles, which are computed and reduced to one turn in the wide type.
ERROR_PER_RADIAN = 4 * float(np.finfo(Wide).eps)


@dataclass(frozen=True)
class Rotation:
    """A closed form of a rotation without torque, along the principal axes.

    Attributes
    ----------
    name
        Name of the form in results.
    reason
        Why the form is exact, in a few words.
    motion
        Maps principal moments (kg m^2), angular velocity (rad/s) and attitude at t = 0, and times (n,), s, to attitudes (n, 4)
        and angular velocities (n, 3), rad/s, in the body frame.
    angles
        Maps moments and angular velocity to the angle at t = 0 (rad) and the sum of the rates (rad/s) of the angles that are
        reduced to one turn; their errors grow with them.
    """

    name: str
    reason: str
    motion: Callable[[Vector, Vector, Quaternion, Array], tuple[Array, Array]]
    angles: Callable[[Vector, Vector], tuple[float, float]]


def _no_rotation(_moments: Vector, rates: Vector, quaternion: Quaternion, times: Array) -> tuple[Array, Array]:
    """The attitude and the angular velocity at t = 0, repeated for all times."""
    return np.tile(normalise(np.array(quaternion)), (len(times), 1)), np.tile(rates, (len(times), 1))


def _steady(_moments: Vector, rates: Vector) -> tuple[float, float]:
    """The `angles` of a spin about a fixed axis."""
    return 0.0, float(torque_free.steady_rate(rates))


def _symmetric(moments: Vector, rates: Vector) -> tuple[float, float]:
    """The `angles` of a symmetric top: its precession and its spin."""
    precession, spin = symmetric_top.angular_rates(moments, rates)
    return 0.0, float(precession + abs(spin))


def _elliptic(moments: Vector, rates: Vector) -> tuple[float, float]:
    """The `angles` of an asymmetric body: the argument of the elliptic functions and the mean precession."""
    polhode = torque_free.polhode(moments, rates)
    if polhode is None:
        return _steady(moments, rates)
    return abs(float(polhode.start)), float(polhode.rate + torque_free.precession(polhode).rate)


#: The closed forms. Their names and reasons appear in results.
AT_REST = Rotation("constant attitude", "the body does not turn", _no_rotation, _steady)
SPHERE = Rotation("steady turn", "all moments are equal", torque_free.rotation, _steady)
PRINCIPAL = Rotation("steady turn", "it spins about a principal axis", torque_free.rotation, _steady)
SYMMETRIC = Rotation("symmetric top", "two moments are equal", symmetric_top.rotation, _symmetric)
ASYMMETRIC = Rotation("elliptic functions", "all moments differ", torque_free.rotation, _elliptic)


def smallest_rotation(moments: Vector, rates: Vector) -> Rotation:
    """The simplest form that is exact for these principal moments (kg m^2) and this angular velocity (rad/s, body frame).

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


def motion(scene: Scene, times: Array) -> Trajectory:
    """The motion of a body in free flight at any times (n,), s, in any order.

    The scene must be along the principal axes of its body; its drag and its plane are ignored. The translation is the
    parabola, computed in the wide type and rounded once.

    Raises `ValueError` or `OverflowError` for moments or angular velocities that are not finite.
    """
    initial, moments = scene.initial, scene.body.moments
    form = smallest_rotation(moments, initial.angular_velocity)
    quaternion, angular_velocity = form.motion(moments, initial.angular_velocity, initial.quaternion, times)
    t, fall = times.astype(Wide)[:, None], np.array([0.0, 0.0, -scene.gravity], dtype=Wide)
    position, velocity = (np.array(part, dtype=Wide) for part in (initial.position, initial.velocity))
    return Trajectory(
        times,
        (position + t * (velocity + t * fall / 2)).astype(float),
        quaternion,
        (velocity + t * fall).astype(float),
        angular_velocity,
    )


def bound(scene: Scene, times: Array) -> Array:
    """Bound (n,), rad, of the attitude error of `motion` at times (n,), s.

    Angles within one turn are in double precision. The angles before this reduction, such as the phase u = u0 + lambda t and
    the mean precession, have the accuracy of the wide type: 5e-20 per radian where it has 80 bits, 2e-16 where there is no
    wider type than double precision. The separatrix needs no term of its own: the error of a period there is that of ln(4/k'),
    and k' is accurate to all digits.
    """
    moments, rates = scene.body.moments, scene.initial.angular_velocity
    start, rate = smallest_rotation(moments, rates).angles(moments, rates)
    return STORED_ERROR_RAD + ERROR_PER_RADIAN * (start + rate * np.abs(times))


def flip_period(body: Body, angular_velocity: Vector) -> float:
    """Time (s) between reversals of the spin about the axis of intermediate moment: half a period of the angular velocity.

    After this time the components about two axes, the intermediate one and one extreme one, have changed sign, and the third
    is the same as before. For a body with an axis of symmetry it is half a turn of the steady precession in the body frame,
    and the two components are those across the axis of symmetry. It is infinite where nothing reverses: in a steady spin
    about any axis, for a sphere, and on the separatrix.

    angular_velocity: along the principal axes of the body (rad/s).
    """
    polhode = torque_free.polhode(body.moments, angular_velocity)
    if polhode is None or polhode.kc == 0:
        return float("inf")
    return float(torque_free.half_period(polhode))
