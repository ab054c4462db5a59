"""The slip of a point under a constant drive and dry friction: u' = g - c u / |u|, by elementary functions of tan(phi / 2).

phi is the angle of the slip u from the drive g. With w = tan(phi / 2) and k = c / g, |u| = C w^(k-1) (1 + w^2) / 2; time and
path are integrals of powers of w.
"""

from dataclasses import dataclass
from decimal import Decimal

from tests.judge.numerals import ONE, ZERO

Pair = tuple[Decimal, Decimal]


def length(pair: Pair) -> Decimal:
    """Return the length of a vector along the plane."""
    return (pair[0] * pair[0] + pair[1] * pair[1]).sqrt()


@dataclass(frozen=True)
class Slip:
    """A slip that begins at `start` (m/s) under a drive and with a deceleration by friction (m/s^2)."""

    drive: Pair
    friction: Decimal
    start: Pair

    def _across(self) -> Decimal:
        return self.drive[0] * self.start[1] - self.drive[1] * self.start[0]

    @property
    def straight(self) -> bool:
        """Whether the slip keeps its line."""
        return not self._across()

    def direction(self) -> Pair:
        """Return the direction of a straight slip."""
        along = self.start if self.start != (ZERO, ZERO) else self.drive
        return along[0] / length(along), along[1] / length(along)

    def _straight_rate(self) -> Decimal:
        direction = self.direction()
        return self.drive[0] * direction[0] + self.drive[1] * direction[1] - self.friction

    def end(self) -> Decimal | None:
        """Return when the slip is zero; None if it never is."""
        if not self.friction and (self._across() or self.start == (ZERO, ZERO)):
            return None
        if not self._across():
            rate = self._straight_rate()
            return None if rate >= 0 else length(self.start) / -rate
        curve = _Curve.of(self)
        return curve.time(None) if curve.ratio > 1 else None

    def path_to_end(self) -> Pair:
        """Return the path (m) up to the end."""
        end = self.end()
        assert end is not None
        return self.at(end)[1] if self.straight else self._in_plane(*_Curve.of(self).whole())

    def at(self, time: Decimal) -> tuple[Pair, Pair]:
        """Return the slip (m/s) and its path (m) at a time not after its end."""
        (gx, gy), (x, y) = self.drive, self.start
        if not self.friction:
            return (x + gx * time, y + gy * time), (x * time + gx * time * time / 2, y * time + gy * time * time / 2)
        if not self._across():
            (ex, ey), rate = self.direction(), self._straight_rate()
            way = rate * time * time / 2
            return (x + rate * time * ex, y + rate * time * ey), (x * time + way * ex, y * time + way * ey)
        along, across, moved, sideways = _Curve.of(self).at(time)
        return self._in_plane(along, across), self._in_plane(moved, sideways)

    def _in_plane(self, along: Decimal, across: Decimal) -> Pair:
        """Return the vector with components along the drive and across it, towards the slip."""
        size = length(self.drive)
        x, y = self.drive[0] / size, self.drive[1] / size
        side = across if self._across() > 0 else -across
        return along * x - side * y, along * y + side * x


@dataclass(frozen=True)
class _Curve:
    """A slip that is not along its drive: w at its begin, the ratio c / g, the constant C, and the drive."""

    begin: Decimal
    ratio: Decimal
    factor: Decimal
    drive: Decimal

    @classmethod
    def of(cls, slip: Slip) -> "_Curve":
        drive, speed = length(slip.drive), length(slip.start)
        along = (slip.drive[0] * slip.start[0] + slip.drive[1] * slip.start[1]) / drive
        across = abs(slip.drive[0] * slip.start[1] - slip.drive[1] * slip.start[0]) / drive
        w = across / (speed + along) if along > 0 else (speed - along) / across
        ratio = slip.friction / drive
        return cls(w, ratio, 2 * speed / (_power(w, ratio - 1) * (1 + w * w)), drive)

    def _integral(self, exponent: Decimal, fall: Decimal | None) -> Decimal:
        """Return the integral of w^(exponent - 1) from w = begin exp(-fall), or from 0, to the begin."""
        if fall is None:
            return _power(self.begin, exponent) / exponent
        if not exponent:
            return fall
        return _power(self.begin, exponent) * (1 - (-exponent * fall).exp()) / exponent

    def time(self, fall: Decimal | None) -> Decimal:
        """Return the time at which w is begin exp(-fall), or 0."""
        k = self.ratio
        return self.factor / (2 * self.drive) * (self._integral(k - 1, fall) + self._integral(k + 1, fall))

    def at(self, time: Decimal) -> tuple[Decimal, Decimal, Decimal, Decimal]:
        """Return the slip along the drive and across it, and the path along it and across it."""
        fall, k = self._fall(time), self.ratio
        w = self.begin * (-fall).exp()
        along = self.factor * _power(w, k - 1) * (1 - w * w) / 2
        across = self.factor * _power(w, k)
        return along, across, *self._path(fall)

    def whole(self) -> tuple[Decimal, Decimal]:
        """Return the path along the drive and across it, up to the end."""
        return self._path(None)

    def _path(self, fall: Decimal | None) -> tuple[Decimal, Decimal]:
        k, unit = self.ratio, self.factor * self.factor / (4 * self.drive)
        along = unit * (self._integral(2 * k - 2, fall) - self._integral(2 * k + 2, fall))
        return along, 2 * unit * (self._integral(2 * k - 1, fall) + self._integral(2 * k + 1, fall))

    def _fall(self, time: Decimal) -> Decimal:
        """Return ln(begin / w) at a time, by Newton's method between bounds."""
        if not time:
            return ZERO
        low, high = ZERO, ONE
        while self.time(high) < time:
            low, high = high, 2 * high
            if (self.ratio - 1) * high > 300:  # the slip is zero within the digits
                return high
        point = (low + high) / 2
        for _ in range(300):
            missing = time - self.time(point)
            low, high = (point, high) if missing > 0 else (low, point)
            w = self.begin * (-point).exp()
            after = point + missing * 2 * self.drive / (self.factor * _power(w, self.ratio - 1) * (1 + w * w))
            if not low <= after <= high:
                after = (low + high) / 2
            if abs(after - point) <= Decimal("1e-50") * after:
                return after
            point = after
        return point


def _power(base: Decimal, exponent: Decimal) -> Decimal:
    return (exponent * base.ln()).exp()
