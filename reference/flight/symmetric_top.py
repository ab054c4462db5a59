"""Rotation of a body with two equal moments without torque: a steady precession, in elementary functions.

With the moments A, A, C and the axis k of the moment C, Omega = L/A + (1 - C/A) Omega_k k. The angular momentum L is constant
in space, k is constant in the body, and Omega_k is constant, so that the attitude rotates steadily about both,

    R(t) = R(0) exp(t L/A) exp(t (1 - C/A) Omega_k k),

with L and k in the body frame at t = 0 (Landau and Lifshitz, Mechanics, par. 33 and 36).
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact import pairs
from bodycheck.reference.exact.numbers import MP, Vector3, Wide, doubles, wide
from bodycheck.reference.exact.pairs import Pair
from bodycheck.reference.exact.start import Start
from bodycheck.reference.flight.elliptic import PI, Wides
from bodycheck.reference.flight.torque_free import remainder
from bodycheck.reference.flight.turning import Turning
from bodycheck.reference.kinematics import multiply, normalise
from bodycheck.reference.trajectory import Array


@dataclass(frozen=True, eq=False)
class Steady:
    """The steady precession of one body, or of m bodies with the same axis of symmetry.

    Attributes
    ----------
    axis
        Index, among I, J, K, of the axis of symmetry.
    rates
        (..., 3) angular velocity along the principal axes at t = 0 (rad/s).
    direction
        (..., 3) direction of the angular momentum along the principal axes at t = 0.
    precession, spin
        (...) the rates |L|/A of the precession and (1 - C/A) Omega_k of the spin (rad/s).
    """

    axis: int
    rates: Array
    direction: Array
    precession: Wides
    spin: Wides


def rotation(start: Start, times: Array) -> Turning:
    """The rotation of a body with exactly two equal moments from its start, at times (n,) in any order, s."""
    moments, rates = start.moments, start.rates
    axis = figure_axis(moments)
    equal, axial = moments[axis - 1], moments[axis]
    momentum = [moment * rate for moment, rate in zip(moments, rates, strict=True)]
    size = MP.sqrt(sum(part * part for part in momentum))
    steady = Steady(
        axis=axis,
        rates=np.array(doubles(rates)),
        direction=np.array([float(part / size) for part in momentum]),
        precession=wide(size / equal),
        spin=wide((equal - axial) / equal * rates[axis]),
    )
    return precessing(steady, np.array(doubles(start.attitude)), times)


def figure_axis(moments: Vector3) -> int:
    """Index, among I, J, K, of the axis whose moment differs from the other two."""
    return next(axis for axis, moment in enumerate(moments) if moments.count(moment) == 1)


def steady_precessions(axis: int, moments: Pair, rates: Array) -> Steady:
    """The steady precessions of m bodies with the axis of symmetry `axis`.

    moments: (m, 3) principal moments (kg m^2); the moments about the other two axes are equal. rates: (m, 3) angular velocities
    along the principal axes (rad/s), not all zero.
    """
    parts = [moments[:, each] * pairs.of_wide(rates[:, each]) for each in range(3)]
    size = pairs.root(parts[0] * parts[0] + parts[1] * parts[1] + parts[2] * parts[2])
    equal, axial = moments[:, axis - 1], moments[:, axis]
    spin = (equal - axial) / equal * pairs.of_wide(rates[:, axis])
    direction = np.stack([(part.high / size.high).astype(float) for part in parts], axis=-1)
    return Steady(axis, rates, direction, (size / equal).high, spin.high)


def precessing(steady: Steady, begin: Array, times: Array) -> Turning:
    """The rotation of one body, or of m bodies, from attitudes `begin` (..., 4), at times (n,) in any order, s."""
    axis, direction, elapsed = steady.axis, steady.direction, times.astype(Wide)
    angles = [np.asarray(rate)[..., None] * elapsed for rate in (steady.precession, steady.spin)]
    half_precession, half_spin = (remainder(angle, 4 * PI)[0] / 2 for angle in angles)
    sine = np.sin(half_precession)
    about_momentum = np.stack([np.cos(half_precession), *(sine * direction[..., each, None] for each in range(3))], axis=-1)
    about_axis = np.zeros_like(about_momentum)
    about_axis[..., 0], about_axis[..., 1 + axis] = np.cos(half_spin), np.sin(half_spin)
    attitude = multiply(multiply(normalise(begin)[..., None, :], about_momentum), about_axis)

    # In the body frame, the component of the angular velocity across the axis rotates in the opposite sense.
    across, other = (axis + 1) % 3, (axis + 2) % 3
    at_start = [steady.rates[..., each, None] for each in range(3)]
    angle, _ = remainder(angles[1], 2 * PI)
    cosine, sine = np.cos(angle), np.sin(angle)
    body_rates, amplitude = np.empty((*angle.shape, 3)), np.empty(steady.rates.shape)
    body_rates[..., axis] = at_start[axis]
    body_rates[..., across] = cosine * at_start[across] + sine * at_start[other]
    body_rates[..., other] = cosine * at_start[other] - sine * at_start[across]
    amplitude[...] = np.hypot(at_start[across], at_start[other])
    amplitude[..., axis] = np.abs(steady.rates[..., axis])
    total = (steady.precession + abs(steady.spin)).astype(float)
    return Turning(attitude, body_rates, amplitude, np.zeros_like(total), total)
