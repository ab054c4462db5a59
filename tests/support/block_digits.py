"""The motion of a block on an inclined plane with fifty digits, by quadrature over the direction of its velocity.

With phi the angle between the velocity and the force D along the plane, u = ln tan(phi / 2), and kappa the ratio of friction to
D, the speed is v = v0 cosh(u) / cosh(u0) exp(kappa (u - u0)), and time and path are integrals of v / D and of v^2 / D over u.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import mpmath

#: Arithmetic of fifty digits.
MP = mpmath.MPContext()
MP.dps = 50

#: A number with fifty digits, and a vector of two along the plane: downhill and across.
Number = Any
Vector2 = tuple[Number, Number]

#: Newton's steps for a time, and bisections that come before.
STEPS = 80


class Block:
    """A block that moves along a plane under forces that change at given instants.

    Attributes
    ----------
    place, velocity
        Displacement (m) and velocity (m/s).
    events
        The kinds and the instants (s) of the events so far.
    """

    def __init__(self, velocity: Vector2) -> None:
        self.place: Vector2 = (MP.mpf(0), MP.mpf(0))
        self.velocity = velocity
        self.events: list[tuple[str, Number]] = []

    def follow(
        self, drives: Sequence[tuple[Number, Vector2, Number]], instants: Sequence[Number]
    ) -> list[tuple[Vector2, Vector2]]:
        """The displacements (m) and velocities (m/s) at ascending instants (s).

        drives: from which instant (s) on, the force along the plane and the largest friction, both per mass (m/s^2).
        """
        marks = sorted({*(start for start, _, _ in drives), *instants})
        rows = {}
        for begin, end in pairwise(marks):
            rows[begin] = self.place, self.velocity
            _, drive, brake = next(each for each in reversed(drives) if each[0] <= begin)
            self._advance(begin, end, drive, brake)
        rows[marks[-1]] = self.place, self.velocity
        return [rows[instant] for instant in instants]

    def _advance(self, begin: Number, end: Number, drive: Vector2, brake: Number) -> None:
        now = begin
        while now < end:
            force, speed = MP.hypot(*drive), MP.hypot(*self.velocity)
            if not speed and force <= brake:
                return
            if not speed:
                if now > begin or begin == 0 or self.events[-1:] != [("slip", now)]:
                    self._note("slip", now)
                self._straight(drive, (force - brake) / force, end - now)
                return
            across = drive[0] * self.velocity[1] - drive[1] * self.velocity[0]
            if abs(across) <= MP.mpf(10) ** -45 * force * speed:
                ahead = self.velocity[0] / speed, self.velocity[1] / speed
                gained = drive[0] * ahead[0] + drive[1] * ahead[1] - brake
                left = end - now if gained >= 0 else min(end - now, -speed / gained)
                self._straight(ahead, gained, left)
                stops = left < end - now or (gained < 0 and left == -speed / gained)
            else:
                left, stops = self._turning(drive, brake, end - now)
            now += left
            if stops:
                self.velocity = MP.mpf(0), MP.mpf(0)
                if force <= brake:
                    self._note("rest", now)

    def _note(self, kind: str, time: Number) -> None:
        self.events.append((kind, time))

    def _straight(self, direction: Vector2, rate: Number, passed: Number) -> None:
        a, b = direction[0] * rate, direction[1] * rate
        (x, y), (u, v) = self.place, self.velocity
        self.place = x + passed * (u + a * passed / 2), y + passed * (v + b * passed / 2)
        self.velocity = u + a * passed, v + b * passed

    def _turning(self, drive: Vector2, brake: Number, passed: Number) -> tuple[Number, bool]:
        """Advance an oblique slide by a time, or to its stop. Returns the time (s), and whether the block stops."""
        force, speed = MP.hypot(*drive), MP.hypot(*self.velocity)
        along = drive[0] / force, drive[1] / force
        side = 1 if along[0] * self.velocity[1] > along[1] * self.velocity[0] else -1
        sideways = -side * along[1], side * along[0]
        parts = [sum(a * b for a, b in zip(self.velocity, axis, strict=True)) for axis in (along, sideways)]
        first = MP.log(parts[1] / (speed + parts[0])) if parts[0] > 0 else MP.log((speed - parts[0]) / parts[1])
        kappa = brake / force

        def size(turned: Number) -> Number:
            return speed * MP.cosh(first - turned) / MP.cosh(first) * MP.exp(-kappa * turned)

        def total(function: Any, until: Number) -> Number:
            places = [MP.mpf(0), *(MP.mpf(2) ** power / 2 for power in range(200)), MP.inf]
            return MP.quad(function, [*(place for place in places if place < until), until], method="gauss-legendre")

        def time(turned: Number) -> Number:
            """The sum of kappa v and of the velocity along the force changes at the rate (1 - kappa^2) D."""
            if kappa == 1:
                return total(lambda each: size(each) / force, turned)
            change = size(turned) * (kappa - MP.tanh(first - turned)) - speed * (kappa - MP.tanh(first))
            return change / (force * (1 - kappa**2))

        far = 60 / (kappa - 1) if kappa > 1 else MP.inf
        if kappa > 1 and speed * (kappa - MP.tanh(first)) <= passed * force * (kappa**2 - 1):
            turned, lasting = far, speed * (kappa - MP.tanh(first)) / (force * (kappa**2 - 1))
        else:
            low, high = MP.mpf(0), MP.mpf(1)
            while high < far and time(high) < passed:
                low, high = high, 2 * high
            turned, lasting = (low + high) / 2, passed
            for _ in range(STEPS):
                late = passed - time(turned)
                low, high = (turned, high) if late > 0 else (low, turned)
                moved = turned + late * force / size(turned)
                step = (moved if low <= moved <= high else (low + high) / 2) - turned
                turned += step
                if abs(step) < MP.mpf(10) ** -30:
                    break
        way = (
            total(lambda each: -(size(each) ** 2) * MP.tanh(first - each) / force, turned),
            total(lambda each: size(each) ** 2 / MP.cosh(first - each) / force, turned),
        )
        end = size(turned)
        speeds = -end * MP.tanh(first - turned), end / MP.cosh(first - turned)
        (x, y) = self.place
        self.place = x + along[0] * way[0] + sideways[0] * way[1], y + along[1] * way[0] + sideways[1] * way[1]
        self.velocity = along[0] * speeds[0] + sideways[0] * speeds[1], along[1] * speeds[0] + sideways[1] * speeds[1]
        return lasting, turned == far
