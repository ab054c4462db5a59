"""Truths at the instants of runs, as judging needs them."""

from bodycheck import Case, Truth, truth
from bodycheck.running.instants import sampling_steps


def truth_for_runs(case: Case, timestep: float) -> Truth:
    """Return the truth of a case at the instants of its runs with a time step (s)."""
    return truth(case, sampling_steps(case.instants, timestep) * timestep)
