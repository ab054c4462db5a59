"""The rows of the ablation study: one per model of a case, from the smallest to the largest."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Change:
    """The largest difference of a model's motion from that of the smallest model, in position (m) or attitude (rad).

    `rounding` is the largest difference that the rounding of all steps can cause, and `time_step` is the sum of the time-step
    errors of both models.
    """

    size: float
    rounding: float
    time_step: float

    @property
    def is_rounding(self) -> bool:
        """Whether rounding alone explains the difference."""
        return self.size <= self.rounding

    @property
    def agrees(self) -> bool:
        """Whether the two models may converge to the same motion as the time step vanishes."""
        return self.size <= self.rounding + self.time_step


@dataclass(frozen=True)
class ModelRow:
    """One model of a scene.

    Parameters
    ----------
    case, engine, version, integrator, timestep, model
        The run; the time step is in s.
    adds
        A description of what this model contains and the next smaller one does not.
    status, reason
        The status of the run, and why it did not complete or was not timed.
    time_per_step
        The time per step (s); None if it was not measured.
    relative_cost, relative_cost_low, relative_cost_high
        The ratio of the time per step to that of the smallest model, with the minimum and the maximum; None if not measured.
    changes
        The differences from the smallest model in position and attitude; empty if a run has not completed.
    errors
        The errors of the run by the columns of results; empty if the run has not completed.
    """

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    model: str
    adds: str
    status: str
    reason: str
    time_per_step: float | None
    relative_cost: float | None
    relative_cost_low: float | None
    relative_cost_high: float | None
    changes: Mapping[str, Change]
    errors: Mapping[str, float]
