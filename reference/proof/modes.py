"""The motion of one joint that is linear in pieces, in balls: limits of a continuous law, dry friction, and stops.

A mode has a linear system, and linear functions of the state that are positive while it lasts (`linear`). The state has the
coordinate, its velocity, the integral of the error, 1, the time, and the sine and the cosine of each signal that is a sine. The
function that has become zero determines the next mode, and the motion goes on only if the functions of this mode are known to
become positive.
"""

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal

from flint import arb, ctx

from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops
from bodycheck.reference.proof.balls import Ball, ball, dot
from bodycheck.reference.proof.bodies import as_ball
from bodycheck.reference.proof.driven import Coordinate, Plant, breaks, gains, line
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.linear import STEPS, Guard, System, at_root, first_root
from bodycheck.reference.proof.motions import Piece, course

#: The places of the coordinate, the velocity, the integral, 1 and the time in the state.
PLACE, VELOCITY, INTEGRAL, ONE, TIME, FIRST_SINE = range(6)

#: The bits by which speeds have decreased when all further rebounds are enclosed together, as a part of all bits.
LAST_REBOUND = 0.35

#: The largest number of modes at one instant.
MOST_AT_ONCE = 20

Row = list[Ball]


@dataclass(frozen=True)
class Mode:
    """A mode of a joint.

    Attributes
    ----------
    cut
        Whether the effort is cut above or below.
    band
        For a motor with a no-load speed n, the interval of the velocity, from -2 to 1: its border below is `band` n, or none.
    stop
        The stop that acts: an elastic one pushes, or is passed and would pull, or a rigid one holds the joint.
    side
        The side of that stop: 1 for the upper one, -1 for the lower one.
    slip
        The direction of the velocity with dry friction, 0 where it holds the joint; None without friction.
    """

    cut: Literal["", "above", "below"] = ""
    band: int | None = None
    stop: Literal["", "pushes", "passed", "holds"] = ""
    side: int = 0
    slip: int | None = None


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint with its controller in an interval of time without breaks of signals: the rows of what acts on it."""

    plant: Plant
    friction: Fraction
    stops: Stops | None
    controller: Controller | None
    error: Row
    law: Row
    sines: tuple[Sine, ...]

    def unit(self, place: int, value: Ball | int = 1) -> Row:
        """The row with one entry."""
        row = [arb(0)] * (FIRST_SINE + 2 * len(self.sines))
        row[place] = arb(value)
        return row

    def caps(self, mode: Mode) -> tuple[Row, Row] | None:
        """The largest and the smallest effort in a mode; None without a limit."""
        if self.controller is None or self.controller.effort_limit is None:
            return None
        most = self.unit(ONE, ball(self.controller.effort_limit))
        if mode.band is None:
            return most, _times(-1, most)
        assert self.controller.no_load_speed is not None
        slope = self.unit(VELOCITY, ball(self.controller.effort_limit) / ball(self.controller.no_load_speed))
        zero = _times(0, most)
        above = {-2: most, -1: most, 0: _plus(most, _times(-1, slope)), 1: zero}[mode.band]
        below = {-2: zero, -1: _times(-1, _plus(most, slope)), 0: _times(-1, most), 1: _times(-1, most)}[mode.band]
        return above, below

    def beyond(self, side: int) -> Row:
        """How far the coordinate is beyond a stop."""
        assert self.stops is not None
        limit = self.stops.upper if side > 0 else self.stops.lower
        assert limit is not None
        return _plus(self.unit(PLACE, side), self.unit(ONE, -side * ball(limit)))

    def pushing(self, side: int) -> Row:
        """The force of an elastic stop away from it."""
        assert self.stops is not None
        stiff, damped = ball(self.stops.stiffness), ball(self.stops.damping)
        return _plus(_times(stiff, self.beyond(side)), self.unit(VELOCITY, side * damped))

    def drive(self, mode: Mode) -> Row:
        """The force on the joint, without dry friction and rigid stops."""
        caps = self.caps(mode)
        law = self.law if not mode.cut else caps[0 if mode.cut == "above" else 1]  # type: ignore[index]
        plant = self.plant
        constant = as_ball(plant.force) + ball(plant.stiffness * plant.rest)
        force = _plus(law, self.unit(ONE, constant))
        force = _plus(force, self.unit(VELOCITY, -ball(plant.damping)))
        force = _plus(force, self.unit(PLACE, -ball(plant.stiffness)))
        return force if mode.stop != "pushes" else _plus(force, _times(-mode.side, self.pushing(mode.side)))

    def system(self, mode: Mode) -> System:
        """The linear system of a mode."""
        still = mode.stop == "holds" or mode.slip == 0
        force = self.drive(mode)
        if mode.slip:
            force = _plus(force, self.unit(ONE, -mode.slip * ball(self.friction)))
        acceleration = _times(0 if still else 1 / ball(self.plant.inertia), force)
        zero = self.unit(ONE, 0)
        rows = [zero if still else self.unit(VELOCITY), acceleration, self.error, zero, self.unit(ONE)]
        for number, sine in enumerate(self.sines):
            place, rate = FIRST_SINE + 2 * number, ball(sine.angular_frequency)
            rows += [self.unit(place + 1, rate), self.unit(place, -rate)]
        fast = max([arb(1), *(ball(sine.angular_frequency) for sine in self.sines)], key=float)
        fast = max([fast, abs(acceleration[PLACE]).sqrt(), abs(acceleration[VELOCITY])], key=lambda each: float(each.mid()))
        fast = arb(fast.mid())
        units = [arb(1), fast, 1 / fast, arb(1), 1 / fast, *[arb(1)] * (2 * len(self.sines))]
        return System(rows, units)

    def guards(self, mode: Mode) -> list[Guard]:
        """The functions that are positive while a mode lasts."""
        return [*self._guards_of_law(mode), *self._guards_of_friction(mode), *self._guards_of_stops(mode)]

    def _guards_of_law(self, mode: Mode) -> Iterator[Guard]:
        caps = self.caps(mode)
        if caps is None:
            return
        for name, room in (("above", _plus(caps[0], _times(-1, self.law))), ("below", _plus(self.law, _times(-1, caps[1])))):
            if mode.cut in ("", name):
                yield Guard(name, _times(-1, room) if mode.cut else room)
        if mode.band is None or self.controller is None:
            return
        speed = ball(self.controller.no_load_speed or 0)
        if mode.band > -2 and not (mode.band == 0 and mode.slip is not None):
            yield Guard("slower", _plus(self.unit(VELOCITY), self.unit(ONE, -mode.band * speed)))
        if mode.band < 1 and not (mode.band == -1 and mode.slip is not None):
            yield Guard("faster", _plus(self.unit(VELOCITY, -1), self.unit(ONE, (mode.band + 1) * speed)))

    def _guards_of_friction(self, mode: Mode) -> Iterator[Guard]:
        if mode.stop == "holds" or mode.slip is None:
            return
        if mode.slip:
            yield Guard("rests", self.unit(VELOCITY, mode.slip))
            return
        limit, force = self.unit(ONE, ball(self.friction)), self.drive(mode)
        yield Guard("forwards", _plus(limit, _times(-1, force)))
        yield Guard("backwards", _plus(limit, force))

    def _guards_of_stops(self, mode: Mode) -> list[Guard]:
        if self.stops is None:
            return []
        if mode.stop == "holds":
            force = _times(mode.side, self.drive(mode))
            return [Guard("leaves", _plus(force, self.unit(ONE, ball(self.friction))))]
        if not mode.stop:
            sides = [(1, self.stops.upper), (-1, self.stops.lower)]
            return [Guard(f"reaches{side}", _times(-1, self.beyond(side))) for side, limit in sides if limit is not None]
        inside = [Guard("returns", self.beyond(mode.side))]
        if mode.stop == "passed":
            return [*inside, Guard("pushes", _times(-1, self.pushing(mode.side)))]
        return [Guard("pulls", self.pushing(mode.side)), *(inside if self.stops.damping else [])]


def _plus(one: Row, other: Row) -> Row:
    return [a + b for a, b in zip(one, other, strict=True)]


def _times(factor: Ball | int, row: Row) -> Row:
    return [factor * entry for entry in row]


def coordinate(plant: Plant, friction: Fraction, stops: Stops | None, controller: Controller | None) -> Coordinate:
    """Return the coordinate of a joint with a continuous law, or none, with dry friction, limits and stops."""
    motion = course(_pieces(plant, friction, stops, controller))

    def at(t: Fraction) -> tuple[Ball, Ball]:
        q, v = motion.at(t)
        return q, v

    return at


def _joint(plant: Plant, friction: Fraction, stops: Stops | None, controller: Controller | None, begin: Fraction) -> Joint:
    """The rows of a joint from a time (s) on, until the next break of a signal."""
    signals = (controller.target, controller.target_velocity, controller.effort) if controller else ()
    sines = tuple(signal for signal in signals if isinstance(signal, Sine))
    bare = Joint(plant, friction, stops, controller, [], [], sines)
    zero = bare.unit(ONE, 0)
    if controller is None:
        return replace(bare, error=zero, law=zero)
    target, speed, effort = (_row(bare, signal, begin) for signal in signals)
    kp, kd, ki = map(ball, gains(controller))
    error = _plus(target, bare.unit(PLACE, -1))
    law = _plus(_plus(_times(kp, error), _times(kd, _plus(speed, bare.unit(VELOCITY, -1)))), bare.unit(INTEGRAL, ki))
    return replace(bare, error=error, law=_plus(law, effort))


def _row(joint: Joint, signal: Signal, begin: Fraction) -> Row:
    """The row of a signal."""
    if isinstance(signal, Sine):
        number = next(index for index, sine in enumerate(joint.sines) if sine is signal)
        return _plus(joint.unit(FIRST_SINE + 2 * number, ball(signal.amplitude)), joint.unit(ONE, ball(signal.offset)))
    if not isinstance(signal, Samples):
        return joint.unit(ONE, ball(signal))
    value, slope, since = line(signal, begin)
    return _plus(joint.unit(ONE, ball(value - slope * since)), joint.unit(TIME, ball(slope)))


def _pieces(plant: Plant, friction: Fraction, stops: Stops | None, controller: Controller | None) -> Iterator[Piece]:
    """Yield the pieces of the motion, whose states are the coordinate and its velocity."""
    ends: list[Fraction | None] = [*sorted(set(breaks(controller)))] if controller else []
    begin, state = Fraction(0), None
    for end in [*ends, None]:
        joint = _joint(plant, friction, stops, controller, begin)
        if state is None:
            sines = [ball(sine.phase).sin_cos() for sine in joint.sines]
            state = [
                ball(plant.start),
                ball(plant.velocity),
                arb(0),
                arb(1),
                arb(0),
                *(each for pair in sines for each in pair),
            ]
        state = yield from _until(joint, state, ball(begin), None if end is None else ball(end))
        begin = end or begin


def _until(joint: Joint, state: Row, time: Ball, end: Ball | None) -> Generator[Piece, None, Row]:
    """Yield the pieces until a break of a signal, and return the state there."""
    mode = _first_mode(joint, state)
    zeros: dict[str, int] = {}
    first: Ball | None = None
    while True:
        system = joint.system(mode)
        guards = _checked(joint, mode, system, state, zeros)
        at, span = _shown(system, state), STEPS * system.step
        last = end is not None and not time + span < end
        if last or not guards:
            span = arb.pos_inf() if end is None else end - time
        root = first_root(system, state, guards, span)
        if root is None:
            now = end if last or not guards else time + span
            yield Piece(time, now, at)
            assert now is not None  # there is no piece after one without an end
            state, time, zeros = _exact(system.after(state, span), now), now, {}
            if now is end:
                return state
            continue
        lasting, state = at_root(system, state, root[1].row, root[0])
        name, now = root[1].name, time + lasting
        state = _exact(state, now)
        jumps = name.startswith("reaches") and joint.stops is not None and joint.stops.rigid
        yield Piece(time, now, at, jumps=jumps)
        time = now
        if not jumps:
            mode, state, zeros = _next(joint, mode, state, name)
            continue
        side = int(name.removeprefix("reaches"))
        state, mode, zeros, speed = _rebound(joint, mode, state, side)
        first = speed if first is None else first
        if speed.is_zero():
            mode, zeros = _held(joint, mode, state, side)
        elif not speed > first * arb(2) ** -round(LAST_REBOUND * ctx.prec):
            lasting, state = _accumulated(joint, mode, state, side)
            yield Piece(time, time + lasting, _constant(state[PLACE], state[VELOCITY]), jumps=True)
            time = time + lasting
            state = _placed(joint, state, side)
            mode, zeros = _held(joint, mode, state, side)
            first = None


def _constant(q: Ball, v: Ball) -> Callable[[Ball], tuple[Ball, Ball]]:
    return lambda _: (q, v)


def _shown(system: System, state: Row) -> Callable[[Ball], tuple[Ball, Ball]]:
    def at(t: Ball) -> tuple[Ball, Ball]:
        now = system.after(state, t)
        return now[PLACE], now[VELOCITY]

    return at


def _exact(state: Row, time: Ball) -> Row:
    """A state with its components 1 and the time."""
    return [*state[:ONE], arb(1), time, *state[FIRST_SINE:]]


def _placed(joint: Joint, state: Row, side: int) -> Row:
    """A state at a stop, at rest."""
    assert joint.stops is not None
    limit = joint.stops.upper if side > 0 else joint.stops.lower
    assert limit is not None
    return [ball(limit), arb(0), *state[INTEGRAL:]]


def _sign(row: Sequence[Ball], state: Row) -> int:
    """The sign of a linear function of a state, 0 if it is exactly zero."""
    value = dot(row, state)
    if value.is_zero():
        return 0
    if value > 0 or value < 0:
        return 1 if value > 0 else -1
    raise NotEnclosed("a joint of which it is not decided what it does")


def _checked(joint: Joint, mode: Mode, system: System, state: Row, zeros: dict[str, int]) -> list[Guard]:
    """The guards of a mode that begins, with the number of their derivatives that are zero; those that stay zero are left out.

    Raises `NotEnclosed` if one is not known to become positive.
    """
    kept = []
    for guard in joint.guards(mode):
        leading, row = zeros.get(guard.name, 0), guard.row
        for _ in range(leading):
            row = system.derivative(row)
        while leading < len(row) + 2 and not (sign := _sign(row, state)):
            row, leading = system.derivative(row), leading + 1
        if leading == len(row) + 2:
            continue
        if sign < 0:
            raise NotEnclosed("a joint whose next motion is not decided")
        kept.append(replace(guard, zeros=leading))
    return kept


def _first_mode(joint: Joint, state: Row) -> Mode:
    """The mode in which a motion begins, or goes on after a break of a signal."""
    stop, side = "", 0
    if joint.stops is not None:
        for each, limit in ((1, joint.stops.upper), (-1, joint.stops.lower)):
            if limit is None or (beyond := _sign(joint.beyond(each), state)) < 0:
                continue
            side = each
            if joint.stops.rigid:
                return _held(joint, Mode(), state, each)[0]
            if not beyond:
                raise NotEnclosed("a joint that begins at an elastic stop")
            stop = "pushes" if _sign(joint.pushing(each), state) > 0 else "passed"
    return _moving(joint, Mode(stop=stop, side=side), state)  # type: ignore[arg-type]


def _moving(joint: Joint, mode: Mode, state: Row) -> Mode:
    """A mode whose cut, band and direction of slip are those of a state."""
    direction = _sign(joint.unit(VELOCITY), state)
    mode = replace(mode, band=_band(joint, state, direction or 1))
    mode = replace(mode, cut=_cut(joint, mode, state))
    if direction or not joint.friction:
        pull = _sign(joint.drive(mode), state) if not direction and mode.band is not None else 1
        slip = direction if joint.friction else None
        return replace(mode, slip=slip, band=_band(joint, state, direction or pull or 1))
    slip = _breaking(joint, mode, state)
    return replace(mode, slip=slip, band=_band(joint, state, slip or 1))


def _breaking(joint: Joint, mode: Mode, state: Row) -> int:
    """The direction in which a joint at rest begins to move; 0 if dry friction holds it."""
    pull = dot(joint.drive(mode), state)
    if abs(pull) <= ball(joint.friction):
        return 0
    if abs(pull) > ball(joint.friction):
        return 1 if pull > 0 else -1
    raise NotEnclosed("a joint of which it is not decided whether it sticks")


def _band(joint: Joint, state: Row, direction: int) -> int | None:
    """The interval of a velocity; for a velocity of zero, that of the direction in which the joint moves next."""
    if joint.controller is None or joint.controller.no_load_speed is None or joint.controller.effort_limit is None:
        return None
    faster = joint.unit(ONE, -ball(joint.controller.no_load_speed))
    speed = _sign(_plus(joint.unit(VELOCITY, direction), faster), state)
    return (0 if speed <= 0 else 1) if direction > 0 else (-1 if speed <= 0 else -2)


def _cut(joint: Joint, mode: Mode, state: Row) -> Literal["", "above", "below"]:
    """Whether the effort of a law is cut at a state."""
    caps = joint.caps(mode)
    if caps is None:
        return ""
    if _sign(_plus(joint.law, _times(-1, caps[0])), state) > 0:
        return "above"
    return "below" if _sign(_plus(joint.law, _times(-1, caps[1])), state) < 0 else ""


def _next(joint: Joint, mode: Mode, state: Row, name: str) -> tuple[Mode, Row, dict[str, int]]:
    """The mode after a function has become zero, the state, and the derivatives of functions that are zero by this."""
    still = [state[PLACE], arb(0), *state[INTEGRAL:]]
    match name:
        case "above" | "below":
            return replace(mode, cut="" if mode.cut else name), state, {name: 1}
        case "slower" | "faster":
            assert mode.band is not None
            return replace(mode, band=mode.band + (1 if name == "faster" else -1)), state, {_other(name): 1}
        case "rests":
            return _moving(joint, mode, still), still, {}
        case "forwards" | "backwards":
            slip = 1 if name == "forwards" else -1
            return replace(mode, slip=slip, band=_band(joint, still, slip)), still, {"rests": 2}
        case "leaves":
            away = replace(mode, stop="", side=0, band=_band(joint, still, -mode.side))
            zeros = {f"reaches{mode.side}": 3, "rests": 2}
            return replace(away, slip=-mode.side if joint.friction else None), still, zeros
        case "pushes":
            return replace(mode, stop="pushes"), state, {"pulls": 1}
    assert joint.stops is not None
    if name.startswith("reaches"):
        side = int(name.removeprefix("reaches"))
        return replace(mode, stop="pushes", side=side), state, {"returns": 1, "pulls": 0 if joint.stops.damping else 1}
    if name == "pulls" and joint.stops.damping:
        return replace(mode, stop="passed"), state, {"pushes": 1}
    return replace(mode, stop="", side=0), state, {f"reaches{mode.side}": 1}


def _other(name: str) -> str:
    return "slower" if name == "faster" else "faster"


def _rebound(joint: Joint, mode: Mode, state: Row, side: int) -> tuple[Row, Mode, dict[str, int], Ball]:
    """The state and mode after a rigid stop is reached, and the speed away from it."""
    assert joint.stops is not None
    velocity = -ball(joint.stops.restitution or 0) * state[VELOCITY]
    after = _placed(joint, state, side)
    after[VELOCITY] = velocity
    if velocity.is_zero():
        return after, mode, {}, velocity
    return after, _moving(joint, replace(mode, stop="", side=0), after), {}, abs(velocity)


def _held(joint: Joint, mode: Mode, state: Row, side: int) -> tuple[Mode, dict[str, int]]:
    """The mode of a joint at rest at a rigid stop: its force holds it there, or moves it away."""
    direction = _sign(joint.unit(VELOCITY), state)
    if direction:
        if direction == side:
            raise NotEnclosed("a joint that begins with an impact")
        return _moving(joint, replace(mode, stop="", side=0), state), {}
    mode = replace(mode, band=_band(joint, state, -side), stop="holds", side=side, slip=None)
    mode = replace(mode, cut=_cut(joint, mode, state))
    force = side * dot(joint.drive(mode), state) + ball(joint.friction)
    if force >= 0:
        return mode, {}
    if force < 0:
        return replace(mode, stop="", side=0, slip=-side if joint.friction else None), {}
    raise NotEnclosed("a joint of which it is not decided whether it leaves its stop")


def _accumulated(joint: Joint, mode: Mode, state: Row, side: int) -> tuple[Ball, Row]:
    """The duration of all further rebounds from a rigid stop, as a ball that begins at zero, and balls of the state within it.

    With accelerations towards the stop of at least a, speeds decrease by a factor r < 1 from rebound to rebound, so that all
    take at most 2 v / (a (1 - r)). The accelerations are those in the balls, which are four times as large as a first estimate.
    """
    assert joint.stops is not None
    speed, still = abs(state[VELOCITY]).upper(), _placed(joint, state, side)
    whole, friction = ball(joint.plant.inertia), ball(joint.friction)

    def estimated(around: Row) -> tuple[Ball, Ball]:
        force = side * dot(joint.drive(replace(mode, slip=None)), around)
        out, back = (force + friction) / whole, (force - friction) / whole
        if not (back > 0 and out > 0):
            raise NotEnclosed("rebounds from a stop under a force that may vanish")
        ratio = ball(joint.stops.restitution or 0) * (back.upper() / out.lower()).sqrt()  # type: ignore[union-attr]
        if not ratio < 1:
            raise NotEnclosed("rebounds from a stop that may not accumulate")
        lasting = 2 * speed / (back.lower() * (1 - ratio))
        return lasting.upper(), (speed * speed / (2 * out.lower())).upper()

    lasting, height = (4 * each for each in estimated(still))
    inside = arb(lasting / 2, (lasting / 2).upper())
    around = [still[PLACE] - side * arb(height / 2, (height / 2).upper()), arb(0, speed)]
    around += [
        part + dot(row, still) * 2 * inside * arb(0, 1)
        for part, row in zip(still[2:], joint.system(mode).rows[2:], strict=True)
    ]
    around[ONE] = arb(1)
    most, highest = estimated(around)
    others = [guard for guard in joint.guards(mode) if not guard.name.startswith(("reaches", "rests", "slower", "faster"))]
    if not (most < lasting and highest < height and all(dot(guard.row, around) > 0 for guard in others)):
        raise NotEnclosed("rebounds from a stop within balls that are too large")
    return inside, around
