"""A second closed form of the flight without drag, which shares no formula and no code with the truth.

The parabola of the centre of mass is a witness of every flight. The rotation replaces the integrations where they cannot follow
the motion: after many turns, near the separatrix, and in bodies that are nearly symmetric. Its cost does not depend on the
motion.

With the principal moments I1 <= I2 <= I3 along a right-handed set of axes, and the angular momentum L in the frame of the body,

    Lp = Mp dn u,   L2 = M2 sn u,   Lr = Mr cn u,   u = u0 + lambda t,

where p is the axis 1 or 3 that L encircles and r is the other of these two axes (Landau and Lifshitz, Mechanics, par. 37). The
attitude follows from the precession of the line of nodes n = L x f / |L x f| about L, where f is one of the axes 1 and 3 and g
is the other:

    dphi/dt = |L| (L2^2/I2 + Lg^2/Ig) / (L2^2 + Lg^2) = steady - swing cn^2 u / (1 + nu sn^2 u),
    steady = |L|/Ig + swing,   swing = |L| (1/I2 - 1/Ig) (M2/Mg)^2 / (1 + nu),   nu = (M2/Mg)^2 - (k^2 if g = p, otherwise 1).

The second term is integrated by quadrature over half a period; see `swing`. For the f chosen here, 0 <= nu <= 1. All
constants are formed with a hundred digits. A body with two equal moments is the case k = 0, and the separatrix is k' = 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.independent.arithmetic import (
    ROUNDED,
    WIDE_EPS,
    Matrix,
    Real,
    Vector,
    Wide,
    WideArray,
    applied,
    cross,
    norm,
    product,
    scaled,
    transposed,
    turns,
    wide,
    wide_matrix,
)
from bodycheck.reference.independent.border import MP, border
from bodycheck.reference.independent.directions import quaternion_of
from bodycheck.reference.independent.jacobi import Modulus, argument, functions, modulus
from bodycheck.reference.independent.principal_axes import principal_axes
from bodycheck.reference.independent.swing import integrated, swing
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Witness

#: Name of the way in results.
NAME = "second closed form, numpy"

#: Error (rad) of the matrices that are multiplied and of their conversion; the largest observed is 5 roundings.
ROUNDINGS = 64 * WIDE_EPS

#: Roundings of a sum of three terms, each of a few factors.
PARABOLA_ROUNDINGS = 8.0

#: Error of u for each unit of the quarter period, and of the angle of the swings for each radian of it; the largest observed is
#: 3.5 roundings.
PER_UNIT = 16 * WIDE_EPS


@dataclass(frozen=True, eq=False)
class Polhode:
    """The motion of the angular momentum in the body, with the symbols of the module; axes are counted from 0.

    Attributes
    ----------
    moments
        I1 <= I2 <= I3 (kg m^2).
    momentum
        The angular momentum at t = 0 along the principal axes (kg m^2/s).
    p
        Index of the axis p, 0 or 2.
    size
        M1, M2, M3 (kg m^2/s), each with the sign of the component where sn u and cn u are positive.
    rate
        lambda (1/s).
    modulus
        The modulus of the elliptic functions.
    start
        u0, in [-K, K].
    k2
        k^2.
    """

    moments: Vector
    momentum: Vector
    p: int
    size: Vector
    rate: Real
    modulus: Modulus
    start: Real
    k2: Real


@dataclass(frozen=True, eq=False)
class Turned:
    """A rotation at n instants, along principal axes.

    Attributes
    ----------
    cosines
        (n, 3, 3) matrices from the principal axes at these instants to the principal axes at t = 0.
    rates
        (n, 3) angular velocity along the principal axes (rad/s).
    error
        (n,) bounds of the errors of the matrices (rad).
    rates_error
        Bound of the error of the angular velocity (rad/s).
    """

    cosines: WideArray
    rates: WideArray
    error: Array
    rates_error: float


def witness(scene: Scene, times: Array) -> Witness:
    """The rotation of a body in free flight at times (n,) in any order, s, by the second closed form.

    The attitude and the angular velocity are given in the frame of the body of the scene.
    """
    begin = border(scene)
    return rotation(begin.tensor, begin.cosines, begin.rates, times)


def rotation(tensor: Matrix, cosines: Matrix, rates: Vector, times: Array) -> Witness:
    """The rotation of a free body at times (n,) in any order, s, from its start.

    Parameters
    ----------
    tensor
        Rows of the inertia tensor about the centre of mass, in the frame of the body (kg m^2).
    cosines
        Rows of the matrix of direction cosines at t = 0, body to world components.
    rates
        Angular velocity at t = 0, in the frame of the body (rad/s).
    times
        The times (s).
    """
    moments, axes = principal_axes(tensor)
    turned = _turned(moments, _along(axes, rates), times)
    to_body = wide_matrix(axes)
    before = wide_matrix(product(cosines, transposed(axes)))
    return Witness(
        NAME,
        quaternion=quaternion_of(before @ turned.cosines @ to_body),
        angular_velocity=turned.rates @ to_body,
        error=turned.error,
        angular_velocity_error=turned.rates_error,
        digits=np.finfo(Wide).precision + 1,
    )


def _turned(moments: Vector, rates: Vector, times: Array) -> Turned:
    """The rotation of a body with principal moments and an angular velocity along its principal axes (rad/s) at t = 0."""
    if len({moment for moment, rate in zip(moments, rates, strict=True) if rate}) <= 1:
        return _steady(rates, times)
    return _tumbling(_polhode(moments, rates), times)


def _along(axes: Matrix, rates: Vector) -> Vector:
    """The components of an angular velocity along principal axes; rounding errors of zero are set to zero.

    A component along an axis of the body frame has no rounding error, and is kept however small it is.
    """
    limit = ROUNDED * max(abs(rate) for rate in rates)
    rounded = [sum(bool(component) for component in axis) > 1 for axis in axes]
    x, y, z = (
        MP.zero if inexact and abs(component) <= limit else component
        for component, inexact in zip(applied(axes, rates), rounded, strict=True)
    )
    return x, y, z


def _steady(rates: Vector, times: Array) -> Turned:
    """A steady turn about an axis, or no rotation: R = 1 + sin(a) [n] + (1 - cos(a)) [n]^2."""
    speed = norm(rates)
    x, y, z = scaled(rates, 1 / speed) if speed else rates
    skew = wide_matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    _, part = turns(MP.zero, speed / (2 * MP.pi), times)
    half = np.sin(wide(MP.pi) * part)[:, None, None]
    sine = np.sin(wide(2 * MP.pi) * part)[:, None, None]
    cosines = np.eye(3, dtype=Wide) + sine * skew + 2 * half * half * (skew @ skew)
    constant = np.tile(wide_matrix([rates]), (len(times), 1))
    return Turned(cosines, constant, np.full(len(times), ROUNDINGS), ROUNDINGS * float(speed))


def _polhode(moments: Vector, rates: Vector) -> Polhode:
    """The polhode of an angular velocity along the principal axes (rad/s), of a body that does not turn steadily."""
    (i1, i2, i3), (w1, w2, w3) = moments, rates
    low, high, span = i2 - i1, i3 - i2, i3 - i1
    over, under = i3 * high * w3 * w3, i1 * low * w1 * w1
    # L^2 - 2 T I of each moment I, with its sign.
    e1, e2, e3 = i2 * low * w2 * w2 + i3 * span * w3 * w3, over - under, i1 * span * w1 * w1 + i2 * high * w2 * w2
    if abs(e2) <= ROUNDED * (over + under):
        e2 = MP.zero
    momentum = (i1 * w1, i2 * w2, i3 * w3)
    p, ep, er, apart, other = (2, e3, e1, high, low) if e2 >= 0 else (0, e1, e3, low, high)
    r = 2 - p
    size = [MP.sqrt(i2 * ep / apart)] * 3
    size[p], size[r] = MP.sqrt(moments[p] * er / span), MP.sqrt(moments[r] * ep / span)
    signs = [1 if component >= 0 else -1 for component in momentum]
    signs[1] = signs[0] * signs[2]  # dL2/dt = (1/I1 - 1/I3) L3 L1
    elliptic_modulus = modulus(MP.sqrt(span * abs(e2) / (apart * er)))
    x, y, z = (sign * each for sign, each in zip(signs, size, strict=True))
    return Polhode(
        moments=moments,
        momentum=momentum,
        p=p,
        size=(x, y, z),
        rate=MP.sqrt(apart * er / (i1 * i2 * i3)),
        modulus=elliptic_modulus,
        start=argument(elliptic_modulus, momentum[1] / y, momentum[r] / (x, y, z)[r]),
        k2=other * ep / (apart * er),
    )


def _tumbling(motion: Polhode, times: Array) -> Turned:
    """Return the rotation of a body whose angular momentum moves along a polhode."""
    i, size, length = motion.moments, motion.size, norm(motion.momentum)
    f = 2 if i[2] * (i[1] - i[0]) <= i[0] * (i[2] - i[1]) else 0
    g = 2 - f
    square = (size[1] / size[g]) ** 2
    nu = square - (motion.k2 if g == motion.p else 1)
    depth = length * (1 / i[1] - 1 / i[g]) * square / (1 + nu)
    course = swing(motion.modulus, wide(nu))

    half_periods, u = _arguments(motion, np.concatenate(([0.0], times)))
    sn, cn, dn = functions(motion.modulus, u)
    parity = 1 - 2 * np.mod(half_periods, 2)
    elliptic = [parity * sn] * 3
    elliptic[motion.p], elliptic[2 - motion.p] = dn, parity * cn

    swings = wide(depth / motion.rate) * (2 * course.total * half_periods + integrated(course, u))
    _, steady = turns(MP.zero, (length / i[g] + depth) / (2 * MP.pi), times)
    angle = wide(2 * MP.pi) * steady - (swings[1:] - swings[0])

    relative = [wide(each / length) for each in size]
    nodes = _nodes(relative, [part[1:] for part in elliptic], f)
    first = wide_matrix(_first_nodes(scaled(motion.momentum, 1 / length), f))
    cosines = first.T @ _about_momentum(angle) @ nodes
    amplitude = [wide(each / moment) for each, moment in zip(size, i, strict=True)]
    rates = np.column_stack([each * part[1:] for each, part in zip(amplitude, elliptic, strict=True)])
    reach = PER_UNIT * float(min(motion.modulus.quarter, 1 + abs(motion.start)))
    each_swing = abs(float(depth / motion.rate * course.total))
    return Turned(
        cosines,
        rates,
        (ROUNDINGS + reach) * (1 + each_swing) + 2 * PER_UNIT * each_swing * np.abs(half_periods[1:]).astype(float),
        (ROUNDINGS + reach) * float(np.linalg.norm(np.array(amplitude, dtype=float))),
    )


def _arguments(motion: Polhode, times: Array) -> tuple[WideArray, WideArray]:
    """Whole numbers of half periods 2 K (n,), and the remainder (n,) of u, in [-K, K], at times (n,), s."""
    if not motion.modulus.mean:
        return np.zeros(len(times), dtype=Wide), wide(motion.start) + wide(motion.rate) * times.astype(Wide)
    period = 2 * motion.modulus.quarter
    count, part = turns(motion.start / period, motion.rate / period, times)
    return count, wide(period) * part


def _nodes(size: Sequence[np.longdouble], elliptic: Sequence[WideArray], f: int) -> WideArray:
    """Matrices (n, 3, 3) whose rows are n, l x n and l along the principal axes, l being the direction of L.

    size: M1, M2, M3 over |L|. elliptic: the elliptic functions (n,) of L1, L2, L3.
    """
    g = 2 - f
    across = np.hypot(size[1] * elliptic[1], size[g] * elliptic[g])
    l2, lg, lf = (size[axis] * elliptic[axis] for axis in (1, g, f))
    c2, cg = l2 / across, lg / across
    rows = np.zeros((len(lf), 3, 3), dtype=Wide)
    sense = 1 if f == 2 else -1  # l x f = (l2, -l1, 0) or (0, l3, -l2)
    rows[:, 0, g], rows[:, 0, 1] = sense * c2, -sense * cg
    rows[:, 1, g], rows[:, 1, 1], rows[:, 1, f] = cg * lf, c2 * lf, -across
    rows[:, 2, g], rows[:, 2, 1], rows[:, 2, f] = lg, l2, lf
    return rows


def _first_nodes(direction: Vector, f: int) -> Matrix:
    """The rows n, l x n and l along the principal axes for a direction l of L that is not along f."""
    node = cross(direction, (MP.mpf(f == 0), MP.zero, MP.mpf(f == 2)))
    node = scaled(node, 1 / norm(node))
    return node, cross(direction, node), direction


def _about_momentum(angle: WideArray) -> WideArray:
    """Matrices (n, 3, 3) of turns by angles (n,), rad, about the third axis."""
    matrices = np.zeros((len(angle), 3, 3), dtype=Wide)
    matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(angle)
    matrices[:, 1, 0] = np.sin(angle)
    matrices[:, 0, 1] = -matrices[:, 1, 0]
    matrices[:, 2, 2] = 1
    return matrices


def parabola(scene: Scene, times: Array) -> tuple[WideArray, WideArray, Array, Array]:
    """Positions (n, 3), m, and velocities (n, 3), m/s, world frame, at times (n,), s, in NumPy's widest type, without drag.

    The path is the time multiplied by the mean of the first and the last velocity. The last two results are bounds (n,) of the
    errors of position (m) and velocity (m/s).
    """
    wide = np.longdouble
    t = times.astype(wide)[:, None]
    first = np.array(scene.initial.velocity, dtype=wide)
    last = np.tile(first, (len(times), 1))
    last[:, 2] -= t[:, 0] * wide(scene.gravity)
    position = np.array(scene.initial.position, dtype=wide) + t * ((first + last) / 2)
    rounding = PARABOLA_ROUNDINGS * float(np.finfo(wide).eps)
    speed = np.linalg.norm(scene.initial.velocity) + scene.gravity * times
    reach = np.linalg.norm(scene.initial.position) + speed * times
    return position, last, np.asarray(rounding * reach), np.asarray(rounding * speed)
