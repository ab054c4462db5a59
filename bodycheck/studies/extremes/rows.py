"""The rows of the study of extreme values, of which its tables and its report consist."""

from dataclasses import dataclass
from typing import Annotated

from bodycheck.results.tables import Meaning, table_of

#: The file with the records of the study.
RECORDS = "extremes.jsonl"

#: Values of `engine_said` for a run that finished without warnings, and for a run whose process gave no answer.
HEALTHY, NOTHING = "healthy", "nothing"

#: The statuses, from the best to the worst. The last status is not a judgement of the method.
STATUSES = (
    *("ok", "inaccurate", "energy-loss", "energy-gain", "frozen", "diverged"),
    *("reset", "crashed", "timeout", "unsupported"),
)


#: The statuses that say what a method does: all but those of runs without states.
MEASURED = STATUSES[:-3]


@dataclass(frozen=True)
class Row:
    """A run of a method on a case that is changed along an axis to a value."""

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    axis: Annotated[str, Meaning("Axis", "axis of the case along which it is changed")]
    value: Annotated[float, Meaning("Value", "value on the axis, in the unit of the axis", signed=True)]
    status: Annotated[str, Meaning("Status", f"how the run ended: {', '.join(STATUSES[:-1])} or {STATUSES[-1]}")]
    engine_said: Annotated[
        str,
        Meaning(
            "Engine said",
            f'message of the engine: "{HEALTHY}" if it ended without warnings, "{NOTHING}" if its process gave no answer',
        ),
    ]
    detail: Annotated[str, Meaning("Detail", "description of the symptoms")]

    @property
    def believed(self) -> bool:
        """True if the engine reported no problem although the run is wrong."""
        return self.engine_said == HEALTHY and self.status != "ok"


@dataclass(frozen=True)
class Limit:
    """The largest stable time step of a method at a spin."""

    case: str
    engine: str
    version: str
    integrator: str
    spin: Annotated[float, Meaning("Spin", "rate at which the body spins", "rad/s")]
    largest_stable_timestep: Annotated[
        float | None, Meaning("Largest stable step", "largest stable time step; empty if no step was stable", "s")
    ]
    spin_times_step: Annotated[
        float | None, Meaning("Turn per step", "rotation of the body in that step; empty if no step was stable", "rad")
    ]
    smallest_unstable_timestep: Annotated[
        float | None,
        Meaning(
            "Smallest unstable step",
            "smallest unstable time step; empty if all steps were stable, up to a full turn per step",
            "s",
        ),
    ]


RUNS = table_of(
    Row,
    "extremes",
    "runs at extreme values",
    key=("case", "engine", "integrator", "axis", "value"),
    shown=("case", "engine", "integrator", "timestep", "axis", "value", "status", "engine_said"),
)
LIMITS = table_of(
    Limit,
    "limits",
    "largest stable time steps",
    key=("case", "engine", "integrator", "spin"),
    shown=(
        *("case", "engine", "integrator", "spin"),
        *("largest_stable_timestep", "spin_times_step", "smallest_unstable_timestep"),
    ),
)

#: The tables of the study, the main one first.
TABLES = (RUNS, LIMITS)
