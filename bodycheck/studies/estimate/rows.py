"""The rows of estimate.csv, and what else the study says of an engine's runs of a file."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from bodycheck.results.tables import Meaning, table_of

#: The file of the records of a study.
RECORDS = "estimate.jsonl"

#: The verdicts; of a chaotic scene, the instant follows the words "chaotic beyond".
ESTIMATE, NOT_ASYMPTOTIC, CHAOTIC = "estimate", "not-asymptotic", "chaotic beyond"
DIVERGED, RESET, NO_TIME, UNSUPPORTED = "diverged", "reset", "no-time", "unsupported"

#: The verdicts of rows that are results.
MEASURED = (ESTIMATE, NOT_ASYMPTOTIC, CHAOTIC, DIVERGED, RESET)


@dataclass(frozen=True)
class EstimateRow:
    """The error of one quantity with one method and time step, from the engine's own limit as the time step goes to zero."""

    file: Annotated[str, Meaning("File", "name of the file or of the case")]
    engine: str
    version: str
    integrator: str
    timestep: float
    quantity: Annotated[
        str,
        Meaning(
            "Quantity",
            "figure of results that means the same: the largest error over time; with the suffix _at_end the error at the end",
        ),
    ]
    estimate: Annotated[
        float | None,
        Meaning(
            "Estimate",
            "estimated error from the engine's own limit as the time step goes to zero, in the unit of the quantity, over the "
            "time until the horizon; empty if there is no estimate",
        ),
    ]
    low: Annotated[float | None, Meaning("Low", "lower end of the interval of the error")]
    high: Annotated[float | None, Meaning("High", "upper end of the interval of the error")]
    order: Annotated[
        float | None, Meaning("Order", "observed order of convergence", counts="powers of the time step", signed=True)
    ]
    verdict: Annotated[
        str,
        Meaning(
            "Verdict",
            "estimate; not-asymptotic; chaotic beyond an instant (s); diverged; reset; no-time; or unsupported",
        ),
    ]
    reason: Annotated[str, Meaning("Reason", "why there is no estimate, or what it is limited by")]
    horizon: Annotated[
        float | None,
        Meaning("Horizon", "last instant until which the row is an estimate; empty if there is none", "s"),
    ]
    cost: Annotated[float | None, Meaning("Cost", "computing time per simulated second", "s")]


ROWS = table_of(
    EstimateRow,
    "estimate",
    "estimates",
    key=("file", "engine", "integrator", "timestep", "quantity"),
    filled=("file", "engine", "version", "integrator", "timestep", "verdict"),
    shown=("engine", "integrator", "timestep", "quantity", "estimate", "low", "high", "order", "verdict", "horizon", "cost"),
)

#: The tables of the study.
TABLES = (ROWS,)


@dataclass(frozen=True)
class Choice:
    """The cheapest method and time step of an engine that keep an error, and the time step of the file.

    Attributes
    ----------
    engine, integrator, timestep
        The engine, the method and the time step (s).
    high, cost
        The upper end of the interval of its error, and its cost (s/s).
    """

    engine: str
    integrator: str
    timestep: float
    high: float
    cost: float


@dataclass(frozen=True)
class About:
    """The question of a study.

    Attributes
    ----------
    file, duration
        The name of the file, and the duration of the runs (s).
    error
        The error that is allowed (rad or m).
    compared
        The quantities that are compared with it.
    """

    file: str
    duration: float
    error: float
    compared: tuple[str, ...]


@dataclass(frozen=True)
class Solver:
    """The settings of a solver in a file, and the error that they cost at the present time step.

    Attributes
    ----------
    iterations, tolerance
        The settings.
    needed
        The most iterations that a step made.
    until
        The end (s) of the time in which the runs are compared.
    errors
        The largest differences from the run with the stricter solver until then, by quantities.
    """

    iterations: int
    tolerance: float
    needed: int
    until: float
    errors: dict[str, float]


