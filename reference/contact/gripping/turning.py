"""The motion of a body that turns about its contacts with two fingers on the world, by collocation in the widest type of NumPy.

The contacts do not slip: the body is a pendulum about them with dry friction. With the line d, the direction a = n x d and the
centre of mass at c from the contacts, its angle and angular velocity w about n obey

    (I + m |c|^2) w' = -m g c_a - 2 mu_t N sign(w),

as long as the force m (v' - g) of the contacts is at most 2 mu N.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from bodycheck.reference.contact.gripping.course import AT_ONCE
from bodycheck.reference.contact.gripping.grip import Grip
from bodycheck.reference.contact.gripping.waves import Wave, constant, first_negative, piece_at, values
from bodycheck.reference.contact.motion import EventKind
from bodycheck.reference.errors import OutOfReach
from bodycheck.reference.exact.numbers import Real, Wide, exactly, wide
from bodycheck.reference.integration.collocation import Step, steps
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import WideArray

#: The largest number of evaluations of the equations.
MOST = 60_000

#: The first step in units of the time in which gravity turns the body by a radian.
FIRST = 0.05

#: The number of parts of a step in which conditions are checked, and of halvings that locate where one is broken.
PARTS, HALVINGS = 33, 80

#: The largest number of times that a body turns back or comes to rest.
MOST_RESTS = 2000

#: Indices of the parts of a state: the angle, the angular velocity, and the time.
ANGLE, W, T = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Turned:
    """An event: its kind, its time (s), and the angle (rad) then."""

    kind: EventKind
    time: Real
    angle: Wide


@dataclass(eq=False)
class Turning:
    """The states (n, 3) at n instants (s), of which the first `row` are filled in, and the events, by steps with so many nodes.

    The motion is not known from a time (s) on, if that is not None.
    """

    times: WideArray
    states: WideArray
    stages: int
    events: list[Turned] = field(default_factory=list)
    row: int = 0
    ends_at: Wide | None = None

    def fill(self, states: WideArray) -> None:
        """Fill in the states (k, 3) at the next instants."""
        rows = slice(self.row, self.row + len(states))
        self.states[rows] = states
        self.row = rows.stop


@dataclass(frozen=True, eq=False)
class Pendulum:
    """A body about its contacts in the widest type, the press from a time (s) on, and the sense in which the body turns."""

    mass: Wide
    moment: Wide
    gravity: Wide
    torsional: Wide
    centre: WideArray
    press: Wave
    since: Wide
    sense: float

    def pressed(self, times: WideArray) -> WideArray:
        """The force N (n,) of a finger at times (n,)."""
        return values(self.press, times - self.since)[0]

    def centres(self, angles: WideArray) -> WideArray:
        """The centre of mass c (n, 2) from the contacts, along d and a, at angles (n,)."""
        return turned_by(self.centre, angles)

    def rates(self, states: WideArray) -> WideArray:
        """The rates (n, 3) of states (n, 3)."""
        weight = -self.mass * self.gravity * self.centres(states[:, ANGLE])[:, 1]
        braking = 2 * self.sense * self.torsional * self.pressed(states[:, T])
        swung = self.moment + self.mass * (self.centre @ self.centre)
        return np.stack([states[:, W], (weight - braking) / swung, np.ones(len(states), Wide)], axis=1)

    def forces(self, states: WideArray) -> WideArray:
        """The sizes (n,), N, of the force that the contacts exert in states (n, 3)."""
        c, w, alpha = self.centres(states[:, ANGLE]), states[:, W], self.rates(states)[:, W]
        along = -alpha * c[:, 1] - w * w * c[:, 0] - self.gravity
        across = alpha * c[:, 0] - w * w * c[:, 1]
        return np.asarray(self.mass * np.hypot(along, across))


def turned_by(centre: WideArray, angles: WideArray) -> WideArray:
    """Return a vector (2,) turned by angles (n,), rad."""
    cosine, sine = np.cos(angles), np.sin(angles)
    return np.stack([cosine * centre[0] - sine * centre[1], sine * centre[0] + cosine * centre[1]], axis=1)


def centre_of(grip: Grip) -> WideArray:
    """Return the centre of mass (2,), m, from the contacts at the start, along d and a."""
    return np.array([-wide(each) for each in grip.arm], Wide)


def turning(grip: Grip, start: Real, times: Array, last: Real, stages: int) -> Turning:
    """Return the motion of a body that begins to turn at a time (s), at ascending times (n,) from then on, until `last` (s).

    stages: the number of nodes of a step. The motion is known until the contacts slip. Raises `OutOfReach` for too many steps.
    """
    whole = Turning(times.astype(Wide), np.zeros((len(times), 3), Wide), stages)
    state = np.array([Wide(0), Wide(0), wide(start)])
    begins: Real | None = start
    for _ in range(MOST_RESTS):
        if begins is not None:
            whole.events.append(Turned("turn", begins, state[ANGLE]))
        state = _moving(grip, whole, state, wide(last))
        if whole.ends_at is not None or not state[T] < wide(last):
            return whole
        now = exactly(state[T])
        begins = _yields(grip, state, now, last)
        if begins is not None and begins - now <= AT_ONCE * last:
            begins = None  # it swings back
            continue
        whole.events.append(Turned("rest", now, state[ANGLE]))
        inside = int(np.searchsorted(whole.times, wide(last if begins is None else begins), side="right"))
        whole.fill(np.tile(state, (max(0, inside - whole.row), 1)))
        if begins is None:
            return whole
        state = np.array([state[ANGLE], Wide(0), wide(begins)])
    raise OutOfReach(f"a body that comes to rest between its fingers more than {MOST_RESTS} times")


def _yields(grip: Grip, state: WideArray, now: Real, last: Real) -> Real | None:
    """The time (s) at which a body at rest is no longer held; None if it is until `last` (s)."""
    along, across = (-exactly(each) for each in turned_by(centre_of(grip), state[ANGLE : ANGLE + 1])[0])
    resting = replace(grip, arm=(along, across))
    load = constant(-grip.mass * abs(grip.gravity))
    while True:
        until = min([*(start for start, _ in grip.press if start > now), last])
        margin = piece_at(grip.press, now).from_time(now).times(resting.bearing).plus(load)
        yields = first_negative(margin, until - now)
        if yields is not None:
            return now + yields
        if until >= last:
            return None
        now = until


def _moving(grip: Grip, whole: Turning, state: WideArray, last: Wide) -> WideArray:
    """Fill in the states of a body that begins to turn from rest, and return its state when it rests, or at a time (s)."""
    sense = -float(np.sign(wide(grip.gravity) * turned_by(centre_of(grip), state[ANGLE : ANGLE + 1])[0, 1]))
    while state[T] < last:
        now = exactly(state[T])
        until = min([*(wide(start) for start, _ in grip.press if start > now), last])
        mass, moment, gravity, torsional = map(wide, (grip.mass, grip.moment, grip.gravity, grip.torsional))
        press = piece_at(grip.press, now).from_time(now)
        body = Pendulum(mass, moment, gravity, torsional, centre_of(grip), press, state[T], sense)
        state, rests = _swung(body, grip, whole, state, until)
        if rests or whole.ends_at is not None:
            break
    return state


def _swung(body: Pendulum, grip: Grip, whole: Turning, state: WideArray, until: Wide) -> tuple[WideArray, bool]:
    """Fill in the states of a pendulum until it rests or a time (s). Returns the last state, and whether it rests."""
    swung, origin = body.moment + body.mass * (body.centre @ body.centre), state[T]
    first = FIRST * float(np.sqrt(swung / (body.mass * abs(body.gravity) * np.hypot(*body.centre))))
    for step in steps(body.rates, state, stages=whole.stages, first=first, most=MOST):
        end = min(step.end + origin, until)
        grid = step.start + (end - origin - step.start) * np.linspace(0, 1, PARTS).astype(Wide)
        inside = step.at(grid)
        back = np.flatnonzero(body.sense * inside[1:, W] < 0)
        rests = bool(len(back))
        if rests:
            stop = _located(step, grid[back[0]], grid[back[0] + 1], lambda row: body.sense * row[W] < 0)
            end, inside = origin + stop, inside[: back[0] + 1]
        slips = np.flatnonzero(_slips(body, grip, inside))
        if len(slips):
            first = int(slips[0])
            places = grid[max(first - 1, 0)], grid[first]
            end = whole.ends_at = origin + _located(step, *places, lambda row: bool(_slips(body, grip, row[None])[0]))
        filled = int(np.searchsorted(whole.times, end, side="right"))
        whole.fill(step.at(whole.times[whole.row : filled] - origin))
        if rests or end >= until or whole.ends_at is not None:
            state = step.at(np.array([end - origin]))[0]
            state[T], state[W] = end, 0 if rests else state[W]
            return state, rests
    raise AssertionError  # `steps` is endless


def _slips(body: Pendulum, grip: Grip, states: WideArray) -> WideArray:
    """Return whether the contacts slip in states (n, 3)."""
    return np.asarray(body.forces(states) > 2 * wide(grip.friction) * body.pressed(states[:, T]))


def _located(step: Step, low: Wide, high: Wide, after: Callable[[WideArray], bool]) -> Wide:
    """The place in a step from which on a condition holds, between two others."""
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if after(step.at(np.array([middle]))[0]) else (middle, high)
    return high
