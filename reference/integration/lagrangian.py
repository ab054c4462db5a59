"""Euler-Lagrange equations of a free rigid body in the book's Euler angles [G 2.37, 2.44, 2.45].

The coordinates are q = (x, y, z, theta, phi, psi), in the order of [G 2.37]. The 12 first-order equations are for (q, dq/dt).
[G 2.44] is used in its corrected form, M q'' + M' q' - dT/dq + dV/dq = Q; the printed equation omits the term -dT/dq.

The angles are singular where sin(theta) = 0. Near there the body axes are relabelled: in chart k the axes (I, J, K) are the
body's own axes shifted cyclically by k, so that another axis takes the role of K. Of three perpendicular axes at least one
is more than 54 degrees away from the vertical, so that a chart with sin(theta) >= 0.81 always exists.
"""

import math
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.integration.dop853 import Derivative, scales, solve
from bodycheck.reference.kinematics import (
    Float,
    Floats,
    body_rates,
    conjugate,
    euler_from_quaternion,
    euler_rates,
    multiply,
    quaternion_from_euler,
)
from bodycheck.reference.scene import Scene, Vector
from bodycheck.reference.trajectory import Array, Trajectory

#: A chart is changed where sin(theta) is below this value; the distance to the singularity is then still large compared with
#: the rotation of one step.
MIN_CHART_SINE = 0.5

#: Quaternions (w, x, y, z) that rotate components along the axes of charts 0, 1, 2 to components along the body's own axes:
#: no rotation, and the two rotations by 120 degrees about (1, 1, 1).
RELABELLINGS = np.array([[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.5, 0.5], [0.5, -0.5, -0.5, -0.5]])


def relabel(vector: Floats[Float], chart: int) -> Floats[Float]:
    """Components (..., 3) along the axes of a chart, from components along the body's own axes; chart -k inverts chart k."""
    return np.roll(vector, -chart, axis=-1)


def rotational_mass_matrix(moments: Vector, theta: float, psi: float) -> Array:
    """The rotational block of the mass matrix [G 2.37].

    Parameters
    ----------
    moments
        Principal moments A, B, C (kg m^2).
    theta, psi
        Euler angles (rad).

    Returns
    -------
    Array
        (3, 3) block for theta, phi, psi, in this order (kg m^2).
    """
    a, b, c = moments
    st, ct, sp, cp = math.sin(theta), math.cos(theta), math.sin(psi), math.cos(psi)
    coupling = (a - b) * st * sp * cp
    return np.array(
        [
            [a * cp * cp + b * sp * sp, coupling, 0.0],
            [coupling, st * st * (a * sp * sp + b * cp * cp) + c * ct * ct, c * ct],
            [0.0, c * ct, c],
        ]
    )


def angular_accelerations(
    moments: Vector, theta: float, psi: float, dtheta: float, dphi: float, dpsi: float
) -> tuple[float, float, float]:
    """Second derivatives of the Euler angles without generalized forces, from [G 2.45d-f].

    psi'' is eliminated first; the remaining 2 x 2 system in theta'' and phi'' has the determinant A B sin^2(theta), so that
    the result is singular where sin(theta) = 0.

    Parameters
    ----------
    moments
        Principal moments A, B, C (kg m^2).
    theta, psi
        Euler angles (rad); phi has no effect.
    dtheta, dphi, dpsi
        Rates of the angles (rad/s).

    Returns
    -------
    tuple of float
        theta'', phi'', psi'' (rad/s^2).
    """
    a, b, c = moments
    st, ct, sp, cp = math.sin(theta), math.cos(theta), math.sin(psi), math.cos(psi)
    difference, sc, c2 = a - b, sp * cp, cp * cp - sp * sp
    around = a * sp * sp + b * cp * cp

    m44, m45, m55 = a * cp * cp + b * sp * sp, difference * st * sc, st * st * around
    r4 = difference * dpsi * (2 * sc * dtheta - st * c2 * dphi) - ct * st * (c - around) * dphi * dphi - c * st * dphi * dpsi
    r5 = (
        -difference * (ct * sc * dtheta + st * c2 * dpsi) * dtheta
        - 2 * (st * ct * (around - c) * dtheta + st * st * difference * sc * dpsi) * dphi
        + c * st * dtheta * dpsi
    )
    r6 = c * st * dtheta * dphi - difference * (sc * (dtheta * dtheta - st * st * dphi * dphi) - c2 * st * dtheta * dphi)

    right = r5 - ct * r6
    determinant = a * b * st * st
    ddtheta = (r4 * m55 - m45 * right) / determinant
    ddphi = (m44 * right - m45 * r4) / determinant
    return ddtheta, ddphi, r6 / c - ct * ddphi


