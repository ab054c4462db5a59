"""The steps and instants at which an engine is sampled."""

import numpy as np

from bodycheck.adapters.contract import Engine, Method, Strides
from bodycheck.adapters.method import DEFAULT_TIMESTEP
from bodycheck.casefile.content import MAX_STEPS, Case
from bodycheck.errors import BadInput
from bodycheck.reference.trajectory import Array


def sampling_steps(instants: Array, timestep: float) -> Strides:
    """Return the numbers of steps (m,), without duplicates, whose ends are closest to instants (n,), in s."""
    return np.unique(np.rint(instants / timestep).astype(np.int64))


def sampling_times(instants: Array, sampling: float) -> Array:
    """Return the times (m,), in s, at which a run is sampled for instants (n,), in s; sampling: `Method.sampling`."""
    return sampling_steps(instants, sampling).astype(np.float64) * sampling if sampling else instants


def check_timestep(case: Case, timestep: float) -> None:
    """Raise `BadInput` for a time step (s) that is not possible in a case."""
    if not 0 < timestep <= case.duration <= timestep * MAX_STEPS:
        least = case.duration / MAX_STEPS
        raise BadInput(
            f"{case.name}: time step {timestep:g} s: must be positive, at most its duration, {case.duration:g} s, and at "
            f"least {least:g} s, which results in {MAX_STEPS:.0e} steps"
        )


def default_timestep(engine: Engine, case: Case, method: Method) -> float:
    """Return the time step (s) of a method of an engine in a case if none is named.

    The time step is 2 ms. For a method with error control, it is the largest step: the engine's own limit, or the sampling
    interval if the engine has none, and at most the duration of the case.
    """
    if method.accuracy is None:
        return DEFAULT_TIMESTEP
    largest = engine.largest_step or case.duration / (case.samples - 1)
    return min(largest, case.duration)
