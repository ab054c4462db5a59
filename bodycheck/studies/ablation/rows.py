"""The rows of the ablation: one case on models of one engine that grow step by step."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Change:
    """How far the motion on a model is from that on the smallest one, at any instant: position (m) or attitude (rad).

    rounding: what the rounding of the steps can add up to. time_step: the time-step errors of both models together.
    """

    size: float
    rounding: float
    time_step: float

    @property
    def is_rounding(self) -> bool:
        """Whether the model changes nothing."""
        return self.size <= self.rounding

    @property
    def agrees(self) -> bool:
        """Whether the two models may tend to the same motion as the step vanishes."""
        return self.size <= self.rounding + self.time_step


@dataclass(frozen=True)
class ModelRow:
    """One model of a scene.

    adds: what it has that the one before it has not. relative_cost: of a step, to that on the smallest model, with the least
    and the most of the repeats; time_per_step in s; None where it was not measured. changes: of position and attitude, empty
    where one of the runs has not completed. errors: of the run, by the columns of results, empty likewise. reason: why not.
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
