"""Motion of a body in free flight in closed form: a projectile that turns about its centre of mass without torque.

Nothing is integrated, so that an instant costs the same near and far. The motion is that of the very doubles of the scene:
how far a neighbouring initial state would lead elsewhere is no part of `bound`.
"""

import numpy as np

from bodycheck.reference import torque_free
from bodycheck.reference.elliptic import Wide
from bodycheck.reference.scene import Body, Scene, Vector
from bodycheck.reference.trajectory import Array, Trajectory

STORED = 16 * float(np.finfo(float).eps)
"""Attitude error (rad) of some ten roundings in double precision, however long the motion; 7 eps is the most yet seen."""

PER_RADIAN = 4 * float(np.finfo(Wide).eps)
"""Attitude error per radian of the angles that are found, and reduced to one turn, in the wide type."""


def motion(scene: Scene, times: Array) -> Trajectory:
    """The motion of a body in free flight at any times (n,), s, in any order; drag and plane are not looked at.

    Raises `ValueError` or `OverflowError` for moments or body rates that are not finite.
    """
    initial, moments = scene.initial, scene.body.moments
    quaternion, angular_velocity = torque_free.rotation(moments, initial.angular_velocity, initial.quaternion, times)
    velocity = np.tile(initial.velocity, (len(times), 1))
    position = initial.position + times[:, None] * velocity
    position[:, 2] -= scene.gravity / 2 * times**2
    velocity[:, 2] -= scene.gravity * times
    return Trajectory(times, position, quaternion, velocity, angular_velocity)


def bound(scene: Scene, times: Array) -> Array:
    """Bound (n,) of the attitude error (rad) of `motion` at times (n,), s.

    Double precision holds the angles within one turn; the angles themselves, the phase u = u0 + lambda t and the mean
    precession, are as good as the wide type: 5e-20 a radian where it has 80 bits, 2e-16 where there is no wider type.
    The separatrix needs no term of its own: the error of a period there is that of ln(4/k'), and k' keeps its digits.
    """
    rates = scene.initial.angular_velocity
    polhode = torque_free.polhode(scene.body.moments, rates)
    if polhode is None:
        start, rate = 0.0, float(torque_free.steady_rate(rates))
    else:
        start, rate = abs(float(polhode.start)), float(polhode.rate + torque_free.precession(polhode).rate)
    return STORED + PER_RADIAN * (start + rate * np.abs(times))


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
