"""Round bodies on planes, and their motion by event-driven integration that shares nothing with the reference.

The equations are Newton's and Euler's with the force at the point that touches; an impact solves the linear equations of
impulse and momentum at that point.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from bodycheck.reference.scene import Body, Cylinder, Plane, Scene, Sphere, State, vector_of
from bodycheck.reference.trajectory import Array

#: Slip (m/s) at which the integration of a slip ends; what is left of it takes its square in what follows.
LEAST_SLIP = 1e-7

#: Speed of an impact (m/s), relative to the first one, at which bounces end for the integration.
LAST_BOUNCE = 1e-3


@dataclass(frozen=True, eq=False)
class Integrated:
    """States at n instants along the axes of the plane, and the events with their times."""

    position: Array
    velocity: Array
    spin: Array
    quaternion: Array
    events: tuple[tuple[str, float], ...]
    until: float


def ball_on(plane: Plane, state: State, *, radius: float = 0.1, mass: float = 2.0, ratio: float = 0.4) -> Scene:
    """A sphere on a plane. state: along the axes of the plane, with the angular velocity along those of the body."""
    moment = ratio * mass * radius**2
    return Scene(Body(mass, (moment,) * 3, Sphere(radius)), in_world(plane, state), 9.81, plane)


def roller_on(plane: Plane, state: State, *, radius: float = 0.1, mass: float = 2.0) -> Scene:
    """A homogeneous cylinder on its side, as long as its diameter, on a plane; state: as that of `ball_on`."""
    across, along = mass * (radius**2 / 4 + radius**2 / 3), mass * radius**2 / 2
    return Scene(Body(mass, (across, across, along), Cylinder(radius, radius)), in_world(plane, state), 9.81, plane)


def in_world(plane: Plane, state: State) -> State:
    """A state along the axes of a plane, in the world."""
    turn = _about_y(plane.incline)
    half = plane.incline / 2
    w, x, y, z = _product(np.array([math.cos(half), 0.0, math.sin(half), 0.0]), np.array(state.quaternion)).tolist()
    return State(vector_of(turn @ state.position), (w, x, y, z), vector_of(turn @ state.velocity), state.angular_velocity)


def integrated(plane: Plane, state: State, times: Array, *, radius: float = 0.1, ratio: float = 0.4) -> Integrated:
    """The motion of a sphere with I = ratio m r^2 at ascending times (n,), until its bounces get too small.

    state: along the axes of the plane.
    """
    gravity = 9.81 * np.array([math.sin(plane.incline), 0.0, -math.cos(plane.incline)])
    laws = _Laws(plane.friction, plane.restitution, gravity, radius, ratio)
    quaternion = np.array(state.quaternion)
    spin = _matrix(quaternion) @ state.angular_velocity
    row = np.concatenate([state.position, state.velocity, spin, quaternion])
    now, rows, events, first = 0.0, np.full((len(times), 13), np.nan), list[tuple[str, float]](), 0.0
    rows[times == 0] = row
    while now < times[-1]:
        kind = laws.kind(row)
        found = solve_ivp(
            laws.derivative(kind), (now, times[-1]), row, "DOP853", events=laws.ends(kind), dense_output=True,
            rtol=3e-14, atol=1e-16, max_step=0.05,
        )  # fmt: skip
        here = (times > now) & (times <= found.t[-1])
        rows[here] = found.sol(times[here]).T
        now, row = float(found.t[-1]), found.y[:, -1].copy()
        if found.status == 0:
            break
        if kind == "flight":
            speed = -row[5]
            first = first or speed
            row = laws.impact(row)
            events.append(("impact", now))
            if 0 < row[5] < LAST_BOUNCE * first:
                break
        else:
            row, now = laws.stop(row, now)
            events.append(("roll" if laws.kind(row) == "roll" else "slip", now))
    return Integrated(rows[:, :3], rows[:, 3:6], rows[:, 6:9], rows[:, 9:], tuple(events), now)


@dataclass(frozen=True, eq=False)
class _Laws:
    friction: float
    restitution: float
    gravity: Array
    radius: float
    ratio: float

    def slip(self, row: Array) -> Array:
        return np.asarray(row[3:6] + _cross(row[6:9], np.array([0.0, 0.0, -self.radius])))[:2]

    def kind(self, row: Array) -> str:
        if row[2] > self.radius * (1 + 1e-12) or abs(row[5]) > 1e-13:
            return "flight"
        if np.hypot(*self.slip(row)) > LEAST_SLIP:
            return "slip"
        needed = self.gravity[0] * self.ratio / (1 + self.ratio)
        return "roll" if needed <= -self.friction * self.gravity[2] else "slide"

    def force(self, kind: str, row: Array) -> Array:
        """Force (3,) at the point that touches, over the mass."""
        normal = -self.gravity[2]
        if kind == "flight":
            return np.zeros(3)
        if kind == "roll":
            return np.array([-self.gravity[0] * self.ratio / (1 + self.ratio), 0.0, normal])
        slip = self.slip(row)
        size = np.hypot(*slip)
        direction = slip / size if kind == "slip" and size else np.array([1.0, 0.0])
        return np.array([*(-self.friction * normal * direction), normal])

    def derivative(self, kind: str) -> Callable[[float, Array], Array]:
        arm = np.array([0.0, 0.0, -self.radius])

        def rates(_t: float, row: Array) -> Array:
            force = self.force(kind, row)
            turning = _cross(arm, force) / (self.ratio * self.radius**2)
            turned = _product(np.concatenate([[0.0], row[6:9]]), row[9:]) / 2
            return np.concatenate([row[3:6], self.gravity + force, turning, turned])

        return rates

    def ends(self, kind: str) -> Callable[[float, Array], float] | None:
        def height(_t: float, row: Array) -> float:
            return float(row[2] - self.radius)

        def left(_t: float, row: Array) -> float:
            return float(np.hypot(*self.slip(row)) - LEAST_SLIP / 2)

        found = {"flight": height, "slip": left}.get(kind)
        if found is None:
            return None
        found.terminal, found.direction = True, -1  # type: ignore[attr-defined]
        return found

    def impact(self, row: Array) -> Array:
        """A body after an impact: by an impulse that ends the slip, or by a sliding one where that is outside the cone."""
        arm = np.array([0.0, 0.0, -self.radius])
        cross = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
        mobility = np.eye(3) - cross @ cross / (self.ratio * self.radius**2)
        at_point = row[3:6] + _cross(row[6:9], arm)
        impulse = np.linalg.solve(mobility, np.array([0.0, 0.0, -self.restitution * at_point[2]]) - at_point)
        if np.hypot(*impulse[:2]) > self.friction * impulse[2]:
            direction = at_point[:2] / np.hypot(*at_point[:2])
            normal = -(1 + self.restitution) * at_point[2]
            impulse = np.array([*(-self.friction * normal * direction), normal])
        after = row.copy()
        after[2] = self.radius
        after[3:6] += impulse
        after[6:9] += _cross(arm, impulse) / (self.ratio * self.radius**2)
        if self.restitution == 0:
            after[5] = 0.0
        return after

    def stop(self, row: Array, now: float) -> tuple[Array, float]:
        """A body at the end of its slip, which falls on with the acceleration that it has."""
        rates = self.derivative("slip")(now, row)
        change = np.array([rates[3] - self.radius * rates[7], rates[4] + self.radius * rates[6]])
        slip = self.slip(row)
        left = float(-(slip @ slip) / (slip @ change))
        after = row + left * rates
        return after, now + left


def _cross(a: Array, b: Array) -> Array:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _about_y(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def _matrix(q: Array) -> Array:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _product(p: Array, q: Array) -> Array:
    vector = p[0] * q[1:] + q[0] * p[1:] + _cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *vector])
