"""The numbers of a mechanism in exact arithmetic: inertia, frames of joints, and the initial states of free bodies.

The truth starts from these numbers. Its witness does not use them: its code is separate and starts from the numbers of the
file. The functions import the exact arithmetic only when they are called, because processes of engines and commands import this
module and seldom have a mechanism.
"""

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bodycheck.reference.mechanisms.mechanism import Joint, JointedBody
from bodycheck.reference.scene import Attitude, EulerRates, Quaternion, Tensor, Vector

if TYPE_CHECKING:
    from bodycheck.reference.exact.inertia import Components
    from bodycheck.reference.exact.numbers import Quaternion4, Real, Vector3


@dataclass(frozen=True, eq=False)
class Inertia:
    """Mass (kg), centre of mass in the body's frame (m), inertia about the centre of mass along the body's axes (kg m^2)."""

    mass: "Real"
    centre: "Vector3"
    tensor: "Components"


@functools.lru_cache(maxsize=1024)
def inertia(body: JointedBody) -> Inertia:
    """The inertia of a body."""
    from bodycheck.reference.exact.inertia import mass_properties
    from bodycheck.reference.exact.numbers import vector

    properties = mass_properties(body.inertia)
    centre = vector(body.center_of_mass) if isinstance(body.inertia, Tensor) else properties.centre
    return Inertia(properties.mass, centre, properties.tensor)


def has_zero_moment(body: JointedBody) -> bool:
    """Return whether a principal moment of a body, and so the determinant of its inertia tensor, is zero."""
    from bodycheck.reference.exact.numbers import NEGLIGIBLE

    xx, yy, zz, xy, xz, yz = inertia(body).tensor
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return bool(abs(determinant) <= NEGLIGIBLE * (xx + yy + zz) ** 3)


@dataclass(frozen=True)
class NearestInertia:
    """The doubles that are nearest to the numbers of an `Inertia`; the tensor is XX, YY, ZZ, XY, XZ, YZ."""

    mass: float
    centre: Vector
    tensor: tuple[float, float, float, float, float, float]


@functools.lru_cache(maxsize=1024)
def nearest_inertia(body: JointedBody) -> NearestInertia:
    """The doubles that are nearest to the inertia of a body; the engines receive these."""
    from bodycheck.reference.exact.numbers import doubles

    exact_inertia = inertia(body)
    (x, y, z), (xx, yy, zz, xy, xz, yz) = doubles(exact_inertia.centre), doubles(exact_inertia.tensor)
    return NearestInertia(float(exact_inertia.mass), (x, y, z), (xx, yy, zz, xy, xz, yz))


@functools.lru_cache(maxsize=1024)
def unit_axis(joint: Joint) -> "Vector3":
    """The unit axis of a joint, in the joint's frame."""
    from bodycheck.reference.exact.numbers import MP, vector

    x, y, z = vector(joint.axis)
    square = x * x + y * y + z * z
    if square == 1:
        return x, y, z
    length = MP.sqrt(square)
    return x / length, y / length, z / length


def nearest_axis(joint: Joint) -> Vector:
    """The doubles that are nearest to the unit axis of a joint, in the joint's frame."""
    from bodycheck.reference.exact.numbers import doubles

    x, y, z = doubles(unit_axis(joint))
    return x, y, z


@functools.lru_cache(maxsize=1024)
def turn(orientation: Attitude) -> "Quaternion4":
    """The unit quaternion (w, x, y, z) of an attitude."""
    from bodycheck.reference.exact.rotations import attitude

    return attitude(orientation)


def nearest_turn(orientation: Attitude) -> Quaternion:
    """The doubles that are nearest to the unit quaternion (w, x, y, z) of an attitude."""
    from bodycheck.reference.exact.numbers import doubles

    w, x, y, z = doubles(turn(orientation))
    return w, x, y, z


def rates(orientation: Attitude, rotation: Vector | EulerRates) -> "Vector3":
    """The angular velocity (rad/s) of a free body in the body's frame, from the attitude and rotation that the file gives."""
    from bodycheck.reference.exact.numbers import vector
    from bodycheck.reference.exact.rotations import body_rates

    return body_rates(orientation, rotation) if isinstance(rotation, EulerRates) else vector(rotation)
