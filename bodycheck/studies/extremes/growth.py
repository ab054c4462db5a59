"""Find the law by which a drift grows with the number of steps.

Independent rounding errors add up like a random walk, with the square root of the number of steps. Equal errors of all steps
add up linearly. If the error of a step is proportional to the present error, it grows exponentially.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.trajectory import Array

#: Smallest number of samples from which a law is determined.
MIN_SAMPLES = 16

#: Fraction of the run that is left out of the fit, because the motion's own oscillation dominates in it.
FIT_START_FRACTION = 1 / 30

#: Powers of the number of steps, with the description of a drift whose power is closest.
POWERS = {0.0: "bounded", 0.5: "growing as the square root of the steps", 1.0: "growing linearly", 2.0: "growing quadratically"}

#: Power above which the growth may be exponential.
STEEP_POWER = 1.5

#: Ratio of the growth rates in the second and the first half, above which growth is faster than exponential.
FASTER_RATIO = 1.5


@dataclass(frozen=True)
class Growth:
    """A relative drift at the end of a run, and the law of its growth; the law is empty if none can be determined."""

    drift: float
    law: str

    def __str__(self) -> str:
        return ", ".join(filter(None, (f"{self.drift:.3g}", self.law)))


def growth(drift: Array) -> Growth:
    """Return the law of growth of a relative drift (n,) >= 0, sampled at even intervals from the start, where it is zero.

    A line is fitted to the logarithm of the largest drift so far, over the logarithm of the steps; its slope is the power. If
    the power exceeds `STEEP_POWER`, lines are fitted to the second half of the run over both the logarithm of the steps and the
    steps. If the latter fits better, the growth is exponential.
    """
    largest = np.maximum.accumulate(drift)
    n = np.arange(len(drift), dtype=float)
    seen = (n >= FIT_START_FRACTION * len(drift)) & (largest > 0)
    last = float(drift[-1])
    if not np.isfinite(largest).all() or seen.sum() < MIN_SAMPLES:
        return Growth(last, "")
    n, size = n[seen], largest[seen]
    power, _ = _line(np.log(n), np.log(size))
    if power > STEEP_POWER:
        late, grown = np.array_split(n, 2)[1], np.array_split(np.log(size), 2)[1]
        (power, misfit), (_, other_misfit) = _line(np.log(late), grown), _line(late, grown)
        if other_misfit < misfit:
            first, second = (_line(*part)[0] for part in zip(np.array_split(late, 2), np.array_split(grown, 2), strict=True))
            return Growth(
                last, "growing faster than exponentially" if second > FASTER_RATIO * first else "growing exponentially"
            )
    return Growth(last, POWERS[min(POWERS, key=lambda known: abs(known - power))])


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Return the slope of the line fitted to points x, y (n,), and the root mean square of the deviations."""
    slope, intercept = np.polyfit(x, y, 1)
    return float(slope), float(np.sqrt(np.mean((y - slope * x - intercept) ** 2)))
