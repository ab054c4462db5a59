"""Bricks and standing cylinders that lie flat on a plane: they rest, or slide as a point does, until they tip."""

from collections.abc import Callable, Sequence
from decimal import Decimal

from tests.judge.numerals import HALF, ZERO, Vector, applied, cross, exact, plus, times, transposed
from tests.judge.planes import OnPlane, on_plane
from tests.judge.slips import Pair, Slip, length
from tests.judge.states import Motion, State

#: Speeds (m/s) that are rounding.
NO_SPEED = Decimal("1e-40")


def motion(text: str, instants: Sequence[Decimal]) -> Motion:
    """Return the motion of a block, as long as its face bears it."""
    body = on_plane(text)
    mass, still = body.inertia.mass, (ZERO, ZERO, ZERO)
    position, velocity = body.position, (body.velocity[0], body.velocity[1])
    states: dict[int, State] = {}
    events: list[tuple[str, Decimal]] = []
    edges = sorted({ZERO, *(exact(push.get(key, 0)) for push in body.pushes for key in ("from", "until") if key in push)})
    now, rested, stopped = ZERO, length(velocity) <= NO_SPEED, False
    while True:
        until = next((edge for edge in edges if edge > now), None)
        force, torque = _pushed(body, now)
        drive, load = (force[0], force[1]), -force[2]
        friction = ZERO if body.friction is None else body.friction
        rests = length(velocity) <= NO_SPEED and length(drive) <= friction * load
        course: Slip | None
        if rests:
            course, end = None, until
        else:
            start = velocity if length(velocity) > NO_SPEED else (ZERO, ZERO)
            course = Slip((drive[0] / mass, drive[1] / mass), friction * load / mass, start)
            stop = course.end()
            end = until if stop is None or (until is not None and until - now <= stop) else now + stop
        if not _bears(body, times(-1, (*drive, ZERO)) if rests else _friction(velocity, drive, friction * load), torque, load):
            state = body.in_world(position, (*velocity, ZERO), body.turn, still)
            return Motion(states | {i: state for i, instant in enumerate(instants) if instant == now}, [*events, ("tip", now)])
        if rests != rested or (stopped and not rests):  # a block that rests at the start has no event
            events.append(("rest" if rests else "slip", now))
        rested = rests

        def after(time: Decimal, course: Slip | None = course, at: Vector = position) -> tuple[Vector, Pair]:
            if course is None:
                return at, (ZERO, ZERO)
            stop = course.end()
            speed, path = ((ZERO, ZERO), course.path_to_end()) if stop is not None and time >= stop else course.at(time)
            return plus(at, (path[0], path[1], ZERO)), speed

        def bears(
            time: Decimal, drive: Pair = drive, held: Decimal = friction * load, load: Decimal = load, torque: Vector = torque
        ) -> bool:
            return _bears(body, _friction(after(time)[1], drive, held), torque, load)

        span = min(end or instants[-1], instants[-1]) - now
        tip = None if course is None or course.straight else _first_failure(bears, span)
        for i, instant in enumerate(instants):
            if i not in states and now <= instant <= now + (span if tip is None else tip):
                place, speed = after(instant - now)
                states[i] = body.in_world(place, (speed[0], speed[1], ZERO), body.turn, still)
        if tip is not None:
            return Motion(states, [*events, ("tip", now + tip)])
        if end is None or end > instants[-1]:
            return Motion(states, events)
        position, velocity = after(end - now)
        stopped = not rests and length(velocity) <= NO_SPEED
        now = end


def _first_failure(bears: Callable[[Decimal], bool], span: Decimal) -> Decimal | None:
    """Return the first time within a span at which the face no longer bears the load; None if it always does.

    The slip turns towards its drive, fastest at its end: instants are evenly spaced, and closer and closer to the end.
    """
    instants = sorted({*(span * n / 24 for n in range(24)), *(span * (1 - HALF**n) for n in range(5, 40))})
    low = ZERO
    for instant in instants:
        if not bears(instant):
            high = instant
            for _ in range(180):
                middle = (low + high) / 2
                low, high = (middle, high) if bears(middle) else (low, middle)
            return high
        low = instant
    return None


def _pushed(body: OnPlane, now: Decimal) -> tuple[Vector, Vector]:
    """Return force and torque about the centre of mass of gravity and pushes from an instant on, along the plane's axes."""
    force, torque = times(body.inertia.mass, body.gravity), (ZERO, ZERO, ZERO)
    for push in body.pushes:
        begins, ends = exact(push.get("from", 0)), push.get("until")
        if begins <= now and (ends is None or now < exact(ends)):
            each = applied(transposed(body.axes), exact(push["force"]))
            force = plus(force, each)
            torque = plus(torque, cross(applied(body.turn, exact(push.get("point", (0, 0, 0)))), each))
    return force, torque


def _friction(speed: Pair, drive: Pair, friction: Decimal) -> Vector:
    """Return the friction against a motion, or against a drive that begins one."""
    along = speed if length(speed) > NO_SPEED else drive
    size = length(along)
    return (-friction * along[0] / size, -friction * along[1] / size, ZERO) if size else (ZERO, ZERO, ZERO)


def _bears(body: OnPlane, reaction: Vector, torque: Vector, load: Decimal) -> bool:
    """Return whether the resultant of the load is within the face."""
    height = body.position[2]
    x = (-height * reaction[0] + torque[1]) / load
    y = (-height * reaction[1] - torque[0]) / load
    across = applied(transposed(body.turn), (x, y, ZERO))
    if body.table["shape"] == "cylinder":
        return length((x, y)) <= Decimal(body.table["radius"])
    inside = zip(across, exact(body.table["semi_axes"]), strict=True)
    return all(abs(place) <= edge for place, edge in inside)
