"""A miniature engine with error control: the Runge-Kutta pair of Bogacki and Shampine for a free body, in NumPy."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from bodycheck.adapters.contract import ACCURACY, Engine, Integrator, Method, Work
from bodycheck.adapters.stepping import Controlled, Loop, Normalised, NormalisedControl
from bodycheck.reference.kinematics import multiply
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array

#: The least and the largest ratio of a step to the one before, and the part of the estimated step that is taken.
LEAST, MOST, SAFE = 0.2, 5.0, 0.9


@dataclass
class Flight:
    """A body in flight at `time` (s), whose next step has at most the length `step` (s)."""

    scene: Scene
    accuracy: float
    largest: float
    time: float = 0.0
    state: Array = field(default_factory=lambda: np.empty(0))
    step: float = 0.0
    steps: int = 0
    rejected: int = 0
    evaluations: int = 0

    def __post_init__(self) -> None:
        own = self.scene.initial
        self.state = np.array([*own.position, *own.quaternion, *own.velocity, *own.angular_velocity])
        self.step = self.largest

    def rates(self, state: Array) -> Array:
        self.evaluations += 1
        moments, spin = np.array(self.scene.body.moments), state[10:]
        turning = np.cross(moments * spin, spin) / moments
        half = multiply(state[3:7], np.array([0.0, *spin])) / 2
        return np.concatenate([state[7:10], half, [0.0, 0.0, -self.scene.gravity], turning])

    def tried(self, state: Array, h: float) -> tuple[Array, float]:
        """Return the state after a step, and the estimate of its error."""
        one = self.rates(state)
        two = self.rates(state + h * one / 2)
        three = self.rates(state + h * two * 3 / 4)
        after = state + h * (2 * one + 3 * two + 4 * three) / 9
        error = h * (-5 * one / 72 + two / 12 + three / 9 - self.rates(after) / 8)
        return after, float(np.abs(error).max())

    def take(self, end: float) -> None:
        """Take one step that is accurate enough and ends at `end` (s) or before it."""
        while True:
            h = min(self.step, self.largest, end - self.time)
            after, error = self.tried(self.state, h)
            ratio = SAFE * (self.accuracy / max(error, 1e-300)) ** (1 / 3)
            self.step = h * min(MOST, max(LEAST, ratio))
            if error <= self.accuracy:
                break
            self.rejected += 1
        self.steps, self.state = self.steps + 1, after
        self.time = end if h == end - self.time else self.time + h

    def at(self, time: float) -> Array:
        while self.time < time:
            self.take(time)
        return self.state.copy()

    def between(self, times: Array) -> Iterator[Array]:
        start, state = self.time, self.state
        for time in times.tolist():
            while self.time <= time:
                start, state = self.time, self.state
                self.take(np.inf)
            counted = self.evaluations
            yield self.tried(state, time - start)[0]
            self.evaluations = counted

    def work(self) -> Work:
        return Work(self.steps, self.rejected, self.evaluations)


@dataclass(frozen=True)
class Adaptive:
    """The adapter of the engine. `largest_step` is the engine's own limit (s)."""

    largest_step: float | None = None

    @property
    def engine(self) -> Engine:
        return Engine(
            "adaptive",
            "bodycheck-miniature",
            "1.0",
            (Integrator("bs3", order=3, evaluations=4, options={"accuracy": ACCURACY}), Integrator("plain", order=3)),
            frozenset({"gravity", "translation", "rotation"}),
            largest_step=self.largest_step,
        )

    def prepare(self, scenes: Sequence[Scene], method: Method) -> Normalised:
        (scene,) = scenes
        if method.accuracy is None:
            flight = Flight(scene, 1.0, method.timestep)
            one = Loop(flight.state, lambda state: flight.tried(state, method.timestep)[0], np.copy, np.asarray)
            return Normalised(one)
        flight = Flight(scene, method.accuracy, method.timestep)
        return NormalisedControl(Controlled(method.timestep, flight.at, np.asarray, flight.work, flight.between))


ADAPTIVE = Adaptive()