def equations(moments: Array, gravity: float) -> Derivative:
    """The 12 first-order equations of a body in free flight; the mass cancels in [G 2.45a-c].

    moments: (3,) principal moments, along the axes of the chart (kg m^2). gravity: m/s^2.
    """
    a, b, c = moments.tolist()

    def derivative(_t: float, y: Array) -> Array:
        _, _, _, theta, _, psi, dx, dy, dz, dtheta, dphi, dpsi = y.tolist()
        accelerations = angular_accelerations((a, b, c), theta, psi, dtheta, dphi, dpsi)
        return np.array([dx, dy, dz, dtheta, dphi, dpsi, 0.0, 0.0, -gravity, *accelerations])

    return derivative


def best_chart(quaternion: Array) -> int:
    """The chart (0, 1 or 2) whose axis K is closest to horizontal, for a quaternion (4,), body to world."""
    w, x, y, z = quaternion
    vertical = np.abs([w * w - x * x - y * y + z * z, 2 * (x * z - w * y), 2 * (y * z + w * x)])  # k.K, k.I, k.J
    return int(np.argmin(vertical))


def to_coordinates(chart: int, position: Array, quaternion: Array, velocity: Array, rates: Array) -> Array:
    """The coordinates and velocities of one state in a chart.

    Parameters
    ----------
    chart
        The chart.
    position, velocity
        (3,) position (m) and velocity (m/s) of the centre of mass, world frame.
    quaternion
        (4,) attitude w, x, y, z, body to world.
    rates
        (3,) angular velocity along the body's own principal axes (rad/s).

    Returns
    -------
    Array
        (12,) x, y, z, theta, phi, psi and their rates.
    """
    phi, theta, psi = euler_from_quaternion(multiply(quaternion, RELABELLINGS[chart]))
    dphi, dtheta, dpsi = euler_rates(theta, psi, relabel(rates, chart))
    return np.array([*position, theta, phi, psi, *velocity, dtheta, dphi, dpsi])


def to_states(y: Array, charts: NDArray[np.int_]) -> tuple[Array, Array, Array, Array]:
    """Positions (n, 3), quaternions (n, 4), velocities (n, 3) and angular velocities (n, 3) along the body's own axes.

    y: (n, 12) coordinates and their rates. charts: (n,) the chart of each row.
    """
    theta, phi, psi = y[:, 3], y[:, 4], y[:, 5]
    quaternion = quaternion_from_euler(phi, theta, psi)
    rates = body_rates(theta, psi, y[:, 10], y[:, 9], y[:, 11])
    for chart in (1, 2):
        rows = charts == chart
        quaternion[rows] = multiply(quaternion[rows], conjugate(RELABELLINGS[chart]))
        rates[rows] = relabel(rates[rows], -chart)
    return y[:, :3], quaternion, y[:, 6:9], rates


def integrate(scene: Scene, times: Array) -> Trajectory:
    """The motion of a body in free flight at ascending times (n,) >= 0, s, from the Euler-Lagrange equations.

    The body frame of the scene must be along the principal axes; drag and plane are ignored.

    Raises `OutOfReach` if the integration fails or takes too many steps.
    """
    initial = [np.array(part) for part in astuple(scene.initial)]
    lengths, angles, speeds, rates = scales(scene, times)
    chart = best_chart(initial[1])

    def in_chart() -> Derivative:
        return equations(relabel(np.array(scene.body.moments), chart), scene.gravity)

    def change_chart(y: Array) -> tuple[Derivative, Array] | None:
        nonlocal chart
        if abs(math.sin(y[3])) >= MIN_CHART_SINE:
            return None
        state = [part[0] for part in to_states(y[None], np.array([chart]))]
        chart = best_chart(state[1])
        return in_chart(), to_coordinates(chart, *state)

    charts: list[int] = []
    rows = solve(
        in_chart(),
        to_coordinates(chart, *initial),
        times,
        np.repeat([lengths, angles, speeds, rates], 3),
        after_step=change_chart,
        at_sample=lambda: charts.append(chart),
    )
    return Trajectory(times, *to_states(rows, np.array(charts, dtype=int)))
