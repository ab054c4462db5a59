"""The start of a coin that rolls on its rim, in units in which its size is near 1, and the recognition of such a scene."""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.contact.problem import NONE, ContactBody, Problem
from bodycheck.reference.errors import NotModelled
from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.kinematics import conjugate, multiply, rotate
from bodycheck.reference.scene import Cylinder
from bodycheck.reference.witness import WideArray

#: The quaternion of half a turn about the axis I, which exchanges the faces.
_TURNED = np.array([0, 1, 0, 0], dtype=Wide)

#: The factors by which half a turn about I multiplies the components of a vector. It is its own inverse.
_SIGNS = np.array([1, -1, -1], dtype=Wide)


@dataclass(frozen=True, eq=False)
class Coin:
    """A coin at t = 0 on the rim on the side of -K.

    The unit of mass is the mass of the coin. The units of length and time are powers of two near its radius and the time that
    it takes to turn or to fall, so that no rounding occurs in the conversion.

    Attributes
    ----------
    radius, half_length
        The radius, and the distance from the centre of mass to the plane of the circle on which it rolls.
    across, along
        The moments of inertia about its diameters and about K.
    gravity
        The gravitational acceleration.
    position, quaternion, spin
        Position (3,) of the centre of mass, attitude (4,) as w, x, y, z, body to plane, and angular velocity (3,) along the
        axes of the body.
    missed_velocity, missed_position
        The differences of the velocity (m/s) and of the height (m) in the scene from those of rolling.
    length, time
        The units (m, s).
    flipped
        Whether the body of the scene is turned by half a turn about I, because it touches the plane on the side of K.
    """

    radius: np.longdouble
    half_length: np.longdouble
    across: np.longdouble
    along: np.longdouble
    gravity: np.longdouble
    position: WideArray
    quaternion: WideArray
    spin: WideArray
    missed_velocity: float
    missed_position: float
    length: np.longdouble
    time: np.longdouble
    flipped: bool

    def as_given(self, quaternion: WideArray, spin: WideArray) -> tuple[WideArray, WideArray]:
        """Convert attitudes (n, 4) and angular velocities (n, 3) of the coin to those of the scene's body, in SI units."""
        if self.flipped:
            quaternion, spin = multiply(quaternion, _TURNED * Wide(-1)), spin * _SIGNS
        return quaternion, spin / self.time


def coin(problem: Problem) -> Coin | None:
    """The coin of a problem, or None if it is not a coin that touches a level plane with a point of its rim.

    Raises `NotModelled` for a coin that slips at its start or whose rim hits or leaves the plane then, and for a coin whose
    moments about its diameters differ.
    """
    if len(problem.bodies) != 1 or problem.plane.incline or problem.pushes or not problem.gravity[2]:
        return None
    body = problem.bodies[0]
    if not isinstance(body.shape, Cylinder):
        return None
    quaternion, spin = body.quaternion, body.spin
    upward = rotate(conjugate(quaternion), np.array([0, 0, 1], dtype=Wide))
    flipped = bool(upward[2] < 0)
    if flipped:
        quaternion, spin, upward = multiply(quaternion, _TURNED), spin * _SIGNS, upward * _SIGNS
    slope, steep = upward[2], np.hypot(upward[0], upward[1])
    if min(slope, steep) <= NONE:
        return None
    radius, half_length = Wide(body.shape.radius), Wide(body.shape.half_length)
    height = half_length * slope + radius * steep
    size = math.hypot(radius, half_length)
    missed_position = float(body.position[2] - height)
    if abs(missed_position) > NONE * size:
        return None
    to_rim = -radius / steep * np.array([upward[0], upward[1], 0], dtype=Wide) - half_length * np.array([0, 0, 1], dtype=Wide)
    missed_velocity = _missed(body, rotate(quaternion, np.cross(to_rim, spin)), float(np.sqrt(spin @ spin)) * size)
    return _scaled(
        body, problem, (radius, half_length, height), quaternion, spin, missed_velocity, abs(missed_position), flipped
    )


def _missed(body: ContactBody, rolling: WideArray, rim_speed: float) -> float:
    """The difference (m/s) of the velocity of a body from the velocity of rolling, `rolling`.

    rim_speed: the speed of the rim relative to the centre of mass (m/s). Raises `NotModelled` if the body does not roll, or its
    moments about its diameters differ.
    """
    missed = body.velocity - rolling
    if abs(float(missed[2])) > NONE * rim_speed:
        raise NotModelled(f"a coin whose rim hits the plane or leaves it at its start, with {abs(float(missed[2])):.3g} m/s")
    if (slip := math.hypot(missed[0], missed[1])) > NONE * rim_speed:
        raise NotModelled(f"a coin that slips at its start: its rim moves along the plane with {slip:.3g} m/s")
    if body.moments[0] != body.moments[1]:
        first, second = float(body.moments[0]), float(body.moments[1])
        raise NotModelled(f"a coin whose moments about its diameters differ: {first:.17g} and {second:.17g} kg m^2")
    return float(np.sqrt(missed @ missed))


def _scaled(
    body: ContactBody,
    problem: Problem,
    sizes: tuple[np.longdouble, np.longdouble, np.longdouble],
    quaternion: WideArray,
    spin: WideArray,
    missed_velocity: float,
    missed_position: float,
    flipped: bool,
) -> Coin:
    """A coin in its units. sizes: its radius, half its length, and the height of its centre of mass (m)."""
    radius, half_length, height = sizes
    gravity = -problem.gravity[2]
    rate = np.sqrt(gravity / radius) + np.sqrt(spin @ spin)
    length, time = (Wide(2) ** np.rint(np.log2(value)) for value in (radius, 1 / rate))
    moments = body.moments / body.mass / (length * length)
    return Coin(
        radius / length,
        half_length / length,
        moments[0],
        moments[2],
        gravity * time * time / length,
        np.array([body.position[0], body.position[1], height], dtype=Wide) / length,
        quaternion,
        spin * time,
        missed_velocity,
        missed_position,
        length,
        time,
        flipped,
    )
