"""The rotation of a free rigid body by Taylor's method in 80-bit and 128-bit arithmetic (heyoka; Linux only).

The Euler-Lagrange equations are not written here: heyoka derives them from the rotational Lagrangian [G 2.33, 2.34]. Euler's
equations with a quaternion are here too, for `sensitivity`.

The Euler angles are defined about the angular momentum and not about the vertical, since without torque no direction in space
is special. K is the axis of the largest or of the smallest moment, whichever stays farther from the angular momentum. Then
theta always stays between 45 and 135 degrees, so that one chart is enough for the whole of any motion and sin(theta) = 0 is
never near. (On a polhode the largest cos^2(theta) of each of the two axes is reached where the momentum along the third axis
is zero. There the two values add up to 1, so that one of them is at most 1/2.) The equations do not use this choice: they
conserve the angular momentum only as accurately as they are solved.

The unit of time is a power of two near 1 / |Omega|, so that the tolerance has the same meaning for every body and no rounding
occurs in the conversion. Quaternions and angular velocities are computed in the wide type and rounded to double at the end.
"""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import heyoka as hy
import numpy as np

from bodycheck.reference.exact.numbers import MP, Real, doubles, wide
from bodycheck.reference.exact.rotations import IDENTITY
from bodycheck.reference.exact.start import Start, start
from bodycheck.reference.integration.heyoka_solver import EXTENDED_NAME, QUADRUPLE, Equations, integrator, prepare_heyoka, solve
from bodycheck.reference.integration.lagrangian import RELABELLINGS, relabel
from bodycheck.reference.integration.rotation import Rotation, WideArray
from bodycheck.reference.kinematics import (
    conjugate,
    euler_rates,
    geodesic_angle,
    multiply,
    quaternion_from_euler,
    rotate,
)
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: "extended" is the 80-bit `np.longdouble` with a unit roundoff of 5e-20. "quadruple" is the 128-bit `heyoka.real128` with a
#: unit roundoff of 1e-34; it is about 40 times slower.
Precision = Literal["extended", "quadruple"]

#: The floating-point type of each precision.
FLOAT_TYPES = {"extended": np.longdouble, "quadruple": QUADRUPLE}

#: Name of the backend in results, for each precision.
BACKEND_NAMES: dict[Precision, str] = {"extended": EXTENDED_NAME, "quadruple": "heyoka-128-bit"}

#: Decimal digits from which a 128-bit number is read without loss.
QUADRUPLE_DIGITS = 40


def lagrange_equations() -> Equations:
    """The equations that heyoka derives from L = (A Omega_X^2 + B Omega_Y^2 + C Omega_Z^2) / C, which is 2T / C [G 2.34].

    The state is psi, phi, theta and their rates. The parameters are (A + B) / 2C and (A - B) / 2C. By [G 2.21a], with
    s = dphi sin(theta), Omega_X^2 + Omega_Y^2 = s^2 + dtheta^2 and
    Omega_X^2 - Omega_Y^2 = (dtheta^2 - s^2) cos(2 psi) + 2 s dtheta sin(2 psi). Written with these two expressions, L leads to
    a third fewer operations than when written with Omega_X and Omega_Y.
    """
    angles, rates = hy.make_vars("psi", "phi", "theta"), hy.make_vars("dpsi", "dphi", "dtheta")
    (psi, _, theta), (dpsi, dphi, dtheta) = angles, rates
    s = dphi * hy.sin(theta)
    total = s**2 + dtheta**2
    difference = hy.cos(2 * psi) * (dtheta**2 - s**2) + hy.sin(2 * psi) * (2 * s * dtheta)
    axial = dphi**2 - s**2 + 2 * dphi * dpsi * hy.cos(theta) + dpsi**2
    return list(hy.lagrangian(hy.par[0] * total + hy.par[1] * difference + axial, angles, rates))


def euler_equations() -> Equations:
    """Euler's equations together with dq/dt = q Omega / 2.

    The state is w, i, j, k of the quaternion and the angular velocity x, y, z along the principal axes. The parameters are
    (B - C) / A, (C - A) / B and (A - B) / C.
    """
    w, i, j, k, x, y, z = hy.make_vars("w", "i", "j", "k", "x", "y", "z")
    return [
        (w, -(i * x + j * y + k * z) / 2),
        (i, (w * x + j * z - k * y) / 2),
        (j, (w * y + k * x - i * z) / 2),
        (k, (w * z + i * y - j * x) / 2),
        (x, hy.par[0] * (y * z)),
        (y, hy.par[1] * (z * x)),
        (z, hy.par[2] * (x * y)),
    ]


