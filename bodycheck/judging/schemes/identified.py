"""The textbook scheme that a run agrees with, and the features that distinguish schemes."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.trajectory import Array

#: Time from the start in which rounding errors have hardly grown, so that schemes are distinguished best.
EARLY_S = 2.0

#: Attitude difference, in units of roundoff, up to which two trajectories count as equal in that time.
#: In double precision it is 1e-11 rad.
SAME_ROUNDINGS = 1e-11 * 2.0**53

#: Difference of two programs at the start, in units of roundoff. A turn by an angle that is computed from its cosine has an
#: error of one unit divided by the angle, and the first turns of an attitude that is stored as a rotation vector are some
#: milliradians.
START_ROUNDINGS = 1000

#: A scheme can be named if the ratio of its difference to the difference of every other scheme is at most this, and counts as
#: near if the ratio to the error of the run is at most this.
MAX_UNEXPLAINED_FRACTION = 0.01


@dataclass(frozen=True)
class Candidate:
    """A scheme that was compared with a run.

    Parameters
    ----------
    scheme
        The name of the scheme.
    early, residual
        The largest attitude difference (rad) in the first 2 s and in the whole run; infinite if the scheme fails. For a
        mechanism, they are the largest over all bodies, attitudes (rad) and positions (m), and over the compared instants.
    fits
        Whether rounding can explain the difference at every instant.
    """

    scheme: str
    early: float
    residual: float
    fits: bool


@dataclass(frozen=True)
class Identification:
    """The scheme that a run agrees with, and the differences from the closest scheme.

    Parameters
    ----------
    scheme
        The name of the scheme; empty if none is named. The name is followed by "on the body twist" if only that formulation has
        the position of the run, and by "in rotation" if no formulation has it.
    nearest
        The name, or else the closest scheme if its difference is at most a hundredth of the run's error, and also of the
        differences of all other schemes if rounding can explain any; empty if none is that close.
    early, residual
        The largest attitude difference (rad) from the closest scheme in the first 2 s and in the whole run.
    allowed
        The largest attitude difference (rad) that rounding can cause by the end of the run.
    position_residual
        The largest distance (m) from the closest scheme, in the closer formulation.
    candidates
        All schemes, the closest first. If several fit, and none is closer than all others by a factor of a hundred, it is the
        one with the smallest position_residual. For schemes that were far off from the beginning, the differences cover only
        the compared instants.
    """

    scheme: str
    nearest: str
    early: float
    residual: float
    allowed: float
    position_residual: float
    candidates: tuple[Candidate, ...]

    @property
    def cannot_tell(self) -> bool:
        """True if the scene cannot distinguish schemes: some schemes fit, but none is named."""
        return not self.scheme and any(candidate.fits for candidate in self.candidates)


def is_fraction(sizes: tuple[float, float], other: tuple[float, float]) -> bool:
    """Return whether the first or the second of two sizes is at most a hundredth of the other.

    The sizes are the largest differences in the first 2 s and over all instants.
    """
    return any(part < MAX_UNEXPLAINED_FRACTION * whole for part, whole in zip(sizes, other, strict=True))


def tells(differences: Array, others: Iterable[Array], limit: Array, early: NDArray[np.bool_]) -> bool:
    """Return whether a scheme's difference from a run distinguishes it from other candidates.

    It does if every other candidate exceeds the limit of rounding at some instant, and its difference is a hundred times as
    large in the first 2 s or in the whole run.

    Parameters
    ----------
    differences
        The differences (n,) of the scheme.
    others
        The differences of the other candidates, each at the first few or at all of the n instants.
    limit
        The largest differences (n,) that rounding can cause.
    early
        Marks (n,) the instants in the first 2 s.
    """
    return all(
        (other > limit[: len(other)]).any()
        and (
            differences[early].max() < MAX_UNEXPLAINED_FRACTION * other[early[: len(other)]].max()
            or differences.max() < MAX_UNEXPLAINED_FRACTION * other.max()
        )
        for other in others
    )
