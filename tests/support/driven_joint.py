"""A driven joint followed in sixty digits by code of its own: short Taylor steps, and events by bisection.

At the start of a step, the branch of every function with cases (saturation, friction, stops) is the one that holds a little
later along the motion. The step ends where another branch holds. Events that begin and end within one step are missed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import mpmath

from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops

CTX = mpmath.MPContext()
CTX.dps = 60

#: The order of the series, the time by which a branch looks ahead relative to a step, the speed below which no joint rebounds,
#: and the number of bisections.
ORDER, AHEAD, SLOWEST, HALVINGS = 34, CTX.mpf(10) ** -27, CTX.mpf(10) ** -19, 110

Number = Any
State = tuple[Number, Number, Number]


@dataclass(frozen=True)
class Joint:
    """I q'' + damping q' + stiffness (q - rest) = force - friction sign(q') + controller + stops."""

    inertia: float = 1.0
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    force: float = 0.0
    friction: float = 0.0
    start: float = 0.0
    velocity: float = 0.0
    controller: Controller | None = None
    stops: Stops | None = None


@dataclass
class Branch:
    """The branches that hold: bounds of the effort, direction of slip (None: sticks), and the contact of each side."""

    effort: str
    slip: int | None
    contact: str
    side: int = 0

    def key(self) -> tuple[Any, ...]:
        return self.effort, self.slip, self.contact, self.side


def taylor(signal: Signal, t: Number, begun: float, order: int) -> list[Number]:
    """The Taylor coefficients of a signal at a time t, in the piece that begins at the time `begun`."""
    zeros = [CTX.zero] * order
    if isinstance(signal, Sine):
        w = CTX.mpf(signal.angular_frequency)
        angle = w * t + CTX.mpf(signal.phase)
        cycle = [CTX.sin(angle), CTX.cos(angle), -CTX.sin(angle), -CTX.cos(angle)]
        series = [CTX.mpf(signal.amplitude) * cycle[n % 4] * w**n / CTX.factorial(n) for n in range(order)]
        return [series[0] + CTX.mpf(signal.offset), *series[1:]]
    if isinstance(signal, Samples):
        after = [n for n, time in enumerate(signal.times) if time > begun]
        if not after or after[0] == 0:
            return [CTX.mpf(signal.values[0 if after else -1]), *zeros[1:]]
        n = after[0] - 1
        if signal.between == "hold":
            return [CTX.mpf(signal.values[n]), *zeros[1:]]
        t0, t1, y0, y1 = (CTX.mpf(each) for each in (*signal.times[n : n + 2], *signal.values[n : n + 2]))
        slope = (y1 - y0) / (t1 - t0)
        return [y0 + slope * (t - t0), slope, *zeros[2:]]
    return [CTX.mpf(signal), *zeros[1:]]


@dataclass
class Judge:
    """The motion of a joint, followed by calls of `run` with ascending times."""

    joint: Joint
    t: Number = CTX.zero
    z: State = (CTX.zero, CTX.zero, CTX.zero)
    begun: float = 0.0
    held: Number = CTX.zero
    closed: int = 0
    stuck: bool = False
    queue: list[Number] = field(default_factory=list)
    known: dict[tuple[str, Number, float], list[Number]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.z = CTX.mpf(self.joint.start), CTX.mpf(self.joint.velocity), CTX.zero
        self.arrive()

    # The forces.

    def series(self, name: str) -> list[Number]:
        key = name, self.t, self.begun
        if key not in self.known:
            self.known = {old: each for old, each in self.known.items() if old[1:] == key[1:]}
            self.known[key] = taylor(getattr(self.joint.controller, name), self.t, self.begun, ORDER)
        return self.known[key]

    def effort(self, branch: str, q: list[Number], v: list[Number], w: list[Number], n: int, given: dict[str, Any]) -> Number:
        """The coefficient n of the controller's effort in a branch."""
        c = self.joint.controller
        one = 1 if n == 0 else 0
        if c is None:
            return CTX.zero
        if c.rate is not None:
            return self.held * one
        if branch == "law":
            proportional = CTX.mpf(c.kp) * (given["target"][n] - q[n]) + CTX.mpf(c.kd) * (given["target_velocity"][n] - v[n])
            return proportional + CTX.mpf(c.ki) * w[n] + given["effort"][n]
        most = CTX.mpf(c.effort_limit)
        sign = 1 if branch[0] == "+" else -1
        match branch[1:]:
            case "full":
                return sign * most * one
            case "line":
                return sign * most * one - most / CTX.mpf(c.no_load_speed) * v[n]
            case _:
                return CTX.zero

    def branch_of_effort(self, q: Number, v: Number, w: Number, given: Sequence[Number]) -> str:
        c = self.joint.controller
        if c is None or c.rate is not None or c.effort_limit is None:
            return "law"
        wanted = CTX.mpf(c.kp) * (given[0] - q) + CTX.mpf(c.kd) * (given[1] - v) + CTX.mpf(c.ki) * w + given[2]
        sign = 1 if wanted > 0 else -1
        share, kind = CTX.one, "full"
        if c.no_load_speed is not None and sign * v > 0:
            share, kind = 1 - sign * v / CTX.mpf(c.no_load_speed), "line"
            if share <= 0:
                share, kind = CTX.zero, "none"
        return "law" if abs(wanted) <= CTX.mpf(c.effort_limit) * share else ("+" if sign > 0 else "-") + kind

    def pushed(self, q: Number, v: Number) -> tuple[str, int]:
        stops = self.joint.stops
        if stops is None or stops.rigid:
            return "free", 0
        for side, end in ((1, stops.upper), (-1, stops.lower)):
            if end is not None and (x := side * (q - CTX.mpf(end))) > 0:
                return ("push" if CTX.mpf(stops.stiffness) * x + CTX.mpf(stops.damping) * side * v > 0 else "slack"), side
        return "free", 0

    def beyond_rigid(self, q: Number) -> int:
        stops = self.joint.stops
        if stops is None or not stops.rigid:
            return 0
        for side, end in ((1, stops.upper), (-1, stops.lower)):
            if end is not None and side * (q - CTX.mpf(end)) > 0:
                return side
        return 0

    # The branches and the series in them.

    def expand(self, branch: Branch, z: State) -> list[list[Number]]:
        """The Taylor series of the coordinate, the velocity and the integral of the error."""
        j, c = self.joint, self.joint.controller
        q, v, w = [z[0]], [z[1]], [z[2]]
        given = {} if c is None else {name: self.series(name) for name in ("target", "target_velocity", "effort")}
        still = branch.slip is None or self.closed
        stops = j.stops
        for n in range(ORDER - 1):
            one = 1 if n == 0 else 0
            force = self.force(branch, q, v, w, n, given) - (0 if still else branch.slip * CTX.mpf(j.friction) * one)
            if branch.contact == "push":
                assert stops is not None
                end = CTX.mpf(stops.upper if branch.side > 0 else stops.lower)
                force -= CTX.mpf(stops.stiffness) * (q[n] - end * one) + CTX.mpf(stops.damping) * v[n]
            q.append(CTX.zero if still else v[n] / (n + 1))
            v.append(CTX.zero if still else force / CTX.mpf(j.inertia) / (n + 1))
            w.append(CTX.zero if c is None else (given["target"][n] - q[n]) / (n + 1))
        return [q, v, w]

    def force(self, branch: Branch, q: list[Number], v: list[Number], w: list[Number], n: int, given: Any) -> Number:
        j = self.joint
        one = 1 if n == 0 else 0
        passive = CTX.mpf(j.force) * one - CTX.mpf(j.damping) * v[n] - CTX.mpf(j.stiffness) * (q[n] - CTX.mpf(j.rest) * one)
        return passive + self.effort(branch.effort, q, v, w, n, given)

    def branch(self, z: State, dt: Number) -> Branch:
        """The branch at a state, at the time dt after the present one."""
        q, v, w = z
        c = self.joint.controller
        given = [] if c is None else [at(self.series(name), dt) for name in ("target", "target_velocity", "effort")]
        slip = None if self.stuck or self.closed else (1 if v > 0 else -1)
        return Branch(self.branch_of_effort(q, v, w, given), slip, *self.pushed(q, v))

    def load(self, z: State, dt: Number) -> Number:
        """The force on the joint without friction and rigid stops."""
        branch = self.branch(z, dt)
        c = self.joint.controller
        given = {} if c is None else {n: [at(self.series(n), dt)] for n in ("target", "target_velocity", "effort")}
        total = self.force(branch, [z[0]], [z[1]], [z[2]], 0, given)
        if branch.contact == "push":
            stops = self.joint.stops
            assert stops is not None
            end = CTX.mpf(stops.upper if branch.side > 0 else stops.lower)
            total -= CTX.mpf(stops.stiffness) * (z[0] - end) + CTX.mpf(stops.damping) * z[1]
        return total

    # Events.

    def arrive(self) -> None:
        """Decide on impacts, sticking and resting at a stop, at the present state."""
        q, v, w = self.z
        stops, f = self.joint.stops, CTX.mpf(self.joint.friction)
        self.closed, self.stuck = 0, False
        if stops is not None and stops.rigid:
            for side, end in ((1, stops.upper), (-1, stops.lower)):
                if end is not None and abs(q - CTX.mpf(end)) < SLOWEST * SLOWEST and side * v >= 0:
                    v = -CTX.mpf(stops.restitution) * v if side * v > SLOWEST else CTX.zero
                    q = CTX.mpf(end)
                    self.z = q, v, w
                    if abs(v) <= SLOWEST:
                        self.z = q, CTX.zero, w
                        if side * self.load(self.z, CTX.zero) + f > 0:
                            self.closed = side
                            return
        if abs(self.z[1]) < SLOWEST:
            pull = self.load((q, CTX.zero, w), CTX.zero)
            if f and abs(pull) <= f:
                self.stuck = True
                self.z = q, CTX.zero, w

    def holds(self, branch: Branch, z: State, dt: Number) -> bool:
        if self.closed:
            if self.closed * self.load(z, dt) + CTX.mpf(self.joint.friction) < 0:
                return False
        elif self.stuck:
            if abs(self.load(z, dt)) > CTX.mpf(self.joint.friction):
                return False
        elif self.beyond_rigid(z[0]):
            return False
        now = self.branch(z, dt)
        if not self.joint.friction:
            now.slip = branch.slip
        return now.key() == branch.key()

    def step(self, h: Number) -> None:
        """Follow the motion for a time h, with events."""
        events = 0
        while h > 0:
            branch = self.ahead(h)
            series = self.expand(branch, self.z)

            def reached(dt: Number, series: list[list[Number]] = series) -> State:
                q, v, w = (at(part, dt) for part in series)
                return q, v, w

            if self.holds(branch, reached(h), h):
                self.z, self.t = reached(h), self.t + h
                return
            low, high = AHEAD * h, h
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                low, high = (middle, high) if self.holds(branch, reached(middle), middle) else (low, middle)
            slip, q, v = branch.slip, *reached(high)[:2]
            w = reached(high)[2]
            if self.joint.friction and slip is not None and slip * v <= 0:
                v = CTX.zero
            self.z, self.t, h = (q, v, w), self.t + high, h - high
            self.snap()
            self.arrive()
            events += 1
            assert events < 2000

    def snap(self) -> None:
        side = self.beyond_rigid(self.z[0])
        stops = self.joint.stops
        if side and stops is not None:
            self.z = CTX.mpf(stops.upper if side > 0 else stops.lower), *self.z[1:]

    def ahead(self, h: Number) -> Branch:
        """The branch that holds a little later."""
        later, branch = self.z, self.branch(self.z, CTX.zero)
        if not self.z[1] and not self.stuck and not self.closed:
            branch.slip = 1 if self.load(self.z, CTX.zero) > 0 else -1
        for _ in range(4):
            q, v, w = (at(part, AHEAD * h) for part in self.expand(branch, self.z))
            later = q, v, w
            branch = self.branch(later, AHEAD * h)
        return branch

    def run(self, until: float, step: float) -> State:
        """The state at a time, reached in steps of at most `step` (s) between breaks and instants of the controller."""
        end = CTX.mpf(until)
        while self.t < end:
            stop = min(end, self.next_break())
            if self.rate is not None and self.t == self.instant:
                self.act()
                stop = min(end, self.next_break())
            pieces = max(1, math.ceil(float((stop - self.t) / CTX.mpf(step))))
            start = self.t
            for n in range(1, pieces + 1):
                goal = stop if n == pieces else start + (stop - start) * n / pieces
                self.step(goal - self.t)
                self.t = goal
            self.cross(stop)
        return self.z

    # Breaks of signals and instants of the controller.

    count: int = 0
    total: Number = CTX.zero

    @property
    def rate(self) -> float | None:
        return None if self.joint.controller is None else self.joint.controller.rate

    @property
    def instant(self) -> Number:
        assert self.rate is not None
        return CTX.mpf(self.count) / CTX.mpf(self.rate)

    def next_break(self) -> Number:
        c = self.joint.controller
        if c is None:
            return CTX.inf
        if c.rate is not None:
            return self.instant if self.t < self.instant else CTX.mpf(self.count + 1) / CTX.mpf(c.rate)
        times = [t for s in (c.target, c.target_velocity, c.effort) if isinstance(s, Samples) for t in s.times]
        return min((CTX.mpf(time) for time in times if time > self.begun), default=CTX.inf)

    def cross(self, stop: Number) -> None:
        c = self.joint.controller
        if c is not None and c.rate is None and self.next_break() == stop:
            self.begun = float(stop)
            self.arrive()

    def act(self) -> None:
        """The controller's computation at an instant, in the words of the law."""
        c = self.joint.controller
        assert c is not None
        assert c.rate is not None
        q, v, _ = self.z
        time = Fraction(self.count) / Fraction(c.rate)
        soon = time + Fraction(1, 10**9) / Fraction(c.rate)  # up to which held values count as reached
        signals = (c.target, c.target_velocity, c.effort)
        target, target_velocity, effort = (
            value(s, soon if isinstance(s, Samples) and s.between == "hold" else time) for s in signals
        )
        self.total += (target - q) / CTX.mpf(c.rate)
        wanted = CTX.mpf(c.kp) * (target - q) + CTX.mpf(c.kd) * (target_velocity - v) + CTX.mpf(c.ki) * self.total + effort
        if c.effort_limit is not None:
            most = CTX.mpf(c.effort_limit)
            along = most
            if c.no_load_speed is not None:
                along = most * max(CTX.zero, 1 - abs(v) / CTX.mpf(c.no_load_speed))
            upper, lower = (along, most) if v > 0 else (most, along) if v < 0 else (most, most)
            wanted = max(-lower, min(upper, wanted))
        self.queue.append(wanted)
        self.held = self.queue[-1 - c.delay] if len(self.queue) > c.delay else CTX.zero
        self.count += 1
        self.arrive()