@functools.cache
def _quaternion_and_rates(dtype: Any) -> Any:
    """Compiled function from states of `lagrange_equations` (6, n) to quaternions and angular velocities (7, n).

    Both refer to the frame and the axes of the Euler angles. The function uses [G 2.14] and [G 2.21a], the latter in the form
    Omega = dphi k + dtheta N + dpsi K with the vertical k and the line of nodes N computed from the quaternion. NumPy's sines
    and cosines of 80-bit numbers would take twice as long.
    """
    prepare_heyoka()
    state = psi, phi, theta, dpsi, dphi, dtheta = hy.make_vars("psi", "phi", "theta", "dpsi", "dphi", "dtheta")
    half_sum, half_difference = (phi + psi) / 2, (phi - psi) / 2
    c, s = hy.cos(theta / 2), hy.sin(theta / 2)
    w, x, y, z = c * hy.cos(half_sum), s * hy.cos(half_difference), s * hy.sin(half_difference), c * hy.sin(half_sum)
    k_x, k_y, k_z = 2 * (x * z - w * y), 2 * (w * x + y * z), 1 - 2 * (x * x + y * y)
    nodes = dtheta / hy.sqrt(k_x * k_x + k_y * k_y)
    rates = [dphi * k_x + nodes * k_y, dphi * k_y - nodes * k_x, dphi * k_z + dpsi]
    return hy.cfunc([w, x, y, z, *rates], vars=state, fp_type=dtype, compact_mode=True)


def unit_of_rate(scene: Scene) -> np.float64:
    """The unit of angular velocity (rad/s): a power of two, four to eight times the largest initial component.

    Dividing by it does not round. Rates in this unit stay smaller than the angles, which therefore determine the tolerance of a
    step.
    """
    return _unit_of(scene.initial.angular_velocity)


def _unit_of(rates: Sequence[float]) -> np.float64:
    _, exponent = np.frexp(np.abs(rates).max())
    return np.float64(np.ldexp(4.0, exponent))


def euler_lagrange(scene: Scene, times: Array, precision: Precision = "extended") -> Rotation:
    """The rotation of a free body, from the Euler-Lagrange equations.

    Parameters
    ----------
    scene
        The scene; only the rotation is computed.
    times
        (n,) times >= 0 in any order (s).
    precision
        The arithmetic.

    Returns
    -------
    Rotation
        Attitudes and angular velocities at the times.

    Raises
    ------
    OutOfReach
        If the integration fails or takes too many steps.
    """
    begin = start(scene)
    return in_body_frame(begin, tumbling(begin, FLOAT_TYPES[precision]).follow(np.asarray(times)))


@dataclass(frozen=True, eq=False)
class Tumbling:
    """The rotation of a body along its principal axes, to be followed by the Euler-Lagrange equations; see `tumbling`.

    Attributes
    ----------
    moments
        (3,) principal moments, in a floating-point type.
    chart
        Which axis takes the role of K: see `lagrangian.relabel`.
    unit
        The unit of angular velocity (rad/s).
    state
        (6,) psi, phi, theta and their rates at t = 0.
    from_frame
        (4,) quaternion from the frame in which the angles are defined to the world.
    """

    moments: WideArray
    chart: int
    unit: np.float64
    state: WideArray
    from_frame: WideArray

    def follow(self, instants: WideArray) -> Rotation:
        """Return attitudes and angular velocities at times (n,) >= 0 (s) in any order. Raise `OutOfReach` on failure."""
        dtype: Any = self.state.dtype.type
        a, b, c = relabel(self.moments, self.chart)
        solution = solve(
            integrator(lagrange_equations, dtype),
            self.state,
            np.array([(a + b) / (2 * c), (a - b) / (2 * c)]),
            instants * self.unit,
            angles=("psi", "phi"),
        )
        turned = _quaternion_and_rates(dtype)(np.ascontiguousarray(solution.T)).T
        # Converting the frame and the axes is linear in the quaternion, so that one matrix serves all instants.
        axes = _wide(RELABELLINGS[self.chart], dtype)
        to_world = multiply(multiply(self.from_frame, _wide(np.eye(4), dtype)), conjugate(axes))
        return Rotation(turned[:, :4] @ to_world, relabel(turned[:, 4:], -self.chart) * self.unit)

    def acceleration(self, angular_velocity: WideArray) -> WideArray:
        """The angular accelerations (n, 3), rad/s^2, at angular velocities (n, 3), rad/s, by Euler's equations."""
        return np.asarray(np.cross(self.moments * angular_velocity, angular_velocity) / self.moments)


