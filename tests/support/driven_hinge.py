"""A hinge without gravity with controllers, and an engine for it that is exact while efforts are held."""

from dataclasses import dataclass, field

import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Work
from bodycheck.adapters.stepping import Controlled, Loop, Taking, TakingControl
from bodycheck.reference.mechanisms.control import Controller, Stops
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.jointed import body

#: The moment of inertia (kg m^2) about the axis of the hinge.
INERTIA = 0.01

#: A step of 1 rad, from rest: after 0.1 s, the angle (rad) under the continuous law, and angle and rate (rad/s) at 500 Hz.
PD = Controller(0, kp=20.0, kd=0.4, target=1.0)
CONTINUOUS, SAMPLED, SAMPLED_RATE = 1.1396720845937189, 1.1333289750980506, -5.79412483285462


def hinge(*controllers: Controller, stops: Stops | None = None, start: float = 0.0, rate: float = 0.0) -> Mechanism:
    """Return a body that turns about the y axis through its centre of mass."""
    joint = Joint("pin", "revolute", WORLD, 0, axis=(0.0, 1.0, 0.0), start=(start,), start_velocity=(rate,), stops=stops)
    return Mechanism((body("arm", 1.0, (INERTIA, INERTIA, INERTIA)),), (joint,), controllers=controllers)


@dataclass
class Exact:
    """The angle and the rate of the hinge, which move exactly while the effort is held; `most` is the largest angle (rad)."""

    angle: float = 0.0
    rate: float = 0.0
    effort: float = 0.0
    time: float = 0.0
    most: float = np.inf
    applied: list[tuple[float, float]] = field(default_factory=list)

    def move(self, h: float) -> None:
        """Move for a time (s)."""
        acceleration = self.effort / INERTIA
        self.angle += h * self.rate + h * h * acceleration / 2
        self.rate += h * acceleration
        self.time += h
        if self.angle > self.most:
            raise EngineDiverged("too far")

    def read(self) -> tuple[Array, Array]:
        """Return the state of the joint."""
        return np.array([self.angle]), np.array([self.rate])

    def exert(self, efforts: Array) -> None:
        """Hold an effort, and remember when."""
        self.effort = float(efforts[0])
        self.applied.append((self.time, self.effort))


def rows(seen: Array) -> Array:
    """Return the states (n, 1, 13) of the body from angles and rates (n, 2)."""
    half, states = seen[:, 0] / 2, np.zeros((len(seen), 1, 13))
    states[:, 0, 3], states[:, 0, 5], states[:, 0, 11] = np.cos(half), np.sin(half), seen[:, 1]
    return states


def angles(states: Array) -> Array:
    """Return the angles (n,) of states (1, n, 1, 13)."""
    return 2 * np.arctan2(states[0, :, 0, 5], states[0, :, 0, 3])


def fixed_steps(exact: Exact, timestep: float) -> Taking:
    """Return the simulation with steps of a fixed size (s)."""

    def step(_: None) -> None:
        exact.move(timestep)

    loop = Loop(None, step, lambda _: np.array([exact.angle, exact.rate]), rows)
    return Taking(loop, exact.read, exact.exert)


def error_control(exact: Exact, timestep: float) -> TakingControl:
    """Return the simulation that reaches any time (s)."""

    def at(time: float) -> Array:
        exact.move(time - exact.time)
        exact.time = time
        return np.array([exact.angle, exact.rate])

    return TakingControl(Controlled(timestep, at, rows, lambda: Work(1, 0, 1)), exact.read, exact.exert)
