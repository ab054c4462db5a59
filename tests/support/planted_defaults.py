"""Miniature engines with planted defaults: a small integrator of a free body, and what engines do besides.

All is computed with plain numbers, because arrays of three numbers would make the steps ten times as slow.
"""

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from bodycheck.adapters.contract import Engine, Integrator, Method
from bodycheck.reference.kinematics import conjugate, rotate
from bodycheck.reference.scene import Quaternion, Scene, Vector
from bodycheck.reference.trajectory import Array

#: Position, quaternion, velocity (world) and angular velocity (body).
Motion = tuple[Vector, Quaternion, Vector, Vector]

#: The schemes. "linear" is semi-implicit Euler with a linear update of the quaternion. "positional" is the same with velocities
#: that are differences of poses, as in position-based dynamics, with the sine of half a turn for its half. "steady" is the one
#: of which rotation keeps its energy to rounding: implicit midpoint for the angular velocity, semi-implicit Euler for all else.
SCHEMES = ("semi-implicit", "explicit", "rk4", "midpoint", "linear", "positional", "steady")


@dataclass(frozen=True)
class Defaults:
    """What an engine does besides its scheme; nothing unless it is given.

    linear, angular: 1/s. quadratic: 1/m. quadratic_angular: 1/rad. speed: m/s. spin: rad/s. turn: rad per step, cut from
    the angular velocity or, `turn_of_attitude`, from the attitude alone. missing: the fraction of the gyroscopic torque.
    sleep: m/s and rad/s. sleep_after: s, for which a body must be slow. norm: that of quaternions less 1. clock: the
    relative excess of the time of a step. reset: m. energy: the relative change in a turn of a body that tumbles.
    light, far: the relative loss of the velocity in each step of a body lighter than 50 g, and of one farther than 500 m
    from the origin. The states are returned with the spin along the axes of the world, the velocity along those of the
    body, the inverse quaternion, its scalar last, or the spin before the velocity.
    """

    single: bool = False
    linear: float = 0.0
    angular: float = 0.0
    quadratic: float = 0.0
    quadratic_angular: float = 0.0
    speed: float = math.inf
    spin: float = math.inf
    turn: float = math.inf
    turn_of_attitude: float = math.inf
    missing: float = 0.0
    substeps: int = 1
    gravity_after: bool = False
    sleep: float = 0.0
    sleep_after: float = 0.0
    world_spin: bool = False
    body_velocity: bool = False
    inverse: bool = False
    scalar_last: bool = False
    spin_first: bool = False
    norm: float = 0.0
    clock: float = 0.0
    reset: float = math.inf
    energy: float = 0.0
    light: float = 0.0
    far: float = 0.0


def size(v: Vector) -> float:
    return math.hypot(*v)


def times(factor: float, v: Vector) -> Vector:
    return (factor * v[0], factor * v[1], factor * v[2])


def plus(v: Vector, factor: float, w: Vector) -> Vector:
    return (v[0] + factor * w[0], v[1] + factor * w[1], v[2] + factor * w[2])


def turned(q: Quaternion, v: Vector, linearly: bool) -> Quaternion:
    """A unit quaternion turned in the body by a rotation vector, or advanced linearly and normalised."""
    angle = size(v)
    c, s = (1.0, 0.5) if linearly or not angle else (math.cos(angle / 2), math.sin(angle / 2) / angle)
    w, x, y, z = q
    a, b, d = times(s, v)
    new = (
        w * c - x * a - y * b - z * d,
        w * a + x * c + y * d - z * b,
        w * b - x * d + y * c + z * a,
        w * d + x * b - y * a + z * c,
    )
    norm = math.hypot(*new)
    return (new[0] / norm, new[1] / norm, new[2] / norm, new[3] / norm)


