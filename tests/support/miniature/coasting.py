"""A miniature engine of mechanisms whose joints move at constant velocities, which it spoils in ways of its own."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bodycheck.adapters.contract import Engine, Integrator, Method
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.coordinates import JointMotion
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array, Trajectory

#: What is done to the states (bodies, 13) at a time (s).
Spoil = Callable[[float, Array], Array]


def motion(mechanism: Mechanism, t: Array) -> Trajectory:
    """The states of the bodies where each joint moves at its initial velocity."""
    start = kinematics.start_of(mechanism)
    velocity = np.repeat(start.velocity, len(t), axis=0)
    return kinematics.bodies(mechanism, JointMotion(start.position + velocity * t[:, None], velocity), t=t)


def exact(t: float, states: Array) -> Array:
    return states


def aside(t: float, states: Array) -> Array:
    """The last body 3 cm aside along y and 4 cm along x, but at the start."""
    if t:
        states[-1, :2] += (0.04, 0.03)
    return states


def misplaced(t: float, states: Array) -> Array:
    states[-1, 2] += 1e-3
    return states


def exploding(t: float, states: Array) -> Array:
    states[:, 7:10] *= math.exp(40 * t)
    return states


def not_a_number(t: float, states: Array) -> Array:
    return states if t < 0.5 else states * math.nan


def bodiless(t: float, states: Array) -> Array:
    return states[:-1]


@dataclass
class Coast:
    """The motion of a mechanism, spoiled."""

    mechanism: Mechanism
    timestep: float
    spoil: Spoil
    steps: int = field(default=0)

    def advance(self, strides: np.ndarray) -> Array:
        found = []
        for stride in strides.tolist():
            self.steps += stride
            t = self.steps * self.timestep
            seen = motion(self.mechanism, np.array([t]))
            parts = (seen.position, seen.quaternion, seen.velocity, seen.angular_velocity)
            found.append(self.spoil(t, np.concatenate(parts, axis=-1)[:, 0]))
        return np.array(found)[None]


@dataclass(frozen=True)
class Coasting:
    """The adapter of the engine."""

    spoil: Spoil = exact
    frozen: bool = False

    @property
    def engine(self) -> Engine:
        modelled = frozenset({"mechanisms", "revolute joints", "prismatic joints"})
        return Engine("coasting", "bodycheck-miniature", "1.0", (Integrator("coast"),), modelled)

    def prepare(self, scenes: Sequence[Mechanism], method: Method) -> Coast:
        (mechanism,) = scenes
        return Coast(mechanism, 0.0 if self.frozen else method.timestep, self.spoil)
