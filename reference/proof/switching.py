"""The motion of one joint that is linear in pieces, in balls, from mode to mode (`modes`).

The function that has become zero determines the next mode, and the motion goes on only if the functions of this mode are known
to become positive. Rebounds from a rigid stop that accumulate are enclosed together.
"""

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Literal

from flint import arb, ctx

from bodycheck.reference.mechanisms.control import Controller, Samples, Signal, Sine, Stops
from bodycheck.reference.proof.balls import Ball, ball, dot
from bodycheck.reference.proof.driven import Coordinate, Plant, breaks, gains, line
from bodycheck.reference.proof.enclosure import NotEnclosed
from bodycheck.reference.proof.linear import STEPS, Guard, System, at_root, first_root
from bodycheck.reference.proof.modes import FIRST_SINE, INTEGRAL, ONE, PLACE, TIME, VELOCITY, Joint, Mode, Row, plus, times
from bodycheck.reference.proof.motions import Piece, course

#: The bits by which speeds have decreased when all further rebounds are enclosed together, as a part of all bits.
LAST_REBOUND = 0.35


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
    error = plus(target, bare.unit(PLACE, -1))
    law = plus(plus(times(kp, error), times(kd, plus(speed, bare.unit(VELOCITY, -1)))), bare.unit(INTEGRAL, ki))
    return replace(bare, error=error, law=plus(law, effort))


def _row(joint: Joint, signal: Signal, begin: Fraction) -> Row:
    """The row of a signal."""
    if isinstance(signal, Sine):
        number = next(index for index, sine in enumerate(joint.sines) if sine is signal)
        return plus(joint.unit(FIRST_SINE + 2 * number, ball(signal.amplitude)), joint.unit(ONE, ball(signal.offset)))
    if not isinstance(signal, Samples):
        return joint.unit(ONE, ball(signal))
    value, slope, since = line(signal, begin)
    return plus(joint.unit(ONE, ball(value - slope * since)), joint.unit(TIME, ball(slope)))


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
    speed = _sign(plus(joint.unit(VELOCITY, direction), faster), state)
    return (0 if speed <= 0 else 1) if direction > 0 else (-1 if speed <= 0 else -2)


def _cut(joint: Joint, mode: Mode, state: Row) -> Literal["", "above", "below"]:
    """Return whether the effort of a law is cut at a state."""
    caps = joint.caps(mode)
    if caps is None:
        return ""
    if _sign(plus(joint.law, times(-1, caps[0])), state) > 0:
        return "above"
    return "below" if _sign(plus(joint.law, times(-1, caps[1])), state) < 0 else ""


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
