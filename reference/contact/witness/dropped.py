"""The witness of a body that falls on the plane: free flight until the first touch, from the second closed form.

The rotation is that of `independent.closed_form`, and the centre of mass moves along a parabola. The touch is searched with a
bound of second order. With n the normal, g the gravitational acceleration along it, x the position, v the velocity and w the
angular velocity at an instant, and A a bound of the acceleration that the rotation gives any point of the body, no point of the
body is after the time s lower than

    n . (x + s v) - g s^2 / 2 - (extent of the body along n + s n x w) - A s^2 / 2.

This is a concave function of s, so that no touch lies between two instants if it is positive at both.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.witness.faces import DECIMALS, wide_vector
from bodycheck.reference.contact.witness.reading import FreeBody, bodies, surface
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.independent.arithmetic import WIDE_EPS, Real, Wide
from bodycheck.reference.independent.border import MP
from bodycheck.reference.independent.closed_form import rotation
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Brick, Cylinder, Ellipsoid, Shape
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import Instant, WideArray, Witness

#: Name of the way in results.
NAME = "parabola and second closed form, bound of second order of the gap"

#: The number of roundings of a state in the wide type, relative to its largest terms.
ROUNDINGS = 16.0

#: The number of parts into which an interval is divided in the search for the touch, and the largest number of divisions.
PARTS, MOST = 128, 400

#: The factor by which the bound of accelerations is enlarged, since it is computed in doubles.
ENLARGED = 1.001


@dataclass(frozen=True, eq=False)
class Fall:
    """A body that falls.

    Attributes
    ----------
    body
        The body.
    shape
        Its shape.
    normal
        (3,) the normal of the plane, world frame.
    gravity
        (3,) the gravitational acceleration, world frame (m/s^2).
    centrifugal
        A bound of the acceleration that the rotation gives any point of the body (m/s^2).
    """

    body: FreeBody
    shape: Shape
    normal: WideArray
    gravity: WideArray
    centrifugal: float

    def flight(self, times: Array) -> Witness:
        """The free flight at times (n,), s."""
        position, velocity = (wide_vector(part) for part in (self.body.position, self.body.velocity))
        t, pull = times.astype(Wide)[:, None], self.gravity
        speed = float(np.sqrt((velocity * velocity).sum())) + float(np.sqrt((pull * pull).sum())) * times
        size = float(np.sqrt((position * position).sum())) + speed * times
        return replace(
            rotation(self.body.tensor, self.body.cosines, self.body.rates, times),
            name=NAME,
            position=position + t * (velocity + (velocity + t * pull)) / 2,
            velocity=velocity + t * pull,
            position_error=ROUNDINGS * WIDE_EPS * size,
            velocity_error=ROUNDINGS * WIDE_EPS * speed,
        )

    def lowest(self, flight: Witness, after: float) -> WideArray:
        """The bounds (n,) of the height of the lowest point (m), a time `after` (s) after the states of a flight.

        For the time 0 they are the heights themselves.
        """
        assert flight.position is not None
        assert flight.velocity is not None
        assert flight.quaternion is not None
        assert flight.angular_velocity is not None
        s, normal = Wide(after), self.normal
        cosines = _cosines(flight.quaternion)
        along_axes = normal @ cosines
        direction = along_axes + s * np.cross(along_axes, flight.angular_velocity)
        height = (flight.position + s * flight.velocity) @ normal
        bent = (self.gravity @ normal - Wide(self.centrifugal)) * s * s / 2
        return np.asarray(height + bent - extent(self.shape, direction))


def second(scene: AnyScene, times: Array) -> Witness | None:
    """The motion of a body that falls on the plane, at ascending times (n,) >= 0 (s), until it touches it.

    Returns None for a scene of another kind, also for a body that touches the plane at the start. Raises `OutOfReach` if the
    touch is not found.
    """
    fall = _fall(scene)
    if fall is None:
        return None
    touch = _touch(fall, float(np.max(times, initial=0.0)))
    flight = fall.flight(times)
    known = np.full(len(times), True) if touch is None else times < touch.time - touch.error
    quaternion, spin, position, velocity = (
        np.where(known[:, None], states, Wide(np.nan))[None]
        for states in (flight.quaternion, flight.angular_velocity, flight.position, flight.velocity)
        if states is not None
    )
    return replace(
        flight,
        quaternion=quaternion,
        angular_velocity=spin,
        position=position,
        velocity=velocity,
        events=() if touch is None else (touch,),
    )


def _fall(scene: AnyScene) -> Fall | None:
    """The body that falls, or None."""
    free, plane = bodies(scene), surface(scene)
    if len(free) != 1 or scene.pushes or not isinstance(free[0].shape, Brick | Cylinder | Ellipsoid):
        return None
    (body,) = free
    gravity = wide_vector((MP.zero, MP.zero, -MP.mpf(scene.gravity)))
    fall = Fall(body, free[0].shape, wide_vector(plane.normal), gravity, _centrifugal(body, free[0].shape))
    start = fall.flight(np.zeros(1))
    assert start.position is not None
    gap, height = (float(values[0]) for values in (fall.lowest(start, 0.0), start.position @ fall.normal))
    return fall if gap > DECIMALS * (height - gap) else None


def _centrifugal(body: FreeBody, shape: Shape) -> float:
    """The bound of the acceleration that the rotation of a body gives any of its points (m/s^2).

    Energy and angular momentum do not change, which bounds each component of the angular velocity; its rate of change follows
    from Euler's equations.
    """
    rates, moments = body.rates, [body.tensor[each][each] for each in range(3)]
    if any(body.tensor[i][j] for i in range(3) for j in range(3) if i != j):
        raise NotModelled("a body on a plane whose frame is not that of its principal axes")
    square = sum(moment**2 * rate**2 for moment, rate in zip(moments, rates, strict=True))
    twice_energy = sum(moment * rate**2 for moment, rate in zip(moments, rates, strict=True))

    def fastest(moment: Real) -> float:
        bounds = [twice_energy / moment]
        for extreme in (min(moments), max(moments)):
            if extreme != moment:  # this component takes at most the whole of this invariant
                bounds.append((twice_energy * extreme - square) / (moment * (extreme - moment)))
        return float(MP.sqrt(max(min(bounds), MP.zero)))

    w = np.array([fastest(moment) for moment in moments])
    j, k = np.array([1, 2, 0]), np.array([2, 0, 1])
    a, reach = np.array([float(moment) for moment in moments]), extent(shape, np.eye(3, dtype=Wide)).astype(float)
    turning = np.abs(a[j] - a[k]) / a * w[j] * w[k]
    pulled = (w[j] ** 2 + w[k] ** 2) * reach + w * (w[j] * reach[j] + w[k] * reach[k])
    return ENLARGED * float(np.linalg.norm(pulled + turning[j] * reach[k] + turning[k] * reach[j]))


def extent(shape: Shape, directions: WideArray) -> WideArray:
    """The largest scalar products (n,) of the points of a shape and directions (n, 3) along its axes, of any length."""
    match shape:
        case Brick(semi_axes):
            return np.asarray(np.abs(directions) @ np.array(semi_axes, dtype=Wide))
        case Ellipsoid(semi_axes):
            stretched = directions * np.array(semi_axes, dtype=Wide)
            return np.asarray(np.sqrt((stretched * stretched).sum(axis=1)))
        case Cylinder(radius, half_length):
            across = np.hypot(directions[:, 0], directions[:, 1])
            return np.asarray(Wide(radius) * across + Wide(half_length) * np.abs(directions[:, 2]))
        case _:
            raise TypeError(shape)  # excluded by the caller


def _touch(fall: Fall, until: float) -> Instant | None:
    """The first touch until an instant (s), or None."""
    waiting, divisions = [(0.0, until)] if until else [], 0
    while waiting:
        begin, end = waiting.pop()
        divisions += 1
        if divisions > MOST:
            raise OutOfReach("the first touch of a body that comes close to the plane again and again is not found")
        times = np.linspace(begin, end, PARTS + 1)
        flight = fall.flight(times)
        safe = (fall.lowest(flight, 0.0) > 0) & (fall.lowest(flight, (end - begin) / PARTS * (1 + 4 * EPS)) > 0)
        unsafe = np.flatnonzero(~safe[:-1])
        if not len(unsafe):
            continue
        first = int(unsafe[0])
        inner = float(times[first]), float(times[first + 1])
        if inner[1] - inner[0] <= 4 * EPS * inner[1]:
            return _instant(fall, inner[1])
        if inner[1] < end:
            waiting.append((inner[1], end))
        waiting.append(inner)
    return None


def _instant(fall: Fall, time: float) -> Instant:
    """The touch at an instant (s), with the error from those of the height and from the speed at which it decreases."""
    step = max(time, 1e-3) * 1e-6
    flight = fall.flight(np.array([max(time - step, 0.0), time]))
    before, after = fall.lowest(flight, 0.0).astype(float)
    size = float(np.max(extent(fall.shape, np.eye(3, dtype=Wide))))
    error = float(np.max(flight.position_error)) + 2 * size * float(np.max(flight.error))
    closing = max((before - after) / step, math.sqrt(2 * error * (float(np.abs(fall.gravity).max()) + fall.centrifugal)))
    return Instant("impact", time, float(8 * EPS * time + 2 * error / max(closing, np.finfo(float).tiny)))


def _cosines(quaternion: WideArray) -> WideArray:
    """The matrices of direction cosines (n, 3, 3) of unit quaternions (n, 4)."""
    w, x, y, z = quaternion.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