def value(signal: Signal, time: Fraction) -> Number:
    """The value of a signal at a rational time."""
    t = CTX.mpf(time.numerator) / time.denominator
    if isinstance(signal, Sine):
        return CTX.mpf(signal.offset) + CTX.mpf(signal.amplitude) * CTX.sin(
            CTX.mpf(signal.angular_frequency) * t + CTX.mpf(signal.phase)
        )
    if isinstance(signal, Samples):
        past = [n for n, each in enumerate(signal.times) if Fraction(each) <= time]
        if not past:
            return CTX.mpf(signal.values[0])
        n = past[-1]
        if signal.between == "hold" or n == len(signal.times) - 1:
            return CTX.mpf(signal.values[n])
        t0, t1, y0, y1 = (CTX.mpf(each) for each in (*signal.times[n : n + 2], *signal.values[n : n + 2]))
        return y0 + (y1 - y0) * (t - t0) / (t1 - t0)
    return CTX.mpf(signal)


def at(series: Sequence[Number], dt: Number) -> Number:
    """The value of a Taylor series."""
    if not dt or not any(series[1:]):
        return series[0]
    total = CTX.zero
    for part in reversed(series):
        total = total * dt + part
    return total


def states(joint: Joint, times: Sequence[float], step: float) -> list[tuple[Number, Number]]:
    """The coordinates and velocities at ascending times."""
    judge = Judge(joint)
    return [judge.run(time, step)[:2] for time in times]
