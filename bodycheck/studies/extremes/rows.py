"""The rows of the study of extremes, which its tables and its report contain."""

from dataclasses import dataclass

#: The file with the records of the study.
RECORDS = "extremes.jsonl"

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

    Attributes
    ----------
    case, engine, version, integrator, timestep
        The case and the method; the time step is in s.
    axis, value
        What is changed, and its value, in the unit of the axis.
    status
        How the run ended: ok, inaccurate, energy-loss, energy-gain, frozen, diverged, silent-reset, crashed, timeout or
        unsupported.
    engine_said
        The message of the engine: "healthy" if it ended without warnings, and "nothing" if its process gave no answer.
    detail
        A description of the symptoms.
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
    """The largest stable time step of a method at a spin.

    Attributes
    ----------
    case, engine, version, integrator
        The case and the method.
    spin
        The rate at which the body spins (rad/s).
    largest_stable_timestep
        The largest stable time step (s); None if no step was stable.
    spin_times_step
        The rotation of the body in that step (rad); None if no step was stable.
    smallest_unstable_timestep
        The smallest unstable time step (s); None if all steps were stable, up to a full turn per step.
    """

    case: str
    engine: str
    version: str
    integrator: str
    spin: float
    largest_stable_timestep: float | None
    spin_times_step: float | None
    smallest_unstable_timestep: float | None
