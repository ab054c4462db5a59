"""The motion of a body that turns between two fingers on the world, integrated by collocation in the widest type of NumPy.

With the line d, the direction a = n x d and the centre of mass at c from the contacts, the contacts slip at u = v + w (c_a, -c_d)
and exert the force f and the moment t about n on the body:

    m v' = m g + f,    I w' = t - (c_d f_a - c_a f_d).

With separate limits, the contacts do not slip and the body is a pendulum with dry friction, t = -2 mu_t N sign(w), as long as
|f| is at most 2 mu N. In one cone, y = (mu u, mu_t w) gives (f/mu, t/mu_t) = -2 N y/|y|. The integration is then over a
parameter q with dt/dq = |y|, in which a motion that comes to rest is smooth.

A body that begins to move in one cone from rest has y = rho(rho + 2 N K)^-1 h in its first instant, where h is y' without
friction and K the change of y' by (f/mu, t/mu_t); |y| = rho gives rho.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from bodycheck.reference.contact.gripping.course import AT_ONCE
from bodycheck.reference.contact.gripping.grip import Grip
from bodycheck.reference.contact.gripping.waves import Wave, constant, first_negative, piece_at, values
from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.exact.numbers import MP, Real, Wide, exactly, wide
from bodycheck.reference.integration.collocation import Step, steps
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The largest number of evaluations of the equations.
MOST = 60_000

#: The first step in units of the time in which gravity turns the body by a radian.
FIRST = 0.05

#: The ratio of |y| to its largest value at which a body has come to rest.
GONE = Wide(1e-19)

#: The number of parts of a step in which conditions are checked, and of halvings that locate where one is broken.
PARTS, HALVINGS = 33, 80

#: The largest number of times that a body comes to rest.
MOST_RESTS = 200

#: Indices of the parts of a state: c, the angle, v, the angular velocity w, and the time.
C, ANGLE, V, W, T = slice(0, 2), 2, slice(3, 5), 5, 6


@dataclass(frozen=True, eq=False)
class Turned:
    """An event: its kind, its time (s), and the state (7,) then."""

    kind: EventKind
    time: Real
    state: WideArray


@dataclass(eq=False)
class Turning:
    """The states (n, 7) at n instants (s), of which the first `row` are known, and the events, by steps with so many nodes."""

    times: WideArray
    states: WideArray
    stages: int
    events: list[Turned] = field(default_factory=list)
    row: int = 0

    def fill(self, states: WideArray) -> None:
        """Fill in the states (k, 7) at the next instants."""
        rows = slice(self.row, self.row + len(states))
        self.states[rows] = states
        self.row = rows.stop


@dataclass(frozen=True, eq=False)
class _Laws:
    """The numbers of a grip in the widest type, the press from an instant on, the sense in which a pendulum turns, and the
    state (7,) in which the motion begins.
    """

    grip: Grip
    mass: Wide
    moment: Wide
    gravity: Wide
    friction: Wide
    torsional: Wide
    press: Wave
    since: Wide
    sense: float
    first: WideArray

    def pressed(self, times: WideArray) -> WideArray:
        """The force N (n,) of a finger at times (n,)."""
        return values(self.press, times - self.since)[0]

    def scaled(self, states: WideArray) -> WideArray:
        """The velocities y (n, 3) in states (n, 7)."""
        c, w = states[:, C], states[:, W]
        u = states[:, V] + w[:, None] * np.stack([c[:, 1], -c[:, 0]], axis=1)
        return np.column_stack([self.friction * u, self.torsional * w])

    def rates(self, states: WideArray) -> WideArray:
        """The rates (n, 7) of states (n, 7) in time."""
        if self.grip.one:
            return self._moved(states, self._loads(states), np.ones(len(states), Wide))
        return self._pendulum(states)

    def paced(self, states: WideArray) -> WideArray:
        """The rates (n, 7) of states (n, 7) in the parameter q, in one cone."""
        y = self.scaled(states)
        pace = np.sqrt((y * y).sum(axis=1))
        return self._moved(states, -2 * self.pressed(states[:, T])[:, None] * y, pace)

    def _loads(self, states: WideArray) -> WideArray:
        """The loads (f/mu, t/mu_t) (n, 3) of the contacts in one cone."""
        y = self.scaled(states)
        size = np.sqrt((y * y).sum(axis=1))
        y = np.where(size[:, None] > 0, y, self.begun)
        size = np.sqrt((y * y).sum(axis=1))
        return np.asarray(-2 * self.pressed(states[:, T])[:, None] * y / size[:, None])

    def _moved(self, states: WideArray, loads: WideArray, pace: WideArray) -> WideArray:
        c, f = states[:, C], self.friction * loads[:, :2]
        turning = self.torsional * loads[:, 2] - (c[:, 0] * f[:, 1] - c[:, 1] * f[:, 0])
        changed = np.zeros_like(states)
        changed[:, C], changed[:, ANGLE], changed[:, T] = pace[:, None] * states[:, V], pace * states[:, W], pace
        changed[:, V], changed[:, W] = f / self.mass, turning / self.moment
        changed[:, 3] += pace * self.gravity
        return changed

    def _pendulum(self, states: WideArray) -> WideArray:
        c, w = states[:, C], states[:, W]
        swung = self.mass * (c * c).sum(axis=1) + self.moment
        braking = -2 * self.sense * self.torsional * self.pressed(states[:, T])
        alpha = (braking - self.mass * self.gravity * c[:, 1]) / swung
        aside = np.stack([-c[:, 1], c[:, 0]], axis=1)
        changed = np.zeros_like(states)
        changed[:, C], changed[:, ANGLE], changed[:, T] = w[:, None] * aside, w, 1
        changed[:, V], changed[:, W] = alpha[:, None] * aside - (w * w)[:, None] * c, alpha
        return changed

    @cached_property
    def begun(self) -> WideArray:
        """The rate of y (3,) in the first instant of a motion from rest in one cone."""
        state = self.first
        c, scale = state[C], np.array([self.friction, self.friction, self.torsional])
        lever = np.array([c[1], -c[0], Wide(1)])
        mobility = np.diag([1 / self.mass, 1 / self.mass, Wide(0)]) + np.outer(lever, lever) / self.moment
        k = 2 * self.pressed(state[None, T])[0] * scale[:, None] * mobility * scale
        free = scale * np.array([self.gravity, Wide(0), Wide(0)])
        matrix = MP.matrix([[exactly(each) for each in row] for row in k])
        vector = MP.matrix([exactly(each) for each in free])
        low, high = MP.zero, MP.norm(vector)
        for _ in range(4 * HALVINGS):
            rho = (low + high) / 2
            shares = MP.lu_solve(matrix + rho * MP.eye(3), vector)
            low, high = (rho, high) if MP.norm(shares) > 1 else (low, rho)
        return np.array([wide(high * share) for share in shares])


def turning(grip: Grip, start: Real, times: Array, last: Real, stages: int) -> Turning:
    """Return the motion of a body that begins to turn at a time (s), at ascending times (n,) from then on, until `last` (s).

    stages: the number of nodes of a step.

    Raises `NotModelled` for a body that turns and slips with separate limits, and for contacts that leave the face of the body,
    and `OutOfReach` for too many steps.
    """
    whole = Turning(times.astype(Wide), np.zeros((len(times), 7), Wide), stages)
    state = np.zeros(7, Wide)
    state[C], state[T] = [-wide(each) for each in grip.arm], wide(start)
    kind: EventKind = "slip" if grip.one else "turn"
    begins: Real | None = start
    for _ in range(MOST_RESTS):
        if begins is not None:
            whole.events.append(Turned(kind, begins, state))
        state = _moving(grip, whole, state, wide(last))
        if not state[T] < wide(last):
            return whole
        now = exactly(state[T])
        begins = _yields(grip, state, now, last)
        if begins is not None and begins - now <= AT_ONCE * last:
            begins = None  # it swings back
            continue
        whole.events.append(Turned("rest", now, state))
        inside = int(np.searchsorted(whole.times, wide(last if begins is None else begins), side="right"))
        whole.fill(np.tile(state, (max(0, inside - whole.row), 1)))
        if begins is None:
            return whole
        state = state.copy()
        state[T] = wide(begins)
    raise OutOfReach(f"a body that comes to rest between its fingers more than {MOST_RESTS} times")


def _yields(grip: Grip, state: WideArray, now: Real, last: Real) -> Real | None:
    """The time (s) at which a body at rest is no longer held; None if it is until `last` (s)."""
    arm = tuple(-exactly(each) for each in state[C])
    resting = replace(grip, arm=(arm[0], arm[1]))
    load = constant(-grip.mass * abs(grip.gravity))
    while True:
        later = [start for start, _ in grip.press if start > now]
        until = min([*later, last])
        margin = piece_at(grip.press, now).from_time(now).times(resting.bearing).plus(load)
        yields = first_negative(margin, until - now)
        if yields is not None:
            return now + yields
        if until >= last:
            return None
        now = until


def _moving(grip: Grip, whole: Turning, state: WideArray, last: Wide) -> WideArray:
    """Fill in the states of a body that begins to turn from rest, and return its state when it rests, or at a time (s)."""
    begins = -np.sign(grip.gravity * exactly(state[1]))
    edges = [wide(start) for start, _ in grip.press]
    while state[T] < last:
        until = min([edge for edge in edges if edge > state[T]], default=last)
        until = min(until, last)
        press = piece_at(grip.press, exactly(state[T])).from_time(exactly(state[T]))
        numbers = (wide(each) for each in (grip.mass, grip.moment, grip.gravity, grip.friction, grip.torsional))
        laws = _Laws(grip, *numbers, press, state[T], float(begins), state)
        state, rests = (_in_one_cone if grip.one else _as_pendulum)(laws, whole, state, until)
        if rests:
            return state
    return state


def _as_pendulum(laws: _Laws, whole: Turning, state: WideArray, until: Wide) -> tuple[WideArray, bool]:
    """Fill in the states of a pendulum until it comes to rest or a time (s). Returns the last state, and whether it rests."""
    first, origin = FIRST * _swing(laws, state), state[T]
    for step in steps(laws.rates, state, stages=whole.stages, first=first, most=MOST):
        end = min(step.end + origin, until)
        grid = step.start + (end - origin - step.start) * np.linspace(0, 1, PARTS).astype(Wide)
        inside = step.at(grid)
        back = np.flatnonzero(laws.sense * inside[1:, W] < 0)
        rests = bool(len(back))
        if rests:
            stop = _located(step, grid[back[0]], grid[back[0] + 1], lambda row: laws.sense * row[W] < 0)
            end = origin + stop
            inside = inside[: back[0] + 1]
        _check(laws, inside)
        _fill(whole, step, origin, end)
        if rests or end >= until:
            state = step.at(np.array([end - origin]))[0]
            state[T] = end
            if rests:
                state[V], state[W] = 0, 0
            return state, rests
    raise AssertionError  # `steps` is endless


def _in_one_cone(laws: _Laws, whole: Turning, state: WideArray, until: Wide) -> tuple[WideArray, bool]:
    """Fill in the states of a body in one cone until it rests or a time (s). Returns the last state, and whether it rests."""
    origin, moves = state[T], bool(np.any(state[V]) or state[W])
    if not moves:
        step = next(iter(steps(laws.rates, state, stages=whole.stages, first=FIRST * _swing(laws, state), most=MOST)))
        end = min(step.end + origin, until)
        _check(laws, step.at(np.linspace(0, 1, PARTS).astype(Wide) * (end - origin)))
        _fill(whole, step, origin, end)
        state = step.at(np.array([end - origin]))[0]
        state[T] = end
        if end >= until:
            return state, False
    largest = Wide(0)
    pace = _pace(laws, state)
    for step in steps(laws.paced, state, stages=whole.stages, first=FIRST * _swing(laws, state) / pace, most=MOST, memory=1):
        inside = step.at(step.start + step.size * np.linspace(0, 1, PARTS).astype(Wide))
        beyond = np.flatnonzero(inside[:, T] >= until)
        last = step.end
        if len(beyond):
            at = step.start + step.size * np.linspace(0, 1, PARTS).astype(Wide)[[beyond[0] - 1, beyond[0]]]
            last = _located(step, at[0], at[1], lambda row: row[T] >= until)
            inside = inside[: beyond[0]]
        _check(laws, inside)
        _fill_by_time(whole, step, last, until)
        state = step.at(np.array([last]))[0]
        pace = _pace(laws, state)
        largest = max(largest, pace)
        if len(beyond):
            state[T] = until
            return state, False
        if pace <= GONE * largest:
            state[V], state[W] = 0, 0
            return state, True
    raise AssertionError  # `steps` is endless


def _pace(laws: _Laws, state: WideArray) -> Wide:
    y = laws.scaled(state[None])[0]
    return Wide(np.sqrt((y * y).sum()))


def _swing(laws: _Laws, state: WideArray) -> float:
    """The time (s) in which gravity turns a body by a radian."""
    c = np.sqrt((state[C] * state[C]).sum())
    return float(np.sqrt((laws.mass * c * c + laws.moment) / (laws.mass * abs(laws.gravity) * c)))


def _located(step: Step, low: Wide, high: Wide, after: Callable[[WideArray], bool]) -> Wide:
    """The place in a step from which on a condition holds, between two others."""
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if after(step.at(np.array([middle]))[0]) else (middle, high)
    return high


def _fill(whole: Turning, step: Step, origin: Wide, end: Wide) -> None:
    """Fill in the states at the instants until a time (s) within a step in time, which began at `origin` (s)."""
    inside = int(np.searchsorted(whole.times, end, side="right"))
    whole.fill(step.at(whole.times[whole.row : inside] - origin))


def _fill_by_time(whole: Turning, step: Step, last: Wide, until: Wide) -> None:
    """Fill in the states at the instants within a step in the parameter q, until a parameter and a time (s)."""
    ended = min(step.at(np.array([last]))[0, T], until)
    inside = int(np.searchsorted(whole.times, ended, side="right"))
    wanted = whole.times[whole.row : inside]
    low, high = np.full(len(wanted), step.start), np.full(len(wanted), last)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        later = step.at(middle)[:, T] >= wanted if len(wanted) else np.zeros(0, bool)
        low, high = np.where(later, low, middle), np.where(later, middle, high)
    rows = step.at(high) if len(wanted) else np.zeros((0, 7), Wide)
    whole.fill(rows)


def _check(laws: _Laws, states: WideArray) -> None:
    """Raise `NotModelled` where contacts slip with separate limits, or leave the face of the body, in states (n, 7)."""
    grip, c = laws.grip, states[:, C]
    if not grip.one:
        accelerated = laws.rates(states)[:, V]
        accelerated[:, 0] -= laws.gravity
        force = laws.mass * np.sqrt((accelerated * accelerated).sum(axis=1))
        _refuse(states, force > 2 * laws.friction * laws.pressed(states[:, T]), "a body that turns and slips between fingers")
    cosine, sine = np.cos(states[:, ANGLE]), np.sin(states[:, ANGLE])
    along, across = -(cosine * c[:, 0] + sine * c[:, 1]), sine * c[:, 0] - cosine * c[:, 1]
    for one, other, half in grip.faces:
        there = np.abs(along * wide(one) + across * wide(other))
        _refuse(states, there > wide(half), "a body that slips out of its fingers")


def _refuse(states: WideArray, broken: WideArray, reason: str) -> None:
    if broken.any():
        raise NotModelled(f"{reason}, at t = {float(states[int(np.argmax(broken)), T]):.6g} s")
