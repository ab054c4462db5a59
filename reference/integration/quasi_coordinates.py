"""Euler's equations of a free rigid body, with a quaternion for the attitude. They do not use Euler angles.

A dOmega_X/dt = (B - C) Omega_Y Omega_Z and cyclically; dq/dt = q Omega / 2. The components of the angular velocity are
quasi-coordinates: they are not the rates of any coordinates.
"""

from dataclasses import astuple

import numpy as np

from bodycheck.reference.integration.dop853 import Derivative, scales, solve
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.scene import Scene, Vector
from bodycheck.reference.trajectory import Array, Trajectory


def equations(moments: Vector, gravity: float) -> Derivative:
    """The 13 first-order equations of a body in free flight, for y = (position, quaternion, velocity, angular velocity).

    moments: principal moments A, B, C (kg m^2). gravity: m/s^2. Position and velocity are in the world frame (m, m/s), the
    quaternion is body to world, and the angular velocity is along the principal axes (rad/s).
    """
    a, b, c = moments

    def derivative(_t: float, y: Array) -> Array:
        _, _, _, w, i, j, k, dx, dy, dz, p, q, r = y.tolist()
        return np.array(
            [
                dx,
                dy,
                dz,
                (-i * p - j * q - k * r) / 2,
                (w * p + j * r - k * q) / 2,
                (w * q + k * p - i * r) / 2,
                (w * r + i * q - j * p) / 2,
                0.0,
                0.0,
                -gravity,
                (b - c) * q * r / a,
                (c - a) * r * p / b,
                (a - b) * p * q / c,
            ]
        )

    return derivative


def integrate(scene: Scene, times: Array) -> Trajectory:
    """The motion of a body in free flight at ascending times (n,) >= 0, s, from Euler's equations.

    The body frame of the scene must be along the principal axes; drag and plane are ignored.

    Raises `OutOfReach` if the integration fails or takes too many steps.
    """
    rows = solve(
        equations(scene.body.moments, scene.gravity),
        np.concatenate(astuple(scene.initial)),
        times,
        np.repeat(scales(scene, times), [3, 4, 3, 3]),
    )
    return Trajectory(times, rows[:, :3], normalise(rows[:, 3:7]), rows[:, 7:10], rows[:, 10:])
