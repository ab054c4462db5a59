"""Errors of engines on mechanisms with bodies without mass and with joints that follow others."""

from collections.abc import Sequence

import numpy as np

from bodycheck.adapters.contract import Adapter, Method
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.mechanisms.truth import mechanism_truth
from bodycheck.reference.trajectory import Array

#: The duration of the runs (s), and time steps of which each is half of the one before.
DURATION, STEPS = 0.2, (0.004, 0.002, 0.001)


def errors(adapter: Adapter, mechanism: Mechanism, spelling: str, steps: Sequence[float] = STEPS) -> Array:
    """The largest errors (n,) of the positions of the bodies (m) at the end of runs with n time steps (s)."""
    exact = mechanism_truth(mechanism, np.array([0.0, DURATION]), vouched=False).trajectory.position[:, 1]
    runs = (adapter.prepare([mechanism], Method.parse(spelling, step)) for step in steps)
    ends = [run.advance(np.array([round(DURATION / step)]))[0, 0, :, :3] for run, step in zip(runs, steps, strict=True)]
    return np.array([np.abs(end - exact).max() for end in ends])


def orders(sizes: Array) -> Array:
    """The orders (n - 1,) by which errors fall from step to step."""
    return np.asarray(np.log2(sizes[:-1] / sizes[1:]))