@dataclass(frozen=True)
class OfEngine:
    """The results of one engine.

    Attributes
    ----------
    engine
        The name of the engine.
    integrator, timestep
        The method and the time step (s) of the file; empty and 0 if the engine cannot run it.
    kind
        The class of the scene; empty if it is not known.
    rows
        The rows.
    apart
        The distance of the finest run from the truth of a case and the bound of the truth's error, by quantities.
    shown
        The animation of the runs of a file as a record; None if there is none.
    solver
        What the settings of the engine's solver in the file cost; None if it has none, or it made no iteration.
    """

    engine: str
    integrator: str
    timestep: float
    kind: str
    rows: tuple[EstimateRow, ...]
    apart: dict[str, tuple[float, float]]
    shown: dict[str, Any] | None = None
    solver: Solver | None = None


@dataclass(frozen=True)
class Estimates:
    """All results of a study.

    Attributes
    ----------
    file, duration, error, compared
        As in `About`.
    present
        For each engine the method and the time step (s) of the file.
    kinds
        For each engine the class of the scene.
    rows
        The rows of all engines.
    apart
        For each engine the distance of its finest run from the truth of a case, and the bound of the truth's error.
    spread
        For pairs of engines the differences between their limits, each with its uncertainty, by quantities.
    causes
        For each of several engines what its reader makes of the file other than the file says, in words.
    shown
        For engines with an animation of the runs, the animation as a record.
    solvers
        For engines with a solver that made iterations, what its settings in the file cost.
    """

    file: str
    duration: float
    error: float
    compared: tuple[str, ...]
    present: dict[str, tuple[str, float]]
    kinds: dict[str, str]
    rows: tuple[EstimateRow, ...]
    apart: dict[str, dict[str, tuple[float, float]]]
    spread: dict[tuple[str, str], dict[str, tuple[float, float]]]
    causes: dict[str, str]
    shown: dict[str, dict[str, Any]]
    solvers: dict[str, Solver]


def joined(
    about: About,
    engines: Sequence[OfEngine],
    spread: Sequence[tuple[str, str, dict[str, tuple[float, float]]]],
    causes: dict[str, str],
) -> Estimates:
    """Return the results of all engines as one, with the differences between pairs of them, and what parity says of each."""
    return Estimates(
        *(about.file, about.duration, about.error, about.compared),
        present={one.engine: (one.integrator, one.timestep) for one in engines},
        kinds={one.engine: one.kind for one in engines},
        rows=tuple(row for one in engines for row in one.rows),
        apart={one.engine: one.apart for one in engines if one.apart},
        spread={(one, other): differences for one, other, differences in spread},
        causes=causes,
        shown={one.engine: one.shown for one in engines if one.shown is not None},
        solvers={one.engine: one.solver for one in engines if one.solver is not None},
    )


def by_step(rows: Sequence[EstimateRow]) -> dict[tuple[str, str], dict[float, list[EstimateRow]]]:
    """Return the rows of each engine and method by time step, the smallest first."""
    groups: dict[tuple[str, str], dict[float, list[EstimateRow]]] = {}
    for row in sorted(rows, key=lambda one: one.timestep):
        groups.setdefault((row.engine, row.integrator), {}).setdefault(row.timestep, []).append(row)
    return groups


def choices(results: Estimates) -> list[Choice]:
    """Return the largest time step of each engine and method that keeps the error with all smaller ones, the cheapest first."""
    chosen = []
    for (engine, integrator), of_method in by_step(results.rows).items():
        kept = None
        for timestep, rows in of_method.items():
            high, cost = largest(rows, results.compared), rows[0].cost
            if any(row.verdict in (DIVERGED, RESET) for row in rows) or (high is not None and high > results.error):
                break
            if high is not None and cost is not None:
                kept = Choice(engine, integrator, timestep, high, cost)
        chosen += [] if kept is None else [kept]
    return sorted(chosen, key=lambda one: one.cost)


def largest(rows: Sequence[EstimateRow], quantities: Sequence[str]) -> float | None:
    """Return the largest upper end of the errors of one run; None if a quantity has no estimate."""
    compared = [row for row in rows if row.quantity in quantities]
    if not compared or any(row.verdict != ESTIMATE or row.high is None for row in compared):
        return None
    return max(row.high for row in compared if row.high is not None)
