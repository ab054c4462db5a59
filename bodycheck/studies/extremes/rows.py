"""The rows of the study of extremes, as its tables and its report have them."""

from dataclasses import dataclass

#: What an engine says that steps to the end, and one that is not heard of.
HEALTHY, NOTHING = "healthy", "nothing"

#: From right to gone. The last says nothing of a method.
STATUSES = (
    *("ok", "inaccurate", "energy-loss", "energy-gain", "frozen", "diverged"),
    *("silent-reset", "crashed", "timeout", "unsupported"),
)


@dataclass(frozen=True)
class Row:
    """One run: a case pushed along an axis to a value, by one method.

    status: one of `STATUSES`. engine_said: its own words. detail: what was seen in the states.
    """

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    axis: str
    value: float
    status: str
    engine_said: str
    detail: str

    @property
    def believed(self) -> bool:
        """Whether the engine reports as healthy what is not."""
        return self.engine_said == HEALTHY and self.status != "ok"


@dataclass(frozen=True)
class Limit:
    """The largest stable step (s) of a method at a spin (rad/s), and the angle that the body turns in it (rad).

    None where no step was stable; smallest_unstable_timestep is None where all were, up to a turn in a step.
    """

    case: str
    engine: str
    version: str
    integrator: str
    spin: float
    largest_stable_timestep: float | None
    spin_times_step: float | None
    smallest_unstable_timestep: float | None
