"""The rotation of a free rigid body by Taylor's method in 80-bit and 128-bit arithmetic, two ways (heyoka; Linux only).

The Euler-Lagrange equations are not written here: heyoka derives them from the rotational Lagrangian [G 2.33, 2.34].
Euler's equations with a quaternion are the way that is independent of Euler angles.

The angles are taken about the angular momentum, not about the vertical, for a body without torque does not know where the
vertical is. K is the axis of the largest or of the smallest moment, whichever stays farther from the angular momentum.
Then theta stays between 45 and 135 degrees for good: one chart serves the whole of any motion, and sin(theta) = 0 is never
near. (On a polhode the greatest cos^2(theta) of each of the two axes is reached where the momentum along the third axis is
zero. There the two add up to 1, so that one of them is at most 1/2.) The equations know nothing of this choice: they conserve
the momentum only as far as they are solved.

The unit of time is a power of two near 1 / |Omega|, so that the tolerance means the same for every body and nothing is
rounded. Quaternions and body rates are formed in the wide type; rounding to double comes last.

heyoka keeps compiled code in memory and, for other processes, on disk (`$XDG_CACHE_HOME/heyoka` or `$HEYOKA_CACHE_DIR`).
"""

import functools
import os
import stat
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import heyoka as hy
import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.integration.dop853 import MAX_STEPS
from bodycheck.reference.integration.lagrangian import RELABELLINGS, relabel
from bodycheck.reference.kinematics import (
    conjugate,
    euler_rates,
    geodesic_angle,
    multiply,
    normalise,
    quaternion_from_euler,
)
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: 80-bit `np.longdouble`, unit roundoff 5e-20, or 128-bit `heyoka.real128`, unit roundoff 1e-34 and some 40 times slower.
Precision = Literal["extended", "quadruple"]

#: heyoka has no type of its own where `long double` has 128 bits already (64-bit ARM).
QUADRUPLE = getattr(hy, "real128", np.longdouble)

FLOAT_TYPES = {"extended": np.longdouble, "quadruple": QUADRUPLE}

BITS_BY_MANTISSA = {63: 80, 112: 128}
#: By the bits of the significand; what users see.
BACKEND_NAMES: dict[Precision, str] = {
    "extended": f"heyoka-{BITS_BY_MANTISSA[np.finfo(np.longdouble).nmant]}-bit",
    "quadruple": "heyoka-128-bit",
}

#: Remainder of the series in a step: a few roundings of each type, since less would be lost among them.
STEP_TOLERANCES = {np.float64: 2.0**-50, np.longdouble: 2.0**-60, QUADRUPLE: 2.0**-109}

#: An array of a wide type; `heyoka.real128` is none of NumPy's own floating types.
WideArray = NDArray[Any]

#: First-order equations as heyoka takes them: pairs of a variable and the expression of its derivative.
Equations = list[tuple[Any, Any]]

#: A compiled integrator carries its state with it and serves the whole process.
_in_use = threading.Lock()


@dataclass(frozen=True, eq=False)
class Rotation:
    """Attitudes and body rates at n instants, in a wide type.

    quaternion: (n, 4) unit, w x y z, body to world. angular_velocity: (n, 3) body, rad/s.
    """

    quaternion: WideArray
    angular_velocity: WideArray


def lagrange_equations() -> Equations:
    """The equations that heyoka derives from L = (A Omega_X^2 + B Omega_Y^2 + C Omega_Z^2) / C, that is 2T / C [G 2.34].

    State: psi, phi, theta and their rates. Parameters: (A + B) / 2C and (A - B) / 2C. By [G 2.21a], with s = dphi sin(theta),
    Omega_X^2 + Omega_Y^2 = s^2 + dtheta^2 and Omega_X^2 - Omega_Y^2 = (dtheta^2 - s^2) cos(2 psi) + 2 s dtheta sin(2 psi).
    In these two, L leads to a third fewer operations than in Omega_X and Omega_Y themselves.
    """
    angles, rates = hy.make_vars("psi", "phi", "theta"), hy.make_vars("dpsi", "dphi", "dtheta")
    (psi, _, theta), (dpsi, dphi, dtheta) = angles, rates
    s = dphi * hy.sin(theta)
    total = s**2 + dtheta**2
    difference = hy.cos(2 * psi) * (dtheta**2 - s**2) + hy.sin(2 * psi) * (2 * s * dtheta)
    axial = dphi**2 - s**2 + 2 * dphi * dpsi * hy.cos(theta) + dpsi**2
    return list(hy.lagrangian(hy.par[0] * total + hy.par[1] * difference + axial, angles, rates))


