"""Two spheres that hit each other, in space or over a level plane, step by step in fifty digits.

The impulse between two spheres is the sum of one along the line of centres and one that friction exerts against the slip of
the points that touch. What each does on the plane is in `balls`. The next touch is looked for between the places where the
distance is smallest.
"""

import itertools
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any

from tests.judge.balls import NO_SLIP, Laws, Phase
from tests.judge.numerals import (
    IDENTITY,
    ONE,
    ZERO,
    Matrix,
    Vector,
    applied,
    attitude,
    cross,
    dot,
    exact,
    minus,
    plus,
    product,
    size,
    times,
)
from tests.judge.planes import OnPlane
from tests.judge.slips import length
from tests.judge.solids import inertia_of
from tests.judge.states import Motion, State

#: Speed of a bounce, relative to that of a fall by half the radius, below which a sphere stays on the plane.
LAST_BOUNCE = Decimal("1e-32")

#: The number of parts of a phase in which a minimum of the distance is looked for.
PARTS = 48

#: Events after which a motion is given up.
EVENTS = 3000

#: The difference of two times (s) that is rounding.
SAME = Decimal("1e-44")

#: Halvings of an interval, after which it is smaller than the last digit.
HALVINGS = 180


@dataclass(frozen=True)
class Sphere:
    """A sphere with its state along the axes of the world, and whether it stays on the plane."""

    body: OnPlane
    laws: Laws
    over_plane: bool
    position: Vector
    velocity: Vector
    spin: Vector
    turn: Matrix
    borne: bool

    def phase(self) -> Phase:
        """Return its motion until it lands or ceases to slip."""
        if self.borne:
            return self.laws.contact(self.position, self.velocity, self.spin)
        phase = self.laws.flight(self.position, self.velocity, self.spin)
        return phase if self.over_plane else replace(phase, length=None)

    def rolls(self) -> bool:
        """Return whether it touches the plane without slip."""
        return self.borne and length(self.laws.slip(self.velocity, self.spin)) <= NO_SLIP

    def after(self, phase: Phase, time: Decimal) -> "Sphere":
        """Return the sphere after a time."""
        position, velocity, spin = phase.after(time)
        turn = product(phase.rotations([time])[0], self.turn)
        return replace(self, position=position, velocity=velocity, spin=spin, turn=turn)


def motions(text: str, instants: Sequence[Decimal]) -> tuple[Motion, Motion]:
    """Return the motions of both spheres of a case file of format 2."""
    document = tomllib.loads(text)
    pair = document["scene"]["contacts"][0]
    friction, restitution = exact(pair["friction"]), exact(pair["restitution"])
    spheres = [_sphere(document, table) for table in document["bodies"]]
    found = Motion({}, []), Motion({}, [])
    now, touching = ZERO, False
    for _ in range(EVENTS):
        phases = [sphere.phase() for sphere in spheres]
        left = instants[-1] - now
        lasts = [left if phase.length is None else min(phase.length, left) for phase in phases]
        hit = _meeting(spheres, phases, min(lasts), touching)
        until = min(lasts) if hit is None else hit
        for index, instant in enumerate(instants):
            if now < instant <= now + until or instant == now == 0:
                for sphere, phase, motion in zip(spheres, phases, found, strict=True):
                    at = sphere.after(phase, instant - now)
                    motion.states[index] = _state(at)
        if until >= left:
            return found
        spheres = [sphere.after(phase, until) for sphere, phase in zip(spheres, phases, strict=True)]
        now += until
        touching = hit is not None
        if touching:
            spheres = _struck(spheres, friction, restitution, now, found)
            continue
        for index, phase in enumerate(phases):
            if phase.length is not None and phase.length - until <= SAME:
                spheres[index] = _landed(spheres[index], now, found[index])
    raise ValueError("too many events")


def _sphere(document: dict[str, Any], table: dict[str, Any]) -> Sphere:
    scene, start, inertia = document["scene"], table["initial"], inertia_of(table)
    radius, plane = exact(table["radius"]), scene.get("plane", {})
    turn = attitude(start)
    position, velocity = exact(start["position"]), exact(start.get("velocity", (0, 0, 0)))
    spin = applied(turn, exact(start.get("angular_velocity", (0, 0, 0))))
    gravity = (ZERO, ZERO, -exact(scene.get("gravity", 0)))
    body = OnPlane(
        table,
        inertia,
        IDENTITY,
        position,
        velocity,
        turn,
        spin,
        gravity,
        exact(plane.get("friction", 0)),
        exact(plane.get("restitution", 0)),
        ZERO,
        [],
        plane,
    )
    ratio = inertia.tensor[0][0] / (inertia.mass * radius * radius)
    borne = bool(plane) and position[2] == radius and not velocity[2]
    return Sphere(body, Laws(body, radius, ratio), bool(plane), position, velocity, spin, turn, borne)


