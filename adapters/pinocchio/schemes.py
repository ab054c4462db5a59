"""Integration schemes as users of Pinocchio write them, for any joints.

Each scheme takes a model, a function for the acceleration, the configuration q (nq,), the velocity v (nv,) and the time step h
(s), and returns q and v one step later. The function takes q, v, and the part of the step that has passed. The step may be a
number, or an array (nv,) with this number in every element: NumPy multiplies two arrays of this size in half of the time that
it needs for a number and an array.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin

from bodycheck.reference.trajectory import Array

Acceleration = Callable[[Array, Array, float], Any]
Scheme = Callable[[pin.Model, Acceleration, Array, Array, Any], tuple[Array, Array]]
Transport = Callable[[pin.Model, Array, Array, Array], Array]


def euler(model: pin.Model, aba: Acceleration, q: Array, v: Array, h: float | Array) -> tuple[Array, Array]:
    """Take a step of semi-implicit Euler: first the velocity, then the configuration with the new velocity. Order 1."""
    v = v + h * aba(q, v, 0.0)
    return pin.integrate(model, q, h * v), v


def rk4_naive(model: pin.Model, aba: Acceleration, q: Array, v: Array, h: float | Array) -> tuple[Array, Array]:
    """Take a step of classical Runge-Kutta that adds velocities of different tangent spaces. Order 2 in the attitude."""
    half, sixth = h / 2, h / 6
    a1 = aba(q, v, 0.0)
    v2 = v + half * a1
    a2 = aba(pin.integrate(model, q, half * v), v2, 0.5)
    v3 = v + half * a2
    a3 = aba(pin.integrate(model, q, half * v2), v3, 0.5)
    v4 = v + h * a3
    a4 = aba(pin.integrate(model, q, h * v3), v4, 1.0)
    return pin.integrate(model, q, sixth * (v + 2 * (v2 + v3) + v4)), v + sixth * (a1 + 2 * (a2 + a3) + a4)


def transport(model: pin.Model, q: Array, there: Array, velocity: Array) -> Array:
    """Return a velocity at the configuration `there` in the tangent space at q.

    The inverse derivative of the exponential map equals Pinocchio's derivative of the difference of two configurations.
    """
    return np.asarray(pin.dDifference(model, q, there, pin.ARG1) @ velocity)


def rk4(
    model: pin.Model, aba: Acceleration, q: Array, v: Array, h: float | Array, transport: Transport = transport
) -> tuple[Array, Array]:
    """Take a step of the Runge-Kutta-Munthe-Kaas method of order 4 (Munthe-Kaas, BIT 38, 1998).

    The velocity of each stage is transported to the tangent space at q. This is the only difference from `rk4_naive`.
    """

    def slope(u: Array, velocity: Array, passed: float) -> tuple[Array, Array]:
        there = pin.integrate(model, q, u)
        return transport(model, q, there, velocity), aba(there, velocity, passed)

    half, sixth = h / 2, h / 6
    u1, a1 = v, aba(q, v, 0.0)
    u2, a2 = slope(half * u1, v + half * a1, 0.5)
    u3, a3 = slope(half * u2, v + half * a2, 0.5)
    u4, a4 = slope(h * u3, v + h * a3, 1.0)
    return pin.integrate(model, q, sixth * (u1 + 2 * (u2 + u3) + u4)), v + sixth * (a1 + 2 * (a2 + a3) + a4)


#: The scheme of each integrator, and whether it integrates the body twist.
SCHEMES: dict[str, tuple[Scheme, bool]] = {
    "semi-implicit-euler": (euler, False),
    "body-twist-euler": (euler, True),
    "rk4": (rk4, True),
    "rk4-naive": (rk4_naive, True),
}


def of_bodies(integrator: str, count: int) -> Scheme:
    """Return the scheme of an integrator for a model of `count` bodies on equal joints that do not affect one another."""
    scheme, _ = SCHEMES[integrator]
    return partial(rk4, transport=_transport_each(count)) if scheme is rk4 and count > 1 else scheme


def _transport_each(count: int) -> Transport:
    """Return `transport` for the velocities of `count` bodies, for which the derivative has a block for each body.

    Only the blocks are multiplied, because zero times the velocity of a body that overflowed would be NaN.
    """

    def transport(model: pin.Model, q: Array, there: Array, velocity: Array) -> Array:
        derivative = pin.dDifference(model, q, there, pin.ARG1).reshape(count, model.nv // count, count, -1)
        return np.asarray(np.einsum("aiaj,aj->ai", derivative, velocity.reshape(count, -1))).ravel()

    return transport
