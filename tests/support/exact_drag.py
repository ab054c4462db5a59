"""Translation with quadratic drag in fifty digits, by code that shares nothing with the reference: closed forms for straight
paths, and quadratures over the slope of the path for all others, in SI units."""

import functools
from collections.abc import Callable, Sequence

import numpy as np
from mpmath import mp, mpf

from bodycheck.reference.scene import Scene

#: Digits of the arithmetic, and nodes of a panel: a singularity twice as far as a panel's middle is from its ends leaves 1e-36.
DIGITS, NODES = 50, 32

#: Size of what the terminal velocity is not yet reached by.
RELAXED = mpf(10) ** -38

Vector = tuple[mpf, mpf, mpf]


def exact(scene: Scene, times: Sequence[float]) -> list[tuple[Vector, Vector]]:
    """Positions (m) and velocities (m/s) of a scene at ascending times >= 0, s."""
    with mp.workdps(DIGITS + _cancelled(scene, min([t for t in times if t], default=1.0))):
        resistance, gravity = mpf(scene.drag) / mpf(scene.body.mass), mpf(scene.gravity)
        x, y, z = (mpf(value) for value in scene.initial.position)
        vx, vy, vz = (mpf(value) for value in scene.initial.velocity)
        along = mp.sqrt(vx * vx + vy * vy)
        cx, cy = (vx / along, vy / along) if along else (mpf(0), mpf(0))
        way = _coasting if gravity == 0 else _curved if along else _vertical
        states = way(resistance, gravity, along, vz, [mpf(t) for t in times])
        return [((x + cx * d, y + cy * d, z + h), (cx * u, cy * u, w)) for d, h, u, w in states]


def _cancelled(scene: Scene, time: float) -> int:
    """Digits lost where the initial speed is far above the terminal speed, the path nearly vertical, or a time (s) short."""
    along, climb = mp.hypot(*scene.initial.velocity[:2]), mpf(scene.initial.velocity[2])
    resistance, gravity, speed = mpf(scene.drag) / scene.body.mass, mpf(scene.gravity), mp.hypot(along, climb)
    if not gravity:
        return 0
    short = min(mp.sqrt(gravity * resistance) * time, gravity * time / speed if speed else mpf(1))
    large = [1 + speed**2 * resistance / gravity, 1 + abs(climb) / (along or 1), 1 / min(short, mpf(1))]
    return 2 * int(sum(mp.log10(factor) for factor in large))


States = list[tuple[mpf, mpf, mpf, mpf]]


def _coasting(resistance: mpf, _gravity: mpf, along: mpf, climb: mpf, times: list[mpf]) -> States:
    """Distance, height, horizontal speed and upward velocity without gravity."""
    speed = mp.sqrt(along**2 + climb**2)
    if speed == 0:
        return [(mpf(0),) * 4 for _ in times]
    found = []
    for t in times:
        reach = mp.log1p(resistance * speed * t) / resistance / speed
        left = 1 / (1 + resistance * speed * t)
        found.append((along * reach, climb * reach, along * left, climb * left))
    return found


def _vertical(resistance: mpf, gravity: mpf, _along: mpf, climb: mpf, times: list[mpf]) -> States:
    """The same along the vertical: a tangent on the way up, a hyperbolic tangent on the way down."""
    terminal, rate = mp.sqrt(gravity / resistance), mp.sqrt(gravity * resistance)
    angle = mp.atan(climb / terminal) if climb > 0 else mpf(0)
    top = -mp.log(mp.cos(angle)) / resistance
    found = []
    for t in times:
        if rate * t <= angle and climb > 0:
            rest = angle - rate * t
            found.append((mpf(0), top + mp.log(mp.cos(rest)) / resistance, mpf(0), terminal * mp.tan(rest)))
            continue
        sink, fallen = max(-climb, mpf(0)) / terminal, rate * t - angle
        grown = mp.cosh(fallen) + sink * mp.sinh(fallen)
        speed = (mp.sinh(fallen) + sink * mp.cosh(fallen)) / grown
        found.append((mpf(0), top - mp.log(grown) / resistance, mpf(0), -terminal * speed))
    return found