@functools.lru_cache(maxsize=64)
def tumbling(begin: Start, dtype: Any) -> Tumbling:
    """The rotation of a body from its start, in a floating-point type."""
    unit = _unit_of(doubles(begin.rates))
    moments, rates = rounded(begin.moments, dtype), rounded(begin.rates, dtype) / unit
    momentum = moments * rates if any(begin.rates) else _wide(np.eye(3)[np.argmin(doubles(begin.moments))], dtype)
    chart = (axis_across(moments, momentum) + 1) % 3
    x, y, z = relabel(momentum, chart)
    phi, theta, psi = 0 * x, np.arctan2(np.sqrt(x * x + y * y), z), np.arctan2(x, y)
    dphi, dtheta, dpsi = euler_rates(theta, psi, relabel(rates, chart))
    from_axes = multiply(rounded(begin.attitude, dtype), _wide(RELABELLINGS[chart], dtype))
    from_frame = multiply(from_axes, conjugate(quaternion_from_euler(phi, theta, psi)))
    return Tumbling(moments, chart, unit, np.array([psi, phi, theta, dpsi, dphi, dtheta]), from_frame)


def euler_start(scene: Scene, dtype: Any) -> tuple[WideArray, WideArray]:
    """Initial state (7,) and parameters (3,) of `euler_equations` in a floating-point type, with rates in `unit_of_rate`."""
    begin = start(scene)
    a, b, c = rounded(begin.moments, dtype)
    rates = rounded(begin.rates, dtype) / unit_of_rate(scene)
    return np.concatenate([rounded(begin.attitude, dtype), rates]), np.array([(b - c) / a, (c - a) / b, (a - b) / c])


def in_body_frame(begin: Start, rotation: Rotation) -> Rotation:
    """The rotation in the frame of the body, from the rotation along its principal axes."""
    if begin.axes == IDENTITY:
        return rotation
    axes = np.broadcast_to(rounded(begin.axes, rotation.quaternion.dtype.type), rotation.quaternion.shape)
    return Rotation(multiply(rotation.quaternion, conjugate(axes)), rotate(axes, rotation.angular_velocity))


def rounded(values: Sequence[Real], dtype: Any) -> WideArray:
    """Exact numbers, rounded to a floating-point type."""
    if dtype is np.float64:
        return np.array(doubles(values))
    if dtype is np.longdouble:
        return np.array([wide(value) for value in values])
    return np.array([dtype(MP.nstr(value, QUADRUPLE_DIGITS)) for value in values])


def attitude_difference(p: WideArray, q: WideArray) -> Array:
    """Angle (n,), rad, between attitudes (n, 4) in double, 80-bit or 128-bit precision, computed in 128 bits."""
    return np.asarray(geodesic_angle(_quadruple(p), _quadruple(q)).astype(float))


def _wide(values: Any, dtype: Any) -> WideArray:
    """Numbers in double precision, converted to a wide type."""
    return np.asarray(values, dtype=float).astype(dtype)


def _quadruple(values: WideArray) -> WideArray:
    """Numbers of any of the types, converted to the 128-bit type without loss."""
    if values.dtype == QUADRUPLE:
        return values
    # heyoka converts only from double precision; two doubles hold all digits of an 80-bit number.
    head = values.astype(float)
    return _wide(head, QUADRUPLE) + _wide(values - head, QUADRUPLE)


def momentum_axis(begin: Start, dtype: Any) -> WideArray:
    """The direction (3,) of the angular momentum in the world, which is fixed, in a floating-point type."""
    momentum = rounded(begin.moments, dtype) * rounded(begin.rates, dtype)
    momentum = momentum / np.sqrt((momentum * momentum).sum())
    return rotate(rounded(begin.attitude, dtype), momentum)


def axis_across(moments: WideArray, momentum: WideArray) -> int:
    """Index of the axis of the largest or smallest moment that always stays at least 45 degrees from the angular momentum.

    moments: (3,) principal moments. momentum: (3,) initial angular momentum along the principal axes, in any unit.
    """
    mobility = 1 / moments
    spread = mobility.max() - mobility.min()
    if spread == 0:
        return int(np.argmin(np.abs(momentum)))
    mean = (momentum * momentum * mobility).sum() / (momentum * momentum).sum()
    return int(np.argmax(moments) if 2 * (mobility.max() - mean) <= spread else np.argmin(moments))