def euler_equations() -> Equations:
    """Euler's equations with dq/dt = q Omega / 2. State: w, i, j, k of the quaternion and the body rates x, y, z.

    Parameters: (B - C) / A, (C - A) / B, (A - B) / C.
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
def _prepare_heyoka() -> None:
    """Keeps compiled code on disk only where no one else can write: whoever can, can run code here.

    heyoka goes on without a folder that is full or corrupt, but says so on standard output, which is for results.
    """
    hy.set_logger_level_critical()
    folder = hy.llvm_state.get_diskcache_path()
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        private = all(is_private(path) for path in (folder, *folder.glob("cache.db*")))
    except OSError:
        private = False
    hy.llvm_state.set_diskcache_enabled(private)


def is_private(path: Path) -> bool:
    """Whether a file or folder belongs to this user and no other user may write to it."""
    status = path.stat()
    return status.st_uid == os.getuid() and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


@functools.cache
def integrator(equations: Callable[[], Equations], dtype: Any) -> Any:
    """heyoka's integrator of some equations in a floating type, compiled or taken from heyoka's cache."""
    _prepare_heyoka()
    system = equations()
    return hy.taylor_adaptive(
        system,
        np.zeros(len(system), dtype=dtype),
        pars=np.zeros(len(hy.get_params([derivative for _, derivative in system])), dtype=dtype),
        tol=dtype(STEP_TOLERANCES[dtype]),
        fp_type=dtype,
        # Unrolled code is a tenth faster and takes ten times as long to compile.
        compact_mode=True,
    )


@functools.cache
def _quaternion_and_rates(dtype: Any) -> Any:
    """Compiled function from states of `lagrange_equations` (6, n) to quaternions and body rates (7, n) of Euler's axes.

    [G 2.14] and [G 2.21a], the latter as Omega = dphi k + dtheta N + dpsi K with the vertical k and the line of nodes N taken
    out of the quaternion. NumPy's sines and cosines of 80-bit numbers take twice as long.
    """
    _prepare_heyoka()
    state = psi, phi, theta, dpsi, dphi, dtheta = hy.make_vars("psi", "phi", "theta", "dpsi", "dphi", "dtheta")
    half_sum, half_difference = (phi + psi) / 2, (phi - psi) / 2
    c, s = hy.cos(theta / 2), hy.sin(theta / 2)
    w, x, y, z = c * hy.cos(half_sum), s * hy.cos(half_difference), s * hy.sin(half_difference), c * hy.sin(half_sum)
    k_x, k_y, k_z = 2 * (x * z - w * y), 2 * (w * x + y * z), 1 - 2 * (x * x + y * y)
    nodes = dtheta / hy.sqrt(k_x * k_x + k_y * k_y)
    rates = [dphi * k_x + nodes * k_y, dphi * k_y - nodes * k_x, dphi * k_z + dpsi]
    return hy.cfunc([w, x, y, z, *rates], vars=state, fp_type=dtype, compact_mode=True)


def solve(solver: Any, start: WideArray, parameters: WideArray, times: Array, angles: tuple[str, ...] = ()) -> WideArray:
    """Solutions (n, k) of an integrator's equations at times (n,) >= 0, from the state `start` (k,) at t = 0.

    The variables named in `angles` are kept within [0, 2 pi): they would lose digits as they grow.
    Raises `OutOfReach` where the integration takes too many steps or cannot go on.
    """
    instants, rows = np.unique(np.append(0.0, times), return_inverse=True)
    reducer = hy.callback.angle_reducer(hy.make_vars(*angles)) if angles else None
    with _in_use:
        solver.time = start.dtype.type(0)
        solver.state[:] = start
        solver.pars[:] = parameters
        grid = instants.astype(start.dtype)
        outcome, _, _, steps, _, solution = solver.propagate_grid(grid, max_steps=MAX_STEPS, callback=reducer)
    if outcome != hy.taylor_outcome.time_limit:
        raise OutOfReach(f"Taylor's method stopped after {steps} steps: {outcome.name}")
    return np.asarray(solution[rows[1:]])


def unit_of_rate(scene: Scene) -> np.float64:
    """A power of two some four times the initial body rates (rad/s): dividing by it does not round.

    Rates in this unit stay below the angles, which thus set the tolerance of a step.
    """
    _, exponent = np.frexp(np.abs(scene.initial.angular_velocity).max())
    return np.float64(np.ldexp(4.0, exponent))


def euler_lagrange(scene: Scene, times: Array, precision: Precision = "extended") -> Rotation:
    """The rotation of a free body at times (n,) >= 0 s, from the Euler-Lagrange equations.

    Raises `OutOfReach` where the integration takes too many steps or cannot go on.
    """
    dtype, unit = FLOAT_TYPES[precision], unit_of_rate(scene)
    moments = _wide(scene.body.moments, dtype)
    rates = _wide(scene.initial.angular_velocity, dtype) / unit
    at_rest = not any(scene.initial.angular_velocity)
    momentum = _wide(np.eye(3)[np.argmin(scene.body.moments)], dtype) if at_rest else moments * rates

    chart = (axis_across(moments, momentum) + 1) % 3
    a, b, c = relabel(moments, chart)
    x, y, z = relabel(momentum, chart)
    phi, theta, psi = 0 * x, np.arctan2(np.sqrt(x * x + y * y), z), np.arctan2(x, y)
    dphi, dtheta, dpsi = euler_rates(theta, psi, relabel(rates, chart))
    axes = _wide(RELABELLINGS[chart], dtype)
    from_axes = multiply(normalise(_wide(scene.initial.quaternion, dtype)), axes)
    from_frame = multiply(from_axes, conjugate(quaternion_from_euler(phi, theta, psi)))

    solution = solve(
        integrator(lagrange_equations, dtype),
        np.array([psi, phi, theta, dpsi, dphi, dtheta]),
        np.array([(a + b) / (2 * c), (a - b) / (2 * c)]),
        np.asarray(times) * unit,
        angles=("psi", "phi"),
    )
    turned = _quaternion_and_rates(dtype)(np.ascontiguousarray(solution.T)).T
    # The turns of frame and axes are linear in the quaternion between them: one matrix for all instants.
    to_world = multiply(multiply(from_frame, _wide(np.eye(4), dtype)), conjugate(axes))
    return Rotation(turned[:, :4] @ to_world, relabel(turned[:, 4:], -chart) * unit)


def quasi_coordinates(scene: Scene, times: Array, precision: Precision = "extended") -> Rotation:
    """The rotation of a free body at times (n,) >= 0 s, from Euler's equations.

    Raises `OutOfReach` where the integration takes too many steps or cannot go on.
    """
    unit = unit_of_rate(scene)
    start, parameters = euler_start(scene, FLOAT_TYPES[precision])
    solution = solve(integrator(euler_equations, FLOAT_TYPES[precision]), start, parameters, np.asarray(times) * unit)
    return Rotation(normalise(solution[:, :4]), solution[:, 4:] * unit)


def euler_start(scene: Scene, dtype: Any) -> tuple[WideArray, WideArray]:
    """Initial state and parameters of `euler_equations`, rates in the scene's `unit_of_rate`."""
    a, b, c = _wide(scene.body.moments, dtype)
    attitude = normalise(_wide(scene.initial.quaternion, dtype))
    rates = _wide(scene.initial.angular_velocity, dtype) / unit_of_rate(scene)
    return np.concatenate([attitude, rates]), np.array([(b - c) / a, (c - a) / b, (a - b) / c])


def attitude_difference(p: WideArray, q: WideArray) -> Array:
    """Geodesic angle (n,) in rad between quaternions (n, 4), each double, 80-bit or 128-bit, formed in 128 bits."""
    return np.asarray(geodesic_angle(_quadruple(p), _quadruple(q)).astype(float))


def _wide(values: Any, dtype: Any) -> WideArray:
    return np.asarray(values, dtype=float).astype(dtype)


def _quadruple(values: WideArray) -> WideArray:
    if values.dtype == QUADRUPLE:
        return values
    # heyoka converts from double alone; two doubles hold every digit of an 80-bit number.
    head = values.astype(float)
    return _wide(head, QUADRUPLE) + _wide(values - head, QUADRUPLE)


def axis_across(moments: WideArray, momentum: WideArray) -> int:
    """The principal axis, of the largest or smallest moment, that never comes within 45 degrees of the angular momentum."""
    mobility = 1 / moments
    spread = mobility.max() - mobility.min()
    if spread == 0:
        return int(np.argmin(np.abs(momentum)))
    mean = (momentum * momentum * mobility).sum() / (momentum * momentum).sum()
    return int(np.argmax(moments) if 2 * (mobility.max() - mean) <= spread else np.argmin(moments))