@functools.cache
def _rule() -> list[tuple[mpf, mpf]]:
    """Places in [0, 1] and weights of the Gauss-Legendre rule."""
    found = []
    with mp.workdps(DIGITS + 10):
        for x in map(mpf, np.polynomial.legendre.leggauss(NODES)[0].tolist()):
            for _ in range(4):  # from 16 digits to all
                value = mp.legendre(NODES, x)
                slope = NODES * (mp.legendre(NODES - 1, x) - x * value) / (1 - x * x)
                x -= value / slope
            found.append(((1 + x) / 2, 1 / ((1 - x * x) * slope**2)))
    return found


def _curved(resistance: mpf, gravity: mpf, along: mpf, climb: mpf, times: list[mpf]) -> States:
    """The same along a curved path: time, distance and height as integrals over the asinh of the slope."""
    first, ratio = mp.asinh(climb / along), resistance / gravity
    constant = 1 / along**2 + ratio * (mp.sinh(2 * first) / 2 + first)

    def state(turned: mpf) -> tuple[mpf, mpf]:
        """Horizontal speed and upward velocity where the path has turned by this much."""
        grown = mp.exp(first - turned)
        sinh, cosh = (grown - 1 / grown) / 2, (grown + 1 / grown) / 2
        u = 1 / mp.sqrt(constant - ratio * (sinh * cosh + first - turned))
        return u, u * sinh

    def added(start: mpf, end: mpf) -> list[mpf]:
        """Time, distance and height between two turns."""
        sums = [mpf(0)] * 3
        for place, weight in _rule():
            u, w = state(start + (end - start) * place)
            factor = weight * (end - start) * mp.sqrt(u * u + w * w) / gravity
            sums = [sums[0] + factor, sums[1] + factor * u, sums[2] + factor * w]
        return sums

    # The integrand varies over this turn at the start, and over about one later.
    start, width = mpf(0), min(1 / (2 * ratio * (along**2 + climb**2)), mpf("0.5"))
    found: States = []
    total, waiting = [mpf(0)] * 3, list(times)
    while waiting:
        slope = first - start
        if slope < 0 and (1 + abs(constant) / ratio - slope) * mp.exp(2 * slope) < RELAXED:
            return found + [_relaxed(resistance, gravity, total, state(start)[0], t) for t in waiting]
        step = added(start, start + width)
        while waiting and waiting[0] <= total[0] + step[0]:
            found.append(_inside(state, added, start, width, step, total, waiting.pop(0), gravity))
        total = [a + b for a, b in zip(total, step, strict=True)]
        start, width = start + width, min(2 * width, mpf("0.5"))
    return found


def _inside(
    state: Callable[[mpf], tuple[mpf, mpf]],
    added: Callable[[mpf, mpf], list[mpf]],
    start: mpf,
    width: mpf,
    step: list[mpf],
    total: list[mpf],
    time: mpf,
    gravity: mpf,
) -> tuple[mpf, mpf, mpf, mpf]:
    """The state at a time within a panel, by Newton's method."""
    wanted = time - total[0]
    place, reached = width * wanted / step[0], [mpf(0)] * 3
    for _ in range(12):
        reached = added(start, start + place)
        u, w = state(start + place)
        correction = (wanted - reached[0]) * gravity / mp.sqrt(u * u + w * w)
        if abs(correction) <= RELAXED * abs(place):
            return total[1] + reached[1], total[2] + reached[2], u, w
        place = min(max(place + correction, mpf(0)), width)
    raise ArithmeticError("Newton's method does not converge")


def _relaxed(resistance: mpf, gravity: mpf, total: list[mpf], along: mpf, time: mpf) -> tuple[mpf, mpf, mpf, mpf]:
    """The state at a time after the terminal velocity is reached."""
    terminal, rate, later = mp.sqrt(gravity / resistance), mp.sqrt(gravity * resistance), time - total[0]
    left = mp.exp(-rate * later)
    return total[1] + along * (1 - left) / rate, total[2] - terminal * later, along * left, -terminal