def _state(sphere: Sphere) -> State:
    return sphere.body.in_world(sphere.position, sphere.velocity, sphere.turn, sphere.spin)


def _landed(sphere: Sphere, now: Decimal, motion: Motion) -> Sphere:
    if sphere.borne:
        motion.events.append((_begins(sphere), now))
        return sphere
    velocity, spin = sphere.laws.impact(sphere.velocity, sphere.spin)
    x, y, _ = sphere.position
    landed = replace(sphere, position=(x, y, sphere.laws.radius), velocity=velocity, spin=spin)
    motion.events.append(("impact", now))
    if velocity[2] > LAST_BOUNCE * (-sphere.body.gravity[2] * sphere.laws.radius).sqrt():
        return landed
    level = replace(landed, velocity=(velocity[0], velocity[1], ZERO), borne=True)
    motion.events.append((_begins(level), now))
    return level


def _begins(sphere: Sphere) -> str:
    """Return the kind of the motion on the plane that begins."""
    if not sphere.rolls():
        return "slip"
    return "rest" if size(sphere.velocity) <= NO_SLIP else "roll"


def _meeting(spheres: Sequence[Sphere], phases: Sequence[Phase], until: Decimal, touching: bool) -> Decimal | None:
    """Return the time until the spheres meet, None if they do not in the time `until`; touching: whether they part now."""
    reach = sum((sphere.laws.radius for sphere in spheres), ZERO)

    def gap(time: Decimal) -> Decimal:
        apart = minus(phases[1].after(time)[0], phases[0].after(time)[0])
        return dot(apart, apart) - reach * reach

    def closing(time: Decimal) -> Decimal:
        one, other = phases[0].after(time), phases[1].after(time)
        return dot(minus(other[0], one[0]), minus(other[1], one[1]))

    edges = [until * number / PARTS for number in range(PARTS + 1)]
    edges[0] = until * Decimal("1e-20") if touching else ZERO
    for low, high in itertools.pairwise(edges):
        nearest = high
        if closing(low) < 0 < closing(high):
            nearest = _changed(low, high, lambda time: closing(time) < 0)
        if gap(nearest) < 0 < gap(low) or (gap(nearest) == 0 < gap(low) and closing(nearest) < 0):
            return _changed(low, nearest, lambda time: gap(time) > 0)
    return None


def _changed(low: Decimal, high: Decimal, before: Callable[[Decimal], bool]) -> Decimal:
    """Return the place between two others at which something ceases to hold."""
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if before(middle) else (low, middle)
    return high


def _struck(
    spheres: Sequence[Sphere], friction: Decimal, restitution: Decimal, now: Decimal, motions: Sequence[Motion]
) -> list[Sphere]:
    """Return two spheres after they have hit each other."""
    apart = minus(spheres[1].position, spheres[0].position)
    normal = times(1 / size(apart), apart)
    arms = [times(spheres[0].laws.radius, normal), times(-spheres[1].laws.radius, normal)]
    points = [plus(each.velocity, cross(each.spin, arm)) for each, arm in zip(spheres, arms, strict=True)]
    relative = minus(points[0], points[1])
    along = dot(relative, normal)
    slip = minus(relative, times(along, normal))
    speed = size(slip)
    masses = [sphere.body.inertia.mass for sphere in spheres]
    pressed = (1 + restitution) * along / (1 / masses[0] + 1 / masses[1])
    yielding = sum(((1 + 1 / each.laws.ratio) / mass for each, mass in zip(spheres, masses, strict=True)), ZERO)
    braked = min(speed / yielding, friction * pressed)
    impulse = plus(times(-pressed, normal), times(-braked / speed if speed > NO_SLIP else ZERO, slip))
    after = []
    for index, (sphere, mass, arm) in enumerate(zip(spheres, masses, arms, strict=True)):
        exerted = times(ONE if index == 0 else -ONE, impulse)
        moment = sphere.laws.ratio * mass * sphere.laws.radius * sphere.laws.radius
        velocity = plus(sphere.velocity, times(1 / mass, exerted))
        if sphere.borne:
            velocity = (velocity[0], velocity[1], ZERO)
        one = replace(sphere, velocity=velocity, spin=plus(sphere.spin, times(1 / moment, cross(arm, exerted))))
        motions[index].events.append(("impact", now))
        if one.borne and one.rolls() != sphere.rolls():
            motions[index].events.append((_begins(one), now))
        after.append(one)
    return after
