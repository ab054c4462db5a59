"""Motion of a body in free flight in closed form: a projectile that turns about its centre of mass without torque.

Nothing is integrated, so that an instant costs the same near and far. The rotation has the smallest form that is exact for
it, which the digits of moments and rates decide: a nearly symmetric body is none, and the elliptic functions lose nothing
there. The motion is that of the very doubles of the scene: how far a neighbouring initial state would lead elsewhere is no
part of `bound`.
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

#: Attitude error (rad) of some ten roundings in double precision, however long the motion; 7 eps is the most yet seen.
STORED_ERROR_RAD = 16 * float(np.finfo(float).eps)

#: Attitude error per radian of the angles that are found, and reduced to one turn, in the wide type.
ERROR_PER_RADIAN = 4 * float(np.finfo(Wide).eps)


@dataclass(frozen=True)
class Rotation:
    """A closed form of a rotation without torque, along the principal axes.

    reason: why it is exact, in a few words. motion: from moments, body rates (rad/s) and attitude at t = 0 to attitudes (n, 4)
    and body rates (n, 3) at times (n,), s. angles: from moments and rates to the angle at t = 0 (rad) and the rate (rad/s) of
    what is reduced to one turn.
    """

    name: str
    reason: str
    motion: Callable[[Vector, Vector, Quaternion, Array], tuple[Array, Array]]
    angles: Callable[[Vector, Vector], tuple[float, float]]


def no_rotation(_moments: Vector, rates: Vector, quaternion: Quaternion, times: Array) -> tuple[Array, Array]:
    return np.tile(normalise(np.array(quaternion)), (len(times), 1)), np.tile(rates, (len(times), 1))


def _steady(_moments: Vector, rates: Vector) -> tuple[float, float]:
    return 0.0, float(torque_free.steady_rate(rates))


def _symmetric(moments: Vector, rates: Vector) -> tuple[float, float]:
    precession, spin = symmetric_top.angular_rates(moments, rates)
    return 0.0, float(precession + abs(spin))


def _elliptic(moments: Vector, rates: Vector) -> tuple[float, float]:
    polhode = torque_free.polhode(moments, rates)
    if polhode is None:
        return _steady(moments, rates)
    return abs(float(polhode.start)), float(polhode.rate + torque_free.precession(polhode).rate)


AT_REST = Rotation("constant attitude", "the body does not turn", no_rotation, _steady)
SPHERE = Rotation("steady turn", "all moments are equal", torque_free.rotation, _steady)
PRINCIPAL = Rotation("steady turn", "it spins about a principal axis", torque_free.rotation, _steady)
SYMMETRIC = Rotation("symmetric top", "two moments are equal", symmetric_top.rotation, _symmetric)
ASYMMETRIC = Rotation("elliptic functions", "all moments differ", torque_free.rotation, _elliptic)


def smallest_rotation(moments: Vector, rates: Vector) -> Rotation:
    """The smallest form that is exact for these principal moments and body rates (rad/s), digit by digit."""
    kind = symmetry(moments)
    if not any(rates):
        return AT_REST
    if kind == "sphere":
        return SPHERE
    if len({moment for moment, rate in zip(moments, rates, strict=True) if rate}) == 1:
        return PRINCIPAL
    return SYMMETRIC if kind == "symmetric" else ASYMMETRIC


def motion(scene: Scene, times: Array) -> Trajectory:
    """The motion of a body in free flight at any times (n,), s, in any order; drag and plane are not looked at.

    The translation, apart from the rotation, is the parabola, rounded once from the wide type.
    Raises `ValueError` or `OverflowError` for moments or body rates that are not finite.
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
    """Bound (n,) of the attitude error (rad) of `motion` at times (n,), s.

    Double precision holds the angles within one turn; the angles themselves, say the phase u = u0 + lambda t and the mean
    precession, are as good as the wide type: 5e-20 a radian where it has 80 bits, 2e-16 where there is no wider type.
    The separatrix needs no term of its own: the error of a period there is that of ln(4/k'), and k' keeps its digits.
    """
    moments, rates = scene.body.moments, scene.initial.angular_velocity
    start, rate = smallest_rotation(moments, rates).angles(moments, rates)
    return STORED_ERROR_RAD + ERROR_PER_RADIAN * (start + rate * np.abs(times))


def flip_period(body: Body, angular_velocity: Vector) -> float:
    """Time (s) between reversals of the spin about the axis of intermediate moment: half a period of the body rates.

    After it the rates about two axes, the intermediate and one extreme, have changed sign and the third is what it was. For
    a body with an axis of symmetry, where these two are any axes across it, it is half a turn of the steady precession in the
    body. Infinite where nothing reverses: in a steady spin about any axis, for a sphere, and on the separatrix.

    angular_velocity: body frame, rad/s.
    """
    polhode = torque_free.polhode(body.moments, angular_velocity)
    if polhode is None or polhode.kc == 0:
        return float("inf")
    return float(torque_free.half_period(polhode))
