"""The results of the study: a probe for each measured time step, an answer for each method, and both together."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated

from bodycheck.adapters.contract import Efforts
from bodycheck.adapters.method import Method
from bodycheck.figures.columns import FIGURES
from bodycheck.processes.failures import TimedOut
from bodycheck.results.key import RunKey
from bodycheck.results.tables import Meaning, table_of
from bodycheck.studies.timesteps import FINE_ACCURACIES

#: The file with the records of the study.
RECORDS = "recommend.jsonl"


@dataclass(frozen=True)
class Probe:
    """A measured time step of a method, or a measured accuracy of a method with error control."""

    engine: str
    version: str
    integrator: str
    timestep: float
    status: str
    error: Annotated[float | None, Meaning("Error", "value of the limited figure, in its unit; empty if it is not known")]
    truth_error: Annotated[
        float | None, Meaning("Bound", "bound of the truth's own error in the figure; empty if it is not known")
    ]
    reason: str

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases, time steps and accuracies."""
        return key_of(self.engine, Method.parse(self.integrator, 0.0))

    @property
    def engine_method(self) -> Method:
        """The method of the run."""
        return Method.parse(self.integrator, self.timestep)


def key_of(engine: str, method: Method) -> RunKey:
    """Return the key of an engine and a method, over all cases, time steps and accuracies."""
    return RunKey("", engine, method.at(0.0).over_accuracies)


@dataclass(frozen=True)
class Answer:
    """The answer for a method: the largest step such that it, its neighbours and all smaller measured steps keep the limit.

    With error control, accuracies take the place of time steps: the accuracy is in the spelling of the integrator, the time
    step is the largest step, and the columns `smallest` and `broken` are empty.

    Neighbours are the time steps that differ by at most 3 %, and at least the next ones on both sides. If there is no such time
    step, the answer has the measured time step with the smallest error.
    """

    engine: str
    version: str
    integrator: str
    timestep: Annotated[float | None, Meaning("Time step", "time step; empty if no run completed", "s")]
    error: Annotated[float | None, Meaning("Error", "error at this step, in the unit of the figure; empty if no run completed")]
    cost: Annotated[
        float | None,
        Meaning(
            "Cost",
            "computing time per simulated second, the median of repeated timings; empty if it could not be measured",
            "s/s",
        ),
    ]
    margin: Annotated[
        float | None,
        Meaning(
            "Margin",
            "limit divided by the largest error of the neighbours or, if the limit is not kept, by the error; empty if there "
            "is no error, or if it is 0",
            counts="times",
        ),
    ]
    reached: Annotated[bool, Meaning("Reached", "whether the limit is kept")]
    cost_low: Annotated[float | None, Meaning("Cost, low", "smallest of the repeated timings, as the cost", "s/s")]
    cost_high: Annotated[float | None, Meaning("Cost, high", "largest of the repeated timings, as the cost", "s/s")]
    steps: Annotated[int, Meaning("Runs", "number of the measured time steps", counts="time steps")]
    smallest: Annotated[float | None, Meaning("Smallest step", "smallest measured time step; empty if there is none", "s")]
    broken: Annotated[
        float | None,
        Meaning("Breaks at", "smallest measured time step that breaks the limit; empty if there is none", "s"),
    ]
    reason: Annotated[str, Meaning("Reason", "why no run completed, or why the cost could not be measured; empty otherwise")]
    worst: Annotated[
        float | None,
        Meaning(
            "Worst neighbour",
            "largest error of the time steps that differ by at most 3 %, at least of the next ones on both sides, in the unit "
            "of the figure; empty if the limit is not kept",
        ),
    ] = None
    monotone: Annotated[
        bool | None,
        Meaning(
            "Monotone",
            "whether no measured time step has an error more than 10 % above that of a larger one that keeps the limit, or "
            "that has the smallest error; empty if fewer than two time steps have an error",
        ),
    ] = None
    efforts: Annotated[
        Efforts,
        Meaning(
            "Efforts",
            "when the efforts of driven joints are computed, which the cost includes: costs are compared among methods with "
            "the same alone; empty if no joint is driven",
        ),
    ] = ""

    @property
    def method(self) -> RunKey:
        """The key of the engine and the method, over all cases, time steps and accuracies."""
        return key_of(self.engine, Method.parse(self.integrator, 0.0))

    @property
    def is_controlled(self) -> bool:
        """True if the method has error control, so that its accuracy is the answer."""
        return Method.parse(self.integrator, 0.0).accuracy is not None


