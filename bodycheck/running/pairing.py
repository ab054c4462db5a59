"""Bring each new run together with its truth while both are in memory.

Runs and truths come from different processes in any order. The memory for objects that wait for their counterparts is limited;
objects beyond the limit are dropped here, and read from their files when they are needed.
"""

from collections import Counter
from collections.abc import Callable, Iterable

from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run

#: The largest memory (bytes) of waiting states.
MOST_BYTES = 1 << 26

#: A function that is called with a completed run and the truth of its case at the same instants.
Meet = Callable[[Truth, Run], None]

#: The name of a case, and the sampling of runs (`Method.sampling`).
Key = tuple[str, float]


def unmet(truth: Truth, run: Run) -> None:
    """Do nothing with a run and its truth, which can be read from their files."""


class Arrivals:
    """Truths and runs whose counterparts have not arrived yet.

    Parameters
    ----------
    meet
        A function that is called with each pair of a truth and a run.
    runs
        The case and the sampling of each expected run.
    truths
        The case and the sampling of each expected truth.
    """

    def __init__(self, meet: Meet, runs: Iterable[Key], truths: Iterable[Key]) -> None:
        self._meet = meet
        self._awaited, self._coming = Counter(runs), set(truths)
        self._truths: dict[Key, Truth] = {}
        self._runs: dict[Key, list[Run]] = {}
        self._bytes = 0

    def add_run(self, run: Run) -> None:
        """Add a run that has arrived, with any outcome."""
        key = (run.case, run.method.sampling)
        self._awaited[key] -= 1
        if isinstance(run.outcome, Completed):
            if (truth := self._truths.get(key)) is not None:
                self._meet(truth, run)
            elif key in self._coming and self._has_room(run.outcome.trajectory):
                self._runs.setdefault(key, []).append(run)
        if not self._awaited[key] and (truth := self._truths.pop(key, None)) is not None:
            self._bytes -= _size(truth.trajectory)

    def add_truth(self, key: Key, truth: Truth | None) -> None:
        """Add the truth for the runs of a case with a sampling, or None if there is no truth."""
        self._coming.discard(key)
        for run in self._runs.pop(key, ()):
            self._bytes -= _size(run.outcome.trajectory) if isinstance(run.outcome, Completed) else 0
            if truth is not None:
                self._meet(truth, run)
        if truth is not None and self._awaited[key] and self._has_room(truth.trajectory):
            self._truths[key] = truth

    def _has_room(self, states: Trajectory) -> bool:
        """Count states as waiting if there is room for them; return whether there is."""
        if self._bytes + _size(states) > MOST_BYTES:
            return False
        self._bytes += _size(states)
        return True


def _size(states: Trajectory) -> int:
    """Return the memory (bytes) of the states of a trajectory. The other data of a truth take less."""
    return states.position.nbytes + states.quaternion.nbytes + states.velocity.nbytes + states.angular_velocity.nbytes
