"""Compute the efforts of controllers and stops while an engine steps: at which instants, and from which state.

A controller with a rate computes its law at the first step that has reached its instant, from the state there. Instants are
compared as rational numbers, and an instant that is later by at most 1e-9 of a period counts as reached, as does a time of a
table with held values that is later than the instant. The module
`scheduling` steps an engine from instant to instant.

Continuous laws, and elastic stops as efforts (`limits=effort`), are evaluated at the stages of the engine's integrator if its
simulation is `Staged`, otherwise at each step, from whose start their efforts are held. The integral of the error of a
continuous law is the integral of the target without the integral of the coordinate, which is computed in each step from the
coordinates q and the velocities v at its ends as h (q0 + q1) / 2 + h^2 (v0 - v1) / 12: its error is of the fourth order in the
step, as that of a Runge-Kutta scheme.

Scripts for engines alone contain these classes.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from bodycheck.adapters.contract import Efforts, Method
from bodycheck.adapters.control_laws import effort_of, integral_of, push_of, value_of
from bodycheck.reference.mechanisms.control import SLACK, Controller, Stops
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array


@dataclass
class Sampler:
    """A controller with a rate, and what it remembers.

    Attributes
    ----------
    index
        The index of its joint among the driven joints.
    controller
        The controller.
    instants
        The number of instants so far.
    total
        The sum of the errors at these instants.
    waiting
        The results that do not act yet.
    effort
        The effort that acts (N m or N).
    """

    index: int
    controller: Controller
    instants: int = 0
    total: float = 0.0
    waiting: deque[float] = field(default_factory=deque)
    effort: float = 0.0

    @property
    def instant(self) -> Fraction:
        """The next instant (s)."""
        assert self.controller.rate is not None
        return self.instants / Fraction(self.controller.rate)

    @property
    def due(self) -> Fraction:
        """The time (s) from which on the next instant counts as reached."""
        assert self.controller.rate is not None
        return (self.instants - SLACK) / Fraction(self.controller.rate)

    def sample(self, position: float, velocity: float) -> None:
        """Compute the law at the next instant from the state of the joint."""
        controller = self.controller
        assert controller.rate is not None
        slack = SLACK / Fraction(controller.rate)
        self.total += value_of(controller.target, self.instant, slack) - position
        result = effort_of(controller, self.instant, position, velocity, self.total / controller.rate, slack)
        self.instants += 1
        self.waiting.append(result)
        if len(self.waiting) > controller.delay:
            self.effort = self.waiting.popleft()


@dataclass
class Follower:
    """A continuous controller, and the integral of its error up to the start of the present step.

    Attributes
    ----------
    index, controller
        As those of `Sampler`.
    time, position, velocity
        The time (s), and the state of the joint, at the start of the step.
    integral
        The integral of the error up to this time.
    """

    index: int
    controller: Controller
    time: float = 0.0
    position: float = 0.0
    velocity: float = 0.0
    integral: float = 0.0

    def integral_to(self, time: float, position: float, velocity: float) -> float:
        """Return the integral of the error up to a time (s) within the step, from the state of the joint there."""
        if not self.controller.ki:
            return 0.0
        h = time - self.time
        moved = h * (self.position + position) / 2 + h * h * (self.velocity - velocity) / 12
        return self.integral + integral_of(self.controller.target, self.time, time) - moved

    def begin(self, time: float, position: float, velocity: float) -> None:
        """Begin a step at a time (s) and a state of the joint."""
        self.integral = self.integral_to(time, position, velocity)
        self.time, self.position, self.velocity = time, position, velocity

    def effort(self, time: float, position: float, velocity: float) -> float:
        """Return the effort (N m or N) at a time (s) and a state of the joint."""
        return effort_of(self.controller, time, position, velocity, self.integral_to(time, position, velocity))


class Controls:
    """The controllers and the elastic stops of a mechanism, which exert efforts on its driven joints.

    Parameters
    ----------
    count
        The number of driven joints.
    controllers, stops
        Pairs of the index of a driven joint, and its controller or its elastic stops.
    staged
        Whether the simulation obeys continuous laws at its stages: those of the method `law`.
    """

    def __init__(
        self, count: int, controllers: Sequence[tuple[int, Controller]], stops: Sequence[tuple[int, Stops]], staged: bool
    ) -> None:
        self.count, self.stops, self.staged = count, stops, staged
        self.samplers = [Sampler(index, each) for index, each in controllers if each.rate is not None]
        self.followers = [Follower(index, each) for index, each in controllers if each.rate is None]
        self.continuous = bool(self.followers or stops)
        #: Whether something is computed at each step.
        self.each_step = self.continuous and (not staged or any(each.controller.ki for each in self.followers))

    @property
    def computed(self) -> Efforts:
        """When efforts are computed: "at stages" if any are computed there, else "between steps"."""
        return "at stages" if self.staged and self.continuous else "between steps"

    def law(self, time: float, positions: Array, velocities: Array) -> Array:
        """Return the efforts (j,) of continuous controllers and elastic stops, as `bodycheck.adapters.contract.Law`."""
        efforts = np.zeros(self.count)
        for each in self.followers:
            efforts[each.index] += each.effort(time, float(positions[each.index]), float(velocities[each.index]))
        for index, stops in self.stops:
            efforts[index] += push_of(stops, float(positions[index]), float(velocities[index]))
        return efforts

    def exert(self, now: Fraction, state: Callable[[], tuple[Array, Array]], apply: Callable[[Array], None]) -> None:
        """Compute all that is due at a time (s), and exert the efforts.

        state, apply: as those of `bodycheck.adapters.contract.Driven`.
        """
        due = [each for each in self.samplers if each.due <= now]
        if not due and not self.each_step:
            return
        positions, velocities = state()
        for sampler in due:
            while sampler.due <= now:
                sampler.sample(float(positions[sampler.index]), float(velocities[sampler.index]))
        efforts = np.zeros(self.count)
        for sampler in self.samplers:
            efforts[sampler.index] += sampler.effort
        if self.each_step:
            for each in self.followers:
                each.begin(float(now), float(positions[each.index]), float(velocities[each.index]))
            if not self.staged:
                efforts += self.law(float(now), positions, velocities)
        apply(efforts)

    def following(self, step: int, end: int, timestep: float) -> int:
        """Return the step after `step`, and at most `end`, at which something is computed. timestep: in s."""
        if self.each_step:
            return min(step + 1, end)
        return min([end, *(math.ceil(each.due / Fraction(timestep)) for each in self.samplers)])


def controls_of(mechanism: Mechanism, method: Method, staged: bool) -> Controls:
    """Return the controllers of a mechanism, and with `limits=effort` its stops. staged: as in `Controls`."""
    index = {joint: number for number, joint in enumerate(mechanism.driven)}
    controllers = [(index[each.joint], each) for each in mechanism.controllers]
    stops = [(number, mechanism.joints[joint].stops) for joint, number in index.items() if method.option("limits") == "effort"]
    return Controls(len(index), controllers, [(number, each) for number, each in stops if each is not None], staged)
