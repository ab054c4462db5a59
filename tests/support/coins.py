"""Coins that roll on their rims, as scenes."""

import math
from typing import Any

import numpy as np

from bodycheck.reference.contact.coin.start import Coin, coin
from bodycheck.reference.contact.problem import problem
from bodycheck.reference.kinematics import conjugate, quaternion_from_euler, rotate
from bodycheck.reference.scene import Body, Cylinder, Plane, Scene, State, vector_of
from bodycheck.reference.trajectory import Array

#: A coin of 5 cm radius and 1 cm thickness (m, kg), and the gravity (m/s^2).
RADIUS, HALF_LENGTH, MASS, GRAVITY = 0.05, 0.005, 0.02, 9.81


def body(radius: float = RADIUS, half_length: float = HALF_LENGTH, mass: float = MASS) -> Body:
    """A homogeneous coin."""
    across = mass * (radius**2 / 4 + half_length**2 / 3)
    return Body(mass, (across, across, mass * radius**2 / 2), Cylinder(radius, half_length))


def rolling(
    tilt: float,
    rates: tuple[float, float, float],
    *,
    friction: float = math.inf,
    coin: Body | None = None,
    phi: float = 0.3,
    psi: float = 0.7,
) -> Scene:
    """A coin that rolls with a tilt (rad) and the rates p, q, s (rad/s) along n, e and K; see `contact.coin.angles`."""
    coin = coin or body()
    shape = coin.shape
    assert isinstance(shape, Cylinder)
    quaternion = np.asarray(quaternion_from_euler(*(np.float64(angle) for angle in (phi, tilt, psi))))
    p, q, s = rates
    spin = np.array([p * math.cos(psi) + q * math.sin(psi), q * math.cos(psi) - p * math.sin(psi), s])
    height = shape.half_length * math.cos(tilt) + shape.radius * math.sin(tilt)
    velocity = rotate(quaternion, np.cross(to_rim(quaternion, shape), spin))
    state = State((0.0, 0.0, height), _quadruple(quaternion), vector_of(velocity), vector_of(spin))
    return Scene(coin, state, GRAVITY, Plane(friction))


def to_rim(quaternion: Array, shape: Cylinder) -> Array:
    """The vector (3,) from the centre of mass to the lowest point, along the axes of the body."""
    up = rotate(conjugate(quaternion), np.array([0.0, 0.0, 1.0]))
    steep = math.hypot(up[0], up[1])
    side = math.copysign(shape.half_length, up[2])
    return np.array([-shape.radius * up[0] / steep, -shape.radius * up[1] / steep, -side])


def as_coin(scene: Scene) -> Coin:
    """The coin of a scene in its units."""
    found = coin(problem(scene))
    assert found is not None
    return found


def _quadruple(values: Any) -> tuple[float, float, float, float]:
    w, x, y, z = (float(value) for value in values)
    return w, x, y, z