@dataclass
class Stepper:
    """A simulation of one scene."""

    scene: Scene
    timestep: float
    scheme: str
    own: Defaults
    motion: Motion = field(init=False)
    slow_since: float = 0.0

    def __post_init__(self) -> None:
        self.motion = self._start()

    def _start(self) -> Motion:
        initial = self.scene.initial
        return initial.position, initial.quaternion, initial.velocity, initial.angular_velocity

    def advance(self, strides: Sequence[int]) -> Array:
        rows = []
        for stride in strides:
            for _ in range(stride):
                self._step()
            rows.append(self._returned())
        return np.array(rows)[None, :, None, :]

    def _returned(self) -> list[float]:
        own, (x, *parts) = self.own, self.motion
        q, v, w = map(np.array, parts)
        velocity = rotate(conjugate(q), v) if own.body_velocity else v
        spin = rotate(q, w) if own.world_spin else w
        q = (1 + own.norm) * (conjugate(q) if own.inverse else q)
        velocities = (spin, velocity) if own.spin_first else (velocity, spin)
        return [*x, *(np.roll(q, -1) if own.scalar_last else q), *velocities[0], *velocities[1]]

    def _step(self) -> None:
        own = self.own
        h = self.timestep * (1 + own.clock) / own.substeps
        for _ in range(own.substeps):
            self.motion = self._moved(h)
        if size(self.motion[0]) > own.reset:
            self.motion = self._start()
        if own.single:
            x, q, v, w = (tuple(array("f", part)) for part in self.motion)
            self.motion = (x, q, v, w)

    def _moved(self, h: float) -> Motion:
        x, q, v, w = self.motion
        old_velocity, old_spin = v, w
        w = self._spun(w, h)
        v = (v[0], v[1], v[2] - h * self.scene.gravity)
        v, w = self._slowed(x, v, w, h)
        weight = {"explicit": 0.0, "rk4": 0.5, "midpoint": 0.5}.get(self.scheme, 1.0)
        weight = 0.0 if self.own.gravity_after else weight
        x = plus(plus(x, h * (1 - weight), old_velocity), h * weight, v)
        turn = plus(times(h * (1 - weight), old_spin), h * weight, w)
        if (angle := size(turn)) > self.own.turn_of_attitude / self.own.substeps:
            turn = times(self.own.turn_of_attitude / self.own.substeps / angle, turn)
        new = turned(q, turn, self.scheme in ("linear", "positional"))
        return (x, new, *self._differences(self.motion, x, new, h)) if self.scheme == "positional" else (x, new, v, w)

    def _differences(self, before: Motion, x: Vector, q: Quaternion, h: float) -> tuple[Vector, Vector]:
        """The velocity and the angular velocity as differences of poses, which are in the precision of the engine."""
        if self.own.single:
            (x1, x2, x3), (a, b, c, d) = array("f", x), array("f", q)
        else:
            (x1, x2, x3), (a, b, c, d) = x, q
        w, i, j, k = before[1]
        velocity = times(1 / h, plus((x1, x2, x3), -1, before[0]))
        turn = (w * b - i * a - j * d + k * c, w * c + i * d - j * a - k * b, w * d - i * c + j * b - k * a)
        return velocity, times(2 / h, turn)

    def _slowed(self, x: Vector, v: Vector, w: Vector, h: float) -> tuple[Vector, Vector]:
        own = self.own
        speed, spin = size(v), size(w)
        v = times(1 / (1 + h * (own.linear + own.quadratic * speed)), v)
        w = times(1 / (1 + h * (own.angular + own.quadratic_angular * spin)), w)
        if own.light and self.scene.body.mass < 0.05:
            v = times(1 - own.light / own.substeps, v)
        if own.far and size(x) > 500:
            v = times(1 - own.far / own.substeps, v)
        if (speed := size(v)) > own.speed:
            v = times(own.speed / speed, v)
        most = min(own.spin, own.turn / self.timestep)
        if (spin := size(w)) > most:
            w = times(most / spin, w)
        self.slow_since = self.slow_since + h if size(v) < own.sleep and size(w) < own.sleep else 0.0
        if self.slow_since > own.sleep_after + h / 2:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        return v, w

    def _torque(self, w: Vector) -> Vector:
        """The angular acceleration."""
        a, b, c = self.scene.body.moments
        part = 1 - self.own.missing
        return (
            part * (b - c) / a * w[1] * w[2],
            part * (c - a) / b * w[2] * w[0],
            part * (a - b) / c * w[0] * w[1],
        )

    def _spun(self, w: Vector, h: float) -> Vector:
        """The angular velocity after a step."""
        first = self._torque(w)
        if not size(first):
            return w
        if self.scheme in ("midpoint", "steady"):
            new = plus(w, h, first)
            for _ in range(30):
                before, new = new, plus(w, h, self._torque(times(0.5, plus(w, 1.0, new))))
                if before == new:
                    break
        elif self.scheme == "rk4":
            second = self._torque(plus(w, h / 2, first))
            third = self._torque(plus(w, h / 2, second))
            fourth = self._torque(plus(w, h, third))
            new = plus(plus(plus(plus(w, h / 6, first), h / 3, second), h / 3, third), h / 6, fourth)
        else:
            new = plus(w, h, first)
        if self.own.energy:
            new = times(math.sqrt(1 + self.own.energy) ** (size(new) * h / math.tau), new)
        return new


@dataclass(frozen=True)
class Planted:
    """The adapter of a miniature engine."""

    own: Defaults = Defaults()
    scheme: str = "steady"

    @property
    def engine(self) -> Engine:
        modelled = frozenset({"gravity", "translation", "rotation"})
        return Engine("planted", "bodycheck-miniature", "1.0", (Integrator(self.scheme),), modelled)

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Stepper:
        (scene,) = scenes
        return Stepper(scene, method.timestep, self.scheme, self.own)
