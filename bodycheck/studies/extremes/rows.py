"""The rows of the study of extremes, which its tables and its report contain."""

from dataclasses import dataclass

#: Values of `engine_said`: the run finished without warnings; the process gave no answer.
HEALTHY, NOTHING = "healthy", "nothing"

#: The statuses, from the best to the worst. The last one is no judgement of a method.
STATUSES = (
    *("ok", "inaccurate", "energy-loss", "energy-gain", "frozen", "diverged"),
    *("silent-reset", "crashed", "timeout", "unsupported"),
)


@dataclass(frozen=True)
class Row:
    """One run of a method, with a case changed along an axis to a value.

    `status` is one of `STATUSES`, `engine_said` is the message of the engine, and `detail` describes the symptoms.
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
        """Whether the engine reported no problem although the run is wrong."""
        return self.engine_said == HEALTHY and self.status != "ok"


@dataclass(frozen=True)
class Limit:
    """The largest stable time step (s) of a method at a spin (rad/s), and the rotation of the body (rad) in that step.

    Both are None if no step was stable; `smallest_unstable_timestep` is None if all were, up to a full turn per step.
    """

    case: str
    engine: str
    version: str
    integrator: str
    spin: float
    largest_stable_timestep: float | None
    spin_times_step: float | None
    smallest_unstable_timestep: float | None
