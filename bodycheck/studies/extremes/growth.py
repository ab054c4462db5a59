"""By what law a drift grows with the number of steps.

Rounding errors that are independent of one another add up as a random walk does, as the square root of the number of steps.
The errors of steps that are alike add up linearly. Where a step errs in proportion to what there is, they grow exponentially.
"""

from dataclasses import dataclass

import numpy as np

from bodycheck.reference.trajectory import Array

#: Samples from which a law is read off.
FEWEST = 16

#: A law is read off from this part of the run on: before, the motion's own oscillation is all there is.
FROM = 1 / 30

#: Powers of the number of steps, and what a drift is called that is nearest to them.
POWERS = {0.0: "bounded", 0.5: "growing as the square root of the steps", 1.0: "growing linearly", 2.0: "growing quadratically"}

#: Power from which growth may be exponential instead.
STEEP = 1.5

#: Ratio of the growth rates in the second half of a run and in the first, from which it is faster than exponential.
FASTER = 1.5


@dataclass(frozen=True)
class Growth:
    """A relative drift at the end of a run, and the law by which it came to it; empty where none can be seen."""

    drift: float
    law: str

    def __str__(self) -> str:
        return ", ".join(filter(None, (f"{self.drift:.3g}", self.law)))


def growth(drift: Array) -> Growth:
    """The law of a relative drift (n,) >= 0 at evenly spaced instants from the start on, where it is zero.

    What is fitted is the logarithm of the largest drift so far. Over the logarithm of the steps its slope is the power. Where
    that is `STEEP`, it is fitted to the second half of the run again, over the steps themselves too: the better fit tells.
    """
    largest = np.maximum.accumulate(drift)
    n = np.arange(len(drift), dtype=float)
    seen = (n >= FROM * len(drift)) & (largest > 0)
    last = float(drift[-1])
    if not np.isfinite(largest).all() or seen.sum() < FEWEST:
        return Growth(last, "")
    n, size = n[seen], largest[seen]
    power, _ = _line(np.log(n), np.log(size))
    if power > STEEP:
        late, grown = np.array_split(n, 2)[1], np.array_split(np.log(size), 2)[1]
        (power, misfit), (_, other_misfit) = _line(np.log(late), grown), _line(late, grown)
        if other_misfit < misfit:
            first, second = (_line(*part)[0] for part in zip(np.array_split(late, 2), np.array_split(grown, 2), strict=True))
            return Growth(last, "growing faster than exponentially" if second > FASTER * first else "growing exponentially")
    return Growth(last, POWERS[min(POWERS, key=lambda known: abs(known - power))])


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Slope of the straight line through points, and how far it is from them (root mean square)."""
    slope, intercept = np.polyfit(x, y, 1)
    return float(slope), float(np.sqrt(np.mean((y - slope * x - intercept) ** 2)))