#: The table of answers, and the table of all measured time steps.
ANSWERS = table_of(
    Answer,
    "recommend",
    "time steps that keep an error",
    key=("engine", "integrator"),
    shown=("engine", "integrator", "timestep", "error", "margin", "cost", "broken", "monotone", "reached", "reason"),
    later=("worst", "monotone", "efforts"),
)
STEPS = table_of(
    Probe,
    "steps",
    "measured time steps",
    key=("engine", "integrator", "timestep"),
    shown=("engine", "integrator", "timestep", "error", "status", "reason"),
)

#: The tables of the study, the main one first.
TABLES = (ANSWERS, STEPS)


@dataclass(frozen=True)
class Asked:
    """The question of the study: a case, a figure and its limit.

    Parameters
    ----------
    case, duration
        The name of the case, and its duration (s).
    figure
        The name of the figure that is limited.
    error
        The limit, in the unit of the figure.
    periods
        The number of periods of controllers in the case, of which the numbers of steps are multiples, so that instants of
        controllers are steps; 1 if any number of steps may be measured.
    """

    case: str
    duration: float
    figure: str
    error: float
    periods: int = 1

    @property
    def unit(self) -> str:
        """The unit of the error; empty if it is relative."""
        return FIGURES[self.figure].unit

    def steps(self, timestep: float) -> int:
        """Return the number of steps of a run with a time step (s)."""
        return round(self.duration / timestep)

    def number(self, method: Method) -> int | None:
        """Return the number of a method in its search: of its steps in a period, or the place of its accuracy, from 1.

        None if a run with the time step does not end at the end of the case, up to the rounding of stored time steps, if its
        steps do not divide the period, or if the accuracy is another one.
        """
        if method.accuracy is not None:
            return FINE_ACCURACIES.index(method.accuracy) + 1 if method.accuracy in FINE_ACCURACIES else None
        steps = self.steps(method.timestep)
        fits = steps % self.periods == 0 and math.isclose(method.timestep * steps, self.duration, rel_tol=1e-9)
        return steps // self.periods if fits else None

    def place(self, probe: Probe) -> tuple[float, float]:
        """Return a sort key that puts the probes of a method in order, the largest time step or accuracy first."""
        return -probe.timestep, -(probe.engine_method.accuracy or 0.0)

    def numbered(self, method: Method, number: int) -> Method:
        """Return a method with the time step, or with error control with the accuracy, that has a number in its search."""
        if method.accuracy is not None:
            return method.with_accuracy(FINE_ACCURACIES[number - 1])
        return method.at(self.duration / (number * self.periods))

    def errors(self, probes: Iterable[Probe]) -> dict[int, float]:
        """Return the errors of a method by the number of steps or accuracies; see `number`.

        The error of a run that has none, for example because it failed, is infinite. Runs that timed out are left out.
        """
        return {
            number: math.inf if probe.error is None else probe.error
            for probe in probes
            if probe.status != TimedOut.status and (number := self.number(probe.engine_method)) is not None
        }


@dataclass(frozen=True)
class Recommendation:
    """The results of the study.

    Parameters
    ----------
    asked
        The question.
    answers
        An answer for each method: first for those that keep the limit, the cheapest first; then for the others, the smallest
        error first.
    probes
        All measured time steps, method by method, the largest time step first.
    """

    asked: Asked
    answers: tuple[Answer, ...]
    probes: tuple[Probe, ...]

    @property
    def best(self) -> Answer | None:
        """The answer for the cheapest method that keeps the limit; None if no method does."""
        return next(iter(self.reached), None)

    def of(self, answer: Answer) -> list[Probe]:
        """Return the measured time steps of the method of an answer."""
        return [probe for probe in self.probes if probe.method == answer.method]

    @property
    def reached(self) -> tuple[Answer, ...]:
        """The answers for the methods that keep the limit, the cheapest first."""
        return tuple(answer for answer in self.answers if answer.reached)

    @property
    def unreached(self) -> tuple[Answer, ...]:
        """The answers for the methods that do not keep the limit, the smallest error first."""
        return tuple(answer for answer in self.answers if not answer.reached)
