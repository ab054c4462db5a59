"""The rotation of a free body, from the angular momentum and two world axes in the body frame (heyoka).

In the body frame, a vector that is fixed in space turns backwards: dv/dt = v x Omega for the angular momentum m and for the
axes e1 and e2 of the world, with Omega = J m and the inverse J of the inertia tensor. The third axis is e1 x e2. The frame is
that of the body, whatever its principal axes are. The unit of angular velocity is a power of two, and the unit of time is its
inverse. The unit of angular momentum is the largest moment times the unit of angular velocity.

In a slender body, one mobility is far larger than the others, and its rounding error would exceed the difference between the
others. J is therefore split into c u u^T + R, in which c and u are exact in double precision and R has no large entry; u need
not be exactly along the slender axis for that.
"""

import functools
import math
from dataclasses import dataclass
from typing import Any

import heyoka as hy
import numpy as np

from bodycheck.reference.independent.border import DIGITS, MP, Border, Number, Triple, times
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.integration.heyoka_solver import Equations, integrator, solve
from bodycheck.reference.integration.rotation import Rotation, WideArray


@dataclass(frozen=True)
class Arithmetic:
    """A floating-point type, and the bits of its mantissa where it is heyoka's multiprecision `real`."""

    dtype: Any
    bits: int | None = None

    @property
    def rounding(self) -> float:
        """The relative rounding error of this arithmetic."""
        return float(np.finfo(self.dtype).eps) if self.bits is None else 2.0 ** (1 - self.bits)

    def number(self, value: Number) -> Any:
        """The number of this type that is nearest to a number of a hundred digits."""
        if self.bits is not None:
            return hy.real(MP.nstr(value, DIGITS + 5), self.bits)
        head = float(value)
        return self.dtype(head) + self.dtype(float(value - head))

    @property
    def digits(self) -> int:
        """The number of decimal digits of this arithmetic."""
        return math.ceil(-math.log10(self.rounding))

    def rounded(self, values: WideArray) -> WideArray:
        """Convert numbers of this type to the widest type of NumPy."""
        if self.bits is None:
            return values
        head = values.astype(float)
        return np.asarray(head.astype(np.longdouble) + (values - head).astype(float))

    def array(self, values: Triple) -> WideArray:
        """The numbers of this type that are nearest to numbers of a hundred digits, as an array."""
        return np.array([self.number(value) for value in values])


#: The widest type of NumPy: 80 bits on x86.
EXTENDED = Arithmetic(np.longdouble)


def multiprecision(bits: int) -> Arithmetic:
    """heyoka's arithmetic with a mantissa of `bits` bits, which may hold at most `border.DIGITS` decimal digits."""
    return Arithmetic(hy.real, bits)


def equations() -> Equations:
    """dv/dt = v x J m for v = m, e1, e2. The parameters are the components XX, YY, ZZ, XY, XZ, YZ of R, then u and c."""
    momentum, first, second = (hy.make_vars(*(f"{name}{axis}" for axis in "xyz")) for name in ("m", "a", "b"))
    xx, yy, zz, xy, xz, yz, ux, uy, uz, c = (hy.par[index] for index in range(10))
    x, y, z = momentum
    along = c * (ux * x + uy * y + uz * z)
    omega = (
        xx * x + xy * y + xz * z + ux * along,
        xy * x + yy * y + yz * z + uy * along,
        xz * x + yz * y + zz * z + uz * along,
    )
    return [
        (v[i], v[(i + 1) % 3] * omega[(i + 2) % 3] - v[(i + 2) % 3] * omega[(i + 1) % 3])
        for v in (momentum, first, second)
        for i in range(3)
    ]


@dataclass(frozen=True, eq=False)
class Spinning:
    """A rotation that can be followed in a given arithmetic.

    Attributes
    ----------
    arithmetic
        The arithmetic.
    state
        (9,) m, e1 and e2 at t = 0.
    tensor, rest
        (3, 3) the inertia tensor in units of the largest moment, and R in units of its inverse.
    axis, axial
        u (3,) and c (1,).
    unit
        The unit of angular velocity (rad/s).
    """

    arithmetic: Arithmetic
    state: WideArray
    tensor: WideArray
    rest: WideArray
    axis: WideArray
    axial: WideArray
    unit: float

    def follow(self, instants: WideArray) -> Rotation:
        """Attitudes and angular velocities at times (n,) >= 0 (s) in any order. Raises `OutOfReach`."""
        solver = integrator(equations, self.arithmetic.dtype, self.arithmetic.bits)
        parameters = np.concatenate([self.rest[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]], self.axis, self.axial])
        rows = solve(solver, self.state, parameters, instants * self._number(self.unit))
        momentum, first, second = rows[:, :3], rows[:, 3:6], rows[:, 6:]
        cosines = np.stack([first, second, np.cross(first, second)], axis=1)
        return Rotation(quaternion_of(cosines), self._mobile(momentum) * self._number(self.unit))

    def acceleration(self, angular_velocity: WideArray) -> WideArray:
        """The angular accelerations (n, 3), rad/s^2, at angular velocities (n, 3), rad/s, of this motion."""
        return self._mobile(np.cross(_linear(self.tensor, angular_velocity), angular_velocity))

    def _mobile(self, momentum: WideArray) -> WideArray:
        """The inverse inertia tensor J times vectors (n, 3)."""
        along = momentum[:, :1] * self.axis[0] + momentum[:, 1:2] * self.axis[1] + momentum[:, 2:] * self.axis[2]
        return np.asarray(_linear(self.rest, momentum) + self.axial * along * self.axis)

    def _number(self, value: float) -> Any:
        return self.arithmetic.number(MP.mpf(value))


@functools.lru_cache(maxsize=64)
def spinning(start: Border, arithmetic: Arithmetic) -> Spinning:
    """The rotation of a body from its start, in a given arithmetic."""
    largest = max(start.tensor[axis][axis] for axis in range(3))
    unit = MP.ldexp(1, max(MP.frexp(rate)[1] for rate in start.rates if rate))
    first, second, _ = start.cosines
    tensor = arithmetic.array([entry / largest for row in start.tensor for entry in row]).reshape(3, 3)
    mobility = [[entry * largest for entry in row] for row in start.mobility]
    sizes, axes = np.linalg.eigh(np.array([[float(entry) for entry in row] for row in mobility]))
    c, u = MP.mpf(float(sizes[2])), [MP.mpf(part) for part in axes[:, 2].tolist()]
    rest = [[mobility[i][j] - c * u[i] * u[j] for j in range(3)] for i in range(3)]
    state = [component / (largest * unit) for component in start.momentum] + first + second
    return Spinning(
        arithmetic,
        arithmetic.array(state),
        tensor,
        rest=arithmetic.array([entry for row in rest for entry in row]).reshape(3, 3),
        axis=arithmetic.array(u),
        axial=arithmetic.array([c]),
        unit=float(unit),
    )


def _linear(symmetric: WideArray, vectors: WideArray) -> WideArray:
    """A symmetric matrix (3, 3) times vectors (n, 3)."""
    return np.asarray(vectors[:, :1] * symmetric[0] + vectors[:, 1:2] * symmetric[1] + vectors[:, 2:] * symmetric[2])


def momentum_axis(start: Border, arithmetic: Arithmetic) -> WideArray:
    """The direction (3,) of the angular momentum in the world, which is fixed."""
    momentum = times(start.cosines, start.momentum)
    size = MP.sqrt(sum(component**2 for component in momentum))
    return arithmetic.array([component / size for component in momentum])
