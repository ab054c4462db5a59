"""Spheres, and cylinders on their side, that fly, bounce, slip and roll on a plane.

The point that touches slips with u = v - r w x n. While it slips, friction decelerates u by (1 + 1 / k) times what it
decelerates the centre, k = I / (m r^2); an impact ends the slip if friction allows so large an impulse.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from tests.judge.numerals import ONE, ZERO, Matrix, Vector, cross, exact, plus, product, times
from tests.judge.planes import OnPlane, lying, on_plane
from tests.judge.slips import Slip, length
from tests.judge.states import Motion, State
from tests.judge.turning import turned, while_slipping, with_steady_change

#: Speed of a bounce, relative to the first, below which all that follow are one: their time is a geometric series.
LAST_BOUNCE = Decimal("1e-26")

#: Slips (m/s) that are rounding.
NO_SLIP = Decimal("1e-40")

#: Bounces after which a motion is given up.
BOUNCES = 6000

NORMAL: Vector = (ZERO, ZERO, ONE)


@dataclass(frozen=True)
class Phase:
    """A part of a motion: its length, None if it has no end; position, velocity and spin after a time; rotations at times."""

    length: Decimal | None
    after: Callable[[Decimal], tuple[Vector, Vector, Vector]]
    rotations: Callable[[Sequence[Decimal]], list[Matrix]]


def motion(text: str, instants: Sequence[Decimal]) -> Motion:
    """Return the motion of a sphere or of a cylinder on its side."""
    body = on_plane(text)
    radius = exact(body.table["radius"])
    axis = 0 if body.table["shape"] == "sphere" else 2
    ratio = body.inertia.tensor[axis][axis] / (body.inertia.mass * radius * radius)
    laws = Laws(body, radius, ratio)
    position, velocity, spin, turn = body.position, body.velocity, body.spin, body.turn
    touching = lying(body, radius)
    if touching:
        velocity = (velocity[0], velocity[1], ZERO)
    if axis == 2:
        velocity, spin = _across(body, velocity, spin)
    now, events, states, first = ZERO, list[tuple[str, Decimal]](), dict[int, State](), ZERO
    bounces = 0
    while True:
        phase = laws.contact(position, velocity, spin) if touching else laws.flight(position, velocity, spin)
        here = [i for i, t in enumerate(instants) if i not in states and (phase.length is None or t <= now + phase.length)]
        here = [i for i in here if instants[i] >= now]
        times_here = [instants[i] - now for i in here]
        last = phase.length is None or now + phase.length > instants[-1]
        rotations = phase.rotations(times_here if phase.length is None or last else [*times_here, phase.length])
        for i, time, rotation in zip(here, times_here, rotations, strict=False):
            states[i] = body.in_world(*phase.after(time)[:2], product(rotation, turn), phase.after(time)[2])
        if phase.length is None or last:
            return Motion(states, events)
        position, velocity, spin = phase.after(phase.length)
        turn = product(rotations[-1], turn)
        now += phase.length
        if touching:
            events.append(("roll" if laws.holds() else "slip", now))
            continue
        speed = -velocity[2]
        first = first or speed
        events.append(("impact", now))
        velocity, spin = laws.impact(velocity, spin)
        position = (position[0], position[1], radius)
        bounces += 1
        if bounces > BOUNCES:
            raise ValueError("too many bounces")
        if velocity[2] <= LAST_BOUNCE * first:
            if velocity[2]:
                now += 2 * velocity[2] / (-body.gravity[2] * (1 - body.restitution))
            velocity, touching = (velocity[0], velocity[1], ZERO), True
            grips = length(laws.slip(velocity, spin)) <= NO_SLIP + LAST_BOUNCE * 10 * first and laws.holds()
            still = length(velocity[:2]) <= NO_SLIP and not body.gravity[0]
            events.append(("rest" if grips and still else "roll" if grips else "slip", now))


def _across(body: OnPlane, velocity: Vector, spin: Vector) -> tuple[Vector, Vector]:
    """Return velocity and spin of a cylinder whose axis is exactly along the plane, and across the fall line of an incline."""
    x, y = body.turn[0][2], body.turn[1][2]
    if body.gravity[0]:
        x, y = ZERO, ONE.copy_sign(y)
    x, y = x / length((x, y)), y / length((x, y))
    rate, speed = spin[0] * x + spin[1] * y, velocity[0] * y - velocity[1] * x
    return (speed * y, -speed * x, velocity[2]), (rate * x, rate * y, ZERO)


@dataclass(frozen=True)
class Laws:
    body: OnPlane
    radius: Decimal
    ratio: Decimal

    def slip(self, velocity: Vector, spin: Vector) -> tuple[Decimal, Decimal]:
        """Return the velocity of the point that touches, along the plane."""
        point = plus(velocity, times(-self.radius, cross(spin, NORMAL)))
        return point[0], point[1]

    def holds(self) -> bool:
        """Return whether friction keeps the point that touches from slipping."""
        needed = length(self.body.gravity[:2]) * self.ratio / (1 + self.ratio)
        return self.body.friction is None or needed <= self.body.friction * -self.body.gravity[2]

    def flight(self, position: Vector, velocity: Vector, spin: Vector) -> Phase:
        """Return the flight up to the next touch."""
        gravity = self.body.gravity
        gap, fall = position[2] - self.radius, -gravity[2]
        end = None
        if fall:
            root = (velocity[2] * velocity[2] + 2 * fall * max(gap, ZERO)).sqrt()
            end = (velocity[2] + root) / fall if velocity[2] >= 0 else 2 * gap / (root - velocity[2])
        elif velocity[2] < 0:
            end = gap / -velocity[2]

        def after(time: Decimal) -> tuple[Vector, Vector, Vector]:
            moved = plus(position, times(time, velocity), times(time * time / 2, gravity))
            return moved, plus(velocity, times(time, gravity)), spin

        return Phase(end, after, lambda instants: [turned(spin, time) for time in instants])

    def impact(self, velocity: Vector, spin: Vector) -> tuple[Vector, Vector]:
        """Return velocity and spin after an impact."""
        speed, slip = -velocity[2], self.slip(velocity, spin)
        size = length(slip)
        change = size * self.ratio / (1 + self.ratio)
        if self.body.friction is not None:
            change = min(change, self.body.friction * (1 + self.body.restitution) * speed)
        x, y = (slip[0] / size, slip[1] / size) if size else (ZERO, ZERO)
        after = (velocity[0] - change * x, velocity[1] - change * y, self.body.restitution * speed)
        turn = times(change / (self.ratio * self.radius), cross(NORMAL, (x, y, ZERO)))
        return after, plus(spin, turn)

    def contact(self, position: Vector, velocity: Vector, spin: Vector) -> Phase:
        """Return the slip, or the rolling, of a body that touches."""
        slip, friction, fall = self.slip(velocity, spin), self.body.friction, -self.body.gravity[2]
        if friction is None or (length(slip) <= NO_SLIP and self.holds()):
            return self._rolling(position, velocity, spin)
        return self._slipping(position, velocity, spin, (ZERO, ZERO) if length(slip) <= NO_SLIP else slip, friction * fall)

    def _rolling(self, position: Vector, velocity: Vector, spin: Vector) -> Phase:
        downhill = (self.body.gravity[0], self.body.gravity[1], ZERO)
        rate = times(1 / (1 + self.ratio), downhill)
        turning = times(1 / self.radius, cross(NORMAL, rate))

        def after(time: Decimal) -> tuple[Vector, Vector, Vector]:
            moved = plus(position, times(time, velocity), times(time * time / 2, rate))
            return moved, plus(velocity, times(time, rate)), plus(spin, times(time, turning))

        steady = not any(turning)
        return Phase(
            None,
            after,
            lambda instants: (
                [turned(spin, time) for time in instants] if steady else with_steady_change(spin, turning, instants)
            ),
        )

    def _slipping(self, position: Vector, velocity: Vector, spin: Vector, slip: Any, friction: Decimal) -> Phase:
        drive = (self.body.gravity[0], self.body.gravity[1])
        part = 1 + 1 / self.ratio
        course = Slip(drive, part * friction, slip)
        end = course.end()
        turning = friction / (self.ratio * self.radius)

        def after(time: Decimal) -> tuple[Vector, Vector, Vector]:
            at_end = end is not None and time >= end
            reached, path = course.at(time) if not at_end else ((ZERO, ZERO), course.path_to_end())
            # the integral of the direction of the slip, and the integral of that
            if not friction:
                braked, braked_way = (ZERO, ZERO), (ZERO, ZERO)
            else:
                braked = tuple((g * time - (u - u0)) / course.friction for g, u, u0 in zip(drive, reached, slip, strict=True))
                braked_way = tuple(
                    (g * time * time / 2 - (way - u0 * time)) / course.friction
                    for g, way, u0 in zip(drive, path, slip, strict=True)
                )
            moved = [
                p + v * time + g * time * time / 2 - friction * b
                for p, v, g, b in zip(position[:2], velocity[:2], drive, braked_way, strict=True)
            ]
            speed = [v + g * time - friction * b for v, g, b in zip(velocity[:2], drive, braked, strict=True)]
            return (
                (moved[0], moved[1], position[2]),
                (speed[0], speed[1], ZERO),
                plus(spin, times(turning, cross(NORMAL, (braked[0], braked[1], ZERO)))),
            )

        def rotations(instants: Sequence[Decimal]) -> list[Matrix]:
            if not friction:
                return [turned(spin, time) for time in instants]
            if course.straight:
                direction = course.direction()
                change = times(turning, cross(NORMAL, (direction[0], direction[1], ZERO)))
                return with_steady_change(spin, change, instants)
            return while_slipping(spin, slip, drive, course.friction, turning, instants)

        return Phase(end, after, rotations)
