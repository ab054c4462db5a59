"""Translation of a body with quadratic drag, m dv/dt = -m g k - c |v| v [G 2.45a-c with a generalized force], and its error.

The motion is that of the exact doubles of the scene. It is composed of exact solutions, each used where it has the accuracy of
the wide type: a parabola while drag has no effect, a straight path while gravity has no effect, a vertical path where the
horizontal speed has no effect on the drag, and otherwise the quadratures of `hodograph`.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.exact.numbers import Wide
from bodycheck.reference.flight.drag.antiderivative import Floats
from bodycheck.reference.flight.drag.hodograph import curved
from bodycheck.reference.flight.drag.straight import coasting, continued, vertical
from bodycheck.reference.flight.elliptic import WideArray
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: Time plus initial speed, without dimension, up to which drag changes velocity and position by less than 1e-20 of their size.
UNBRAKED = 1e-10

#: Speed, in terminal speeds, above which gravity changes velocity and position by less than 1e-22 of their size.
FASTEST = Wide(1e11)

#: Horizontal speed, relative to the larger of the terminal and the initial speed, below which its effect on the drag, which is
#: of second order, is below 1e-22.
PASSIVE = 1e-11

#: Relative error of lengths, times and speeds in the wide type: some tens of roundings, with a margin.
WIDE_ERROR = 64 * float(np.finfo(Wide).eps)

#: Largest relative error of a rounding to double precision, and largest absolute error for a subnormal number.
ROUNDING, SUBNORMAL = 2.0**-53, 2.0**-1074


@dataclass(frozen=True, eq=False)
class Motion:
    """A translation at n instants, in the wide type, with its error.

    Attributes
    ----------
    position
        (n, 3) positions in the world frame (m).
    velocity
        (n, 3) velocities in the world frame (m/s).
    position_error
        (n,) error of the positions (m).
    velocity_error
        (n,) error of the velocities (m/s).
    """

    position: WideArray
    velocity: WideArray
    position_error: Array
    velocity_error: Array


def motion(scene: Scene, times: Array) -> Motion:
    """The translation of a scene at times (n,) >= 0, s, in any order; its errors are bounds, without the rounding to double.

    The bounds follow from relative errors of time, of path and of speed in the wide type: an error of time changes the position
    by |v| times this error and the velocity by |dv/dt| times this error.
    """
    t, resistance, gravity = times.astype(Wide), Wide(scene.drag) / Wide(scene.body.mass), Wide(scene.gravity)
    start, velocity = (np.array(part, dtype=Wide) for part in (scene.initial.position, scene.initial.velocity))
    moved, moving, path = _displacement(resistance, gravity, velocity, t)
    speed = sizes(moving)
    reach = sizes(start) + path + speed * t
    across = resistance * speed * np.hypot(moving[:, 0], moving[:, 1])
    change = speed + np.hypot(across, gravity + resistance * speed * moving[:, 2]) * t
    return Motion(start + moved, moving, _error(reach), _error(change))


def sizes(vectors: Floats) -> Floats:
    """Lengths (...,) of vectors (..., 3), computed without overflow of their squares."""
    return np.asarray(np.hypot(np.hypot(vectors[..., 0], vectors[..., 1]), vectors[..., 2]))


def _error(size: WideArray) -> Array:
    """Bound (n,) of the error of numbers of the given sizes (n,) in the wide type."""
    return np.asarray(WIDE_ERROR * size.astype(float) + SUBNORMAL)


def _displacement(resistance: Wide, gravity: Wide, velocity: WideArray, t: WideArray) -> tuple[WideArray, WideArray, WideArray]:
    """Displacement (n, 3), m, velocity (n, 3), m/s, and length of the path (n,), m, or a bound of it."""
    along = np.hypot(velocity[0], velocity[1])
    speed = np.hypot(along, velocity[2])
    fall = np.array([0, 0, -gravity], dtype=Wide)
    free = velocity + t[:, None] * fall / 2, velocity + t[:, None] * fall
    parabola = t[:, None] * free[0], free[1], t * (speed + gravity * t)
    if resistance == 0 or (gravity == 0 and speed == 0):
        return parabola
    unit = np.sqrt(gravity) / np.sqrt(resistance) if gravity else speed
    length = 1 / resistance
    elapsed = t * resistance * unit
    climb = velocity[2] / unit
    course = thrown(along / unit, climb, elapsed) if gravity else coasting(along / unit, climb, elapsed)
    direction = velocity[:2] / along if along else np.zeros(2, dtype=Wide)
    unbraked = elapsed + speed / unit <= UNBRAKED
    moved = length * np.column_stack([course[0][:, None] * direction, course[1]])
    moving = unit * np.column_stack([course[3][:, None] * direction, course[4]])
    return (
        np.where(unbraked[:, None], parabola[0], moved),
        np.where(unbraked[:, None], parabola[1], moving),
        np.where(unbraked, parabola[2], length * course[2]),
    )


def thrown(along: Wide, climb: Wide, times: WideArray) -> WideArray:
    """The course (5, n), defined in `straight`, with gravity and drag, from any horizontal speed and upward velocity."""
    speed = np.hypot(along, climb)
    if speed > FASTEST:
        slowing = 1 / FASTEST - 1 / speed
        end = coasting(along, climb, slowing[None])
        rest = thrown_slower(end[3, 0], end[4, 0], np.maximum(times - slowing, 0))
        return continued(coasting(along, climb, np.minimum(times, slowing)), end, rest, times > slowing)
    return thrown_slower(along, climb, times)


def thrown_slower(along: Wide, climb: Wide, times: WideArray) -> WideArray:
    """The course (5, n) from a speed of at most about `FASTEST`."""
    passive = along <= PASSIVE * max(Wide(1), np.hypot(along, climb))
    return vertical(along, climb, times) if passive else curved(along, climb, times)
