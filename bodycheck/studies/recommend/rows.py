"""What the study finds: a probe for each measured time step, an answer for each method, and both together."""

from dataclasses import dataclass

from bodycheck.figures.columns import FIGURES
from bodycheck.results.key import RunKey

#: The file with the records of the study.
RECORDS = "recommend.jsonl"


@dataclass(frozen=True)
class Probe:
    """A measured time step of a method.

    Parameters
    ----------
    engine, version, integrator, timestep
        The method; the time step is in s.
    status, reason
        The status of the run, and why it is not ok.
    error, truth_error
        The figure that is limited, and the bound of the truth's own error in it; None where they are not known.
    """

    engine: str
    version: str
    integrator: str
    timestep: float
    status: str
    error: float | None
    truth_error: float | None
    reason: str

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases and time steps."""
        return RunKey.of_method(self.engine, self.integrator)


@dataclass(frozen=True)
class Answer:
    """The largest measured time step of a method such that it and every smaller measured one keep the limit.

    Where there is none, it is the step with the smallest error.

    Parameters
    ----------
    engine, version, integrator, timestep
        The method; the time step is in s, and None if no run completed.
    error
        The error at this step; None if no run completed.
    cost
        Computing time (s) per simulated second, the median of repeated timings; None if it could not be measured.
    margin
        The limit divided by the error; None if there is no error, or if it is 0.
    reached
        Whether the limit is kept.
    cost_low, cost_high
        The minimum and the maximum of the repeated timings, as `cost`.
    steps
        The number of measured time steps.
    smallest, broken
        The smallest measured time step (s), and the smallest one that breaks the limit; None if there is none.
    reason
        Why no run completed, or why the cost could not be measured; empty otherwise.
    """

    engine: str
    version: str
    integrator: str
    timestep: float | None
    error: float | None
    cost: float | None
    margin: float | None
    reached: bool
    cost_low: float | None
    cost_high: float | None
    steps: int
    smallest: float | None
    broken: float | None
    reason: str

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases and time steps."""
        return RunKey.of_method(self.engine, self.integrator)


@dataclass(frozen=True)
class Asked:
    """What is asked for.

    Parameters
    ----------
    case, duration
        The name of the case, and its duration (s).
    figure
        The name of the figure that is limited.
    error
        The limit, in the unit of the figure.
    """

    case: str
    duration: float
    figure: str
    error: float

    @property
    def unit(self) -> str:
        """The unit of the error; empty if it is relative."""
        return FIGURES[self.figure].unit


@dataclass(frozen=True)
class Recommendation:
    """What the study finds.

    Parameters
    ----------
    asked
        What was asked for.
    answers
        One for each method: first those that keep the limit, the cheapest first, then the others, the smallest error first.
    probes
        All measured time steps, method by method, the largest first.
    """

    asked: Asked
    answers: tuple[Answer, ...]
    probes: tuple[Probe, ...]

    @property
    def best(self) -> Answer | None:
        """The cheapest method that keeps the limit; None if none does."""
        return next(iter(self.reached), None)

    @property
    def reached(self) -> tuple[Answer, ...]:
        """The methods that keep the limit, the cheapest first."""
        return tuple(answer for answer in self.answers if answer.reached)

    @property
    def unreached(self) -> tuple[Answer, ...]:
        """The methods that do not keep the limit with any measured time step, the smallest error first."""
        return tuple(answer for answer in self.answers if not answer.reached)
