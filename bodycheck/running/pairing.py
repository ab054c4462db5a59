"""Runs and truths while they are made: each run is handed on with its truth, while both are in memory.

They come from different processes in any order. What waits for its counterpart is limited; what is beyond the limit is
forgotten here, and read from its file by whoever needs it.
"""

from collections import Counter
from collections.abc import Callable, Iterable

from bodycheck.reference.trajectory import Trajectory
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run

#: Most memory (bytes) of the states that wait.
MOST_BYTES = 1 << 26

#: A function that is called with a completed run and the truth of its case at the same instants.
Meet = Callable[[Truth, Run], None]

#: The name of a case, and a time step (s).
Key = tuple[str, float]


def unmet(truth: Truth, run: Run) -> None:
    """Leave a run and its truth to whoever reads them from their files."""


class Arrivals:
    """Truths and runs of which the counterpart has not arrived yet.

    Parameters
    ----------
    meet
        Called with each truth and run that meet here.
    runs
        The case and the time step of each run that is going to arrive.
    truths
        The same of each truth.
    """

    def __init__(self, meet: Meet, runs: Iterable[Key], truths: Iterable[Key]) -> None:
        self._meet = meet
        self._awaited, self._coming = Counter(runs), set(truths)
        self._truths: dict[Key, Truth] = {}
        self._runs: dict[Key, list[Run]] = {}
        self._bytes = 0

    def add_run(self, run: Run) -> None:
        """Take a run that has arrived, with any outcome."""
        key = (run.case, run.method.timestep)
        self._awaited[key] -= 1
        if isinstance(run.outcome, Completed):
            if (truth := self._truths.get(key)) is not None:
                self._meet(truth, run)
            elif key in self._coming and self._has_room(run.outcome.trajectory):
                self._runs.setdefault(key, []).append(run)
        if not self._awaited[key] and (truth := self._truths.pop(key, None)) is not None:
            self._bytes -= _size(truth.trajectory)

    def add_truth(self, key: Key, truth: Truth | None) -> None:
        """Take the truth for the runs of a case with a time step, or None where there is none."""
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
    """Return the memory (bytes) of the states of a trajectory. What a truth has besides takes less."""
    return states.position.nbytes + states.quaternion.nbytes + states.velocity.nbytes + states.angular_velocity.nbytes
