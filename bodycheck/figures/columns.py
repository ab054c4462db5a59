"""The columns of results, from which every table, schema, plot and message takes names, titles, units and meanings.

A new figure of a run is one entry, a `Figure`, in one of the groups that `FIGURES` joins, which are in the other modules of
this folder. The grammar of case files, both JSON Schemas, the results, the baseline, the reports and the table in docs/cases.md
follow. Three files must be renewed by commands:

    bodycheck schema > cases/case.schema.json
    bodycheck schema results > reports/results.schema.json
    python docs/tables.py
"""

import math
from collections.abc import Mapping
from typing import TypeVar

import numpy as np

from bodycheck.figures import bounds, conservation, contact, friction, impacts, mechanisms, motion, sensors, touching
from bodycheck.figures.column import Column
from bodycheck.figures.definition import Comparison, Figure
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truths import Truth

#: A number, or an array of numbers.
Value = TypeVar("Value", float, Array)

#: Figures of a run by name, in the order in which they are computed.
FIGURES: dict[str, Figure] = {
    figure.name: figure
    for figure in (
        *motion.ERRORS,
        *conservation.DRIFTS,
        *conservation.ERRORS,
        bounds.ATTITUDE,
        *contact.STOP,
        *contact.POSE,
        *contact.LOAD,
        *bounds.OTHERS,
        motion.NORM,
        *mechanisms.FIGURES,
        *touching.FIGURES,
        *sensors.FIGURES,
        *impacts.FIGURES,
        *friction.FIGURES,
    )
}

#: Figures with a column in every table, and figures with a column only in tables in which a run has a value.
ALWAYS_TABLED = tuple(figure.name for figure in FIGURES.values() if figure.presence != "where measured")
FURTHER = tuple(figure.name for figure in FIGURES.values() if figure.presence == "where measured")

RUN_COLUMNS = (
    Column("set", "string", "Set", "label of the set of results that the run belongs to, in a table of several sets"),
    Column("case", "string", "Case", "name of the case"),
    Column("engine", "string", "Engine", "name of the engine"),
    Column("version", "string", "Version", "version of the engine"),
    Column("integrator", "string", "Integrator", "name of the integrator, with its options after a colon"),
    Column("timestep", "number", "Time step", "time step", "s"),
    Column("status", "string", "Status", "how the run ended"),
    Column("passed", "boolean", "Passed", "whether the run meets all expectations of its case; empty without expectations"),
    Column("reason", "string", "Reason", "why the run is not ok, or which expectation it does not meet"),
)

COST_COLUMNS = (
    Column("steps", "integer", "Steps", "number of steps", counts="steps"),
    Column("wall_time", "number", "Wall time", "time that the steps took, measured once; `tradeoff` measures costs", "s"),
    Column("time_per_step", "number", "Time per step", "time that a step took, measured once; `tradeoff` measures costs", "s"),
    Column(
        "realtime_factor",
        "number",
        "Real-time factor",
        "simulated time divided by the time of the computation, measured once; `tradeoff` measures costs",
        counts="times real time",
    ),
)

WORK_COLUMNS = (
    Column("steps_taken", "integer", "Steps taken", "number of steps that the engine took to the end", counts="steps"),
    Column(
        "steps_rejected",
        "integer",
        "Steps rejected",
        "number of attempted steps whose error was too large; empty for steps of fixed size, and if the engine does not count",
        counts="steps",
    ),
    Column(
        "evaluations",
        "integer",
        "Evaluations",
        "number of evaluations of the accelerations; empty for steps of fixed size, and if the engine does not count",
        counts="evaluations",
    ),
)

CASE_COLUMNS = (
    Column("kind", "string", "Kind", "kind of the scene: turning, translation, drag, contact or mechanism"),
    Column("tags", "string", "Tags", "tags of the case, with semicolons between them"),
)

#: The suffixes of the names of the columns for the limit and the margin of a figure.
LIMIT, MARGIN = "_limit", "_margin"


def _limit(figure: Figure) -> tuple[Column, Column]:
    """Return the columns for the limit and the margin of a figure."""
    where = "empty where the figure was not measured or nothing is expected of it"
    limit = f"largest value that the case allows for {figure.name}, or the least if it has no largest; {where}"
    margin = f"{figure.name}{LIMIT} divided by {figure.name}; {where}, and where the figure is zero"
    return (
        Column(figure.name + LIMIT, "number", f"{figure.title}, limit", limit, figure.unit, figure.counts),
        Column(figure.name + MARGIN, "number", f"{figure.title}, margin", margin, counts="times the measured value"),
    )


#: Columns with the limits of figures and their margins, which a table has only if any run has a value.
LIMIT_COLUMNS = tuple(column for figure in FIGURES.values() if figure.limited for column in _limit(figure))

#: Columns about the method of a run and its work, at the end of each table.
METHOD_COLUMNS = (
    *WORK_COLUMNS,
    Column(
        "role",
        "string",
        "Role",
        "whether the method is the default of its engine, which users of its quick start get, and whether the documentation of "
        "the engine recommends it; empty if neither",
        words=frozenset({"default", "recommended", "default, recommended"}),
    ),
)

#: The column with the departure of a robot from its file, and the columns of errors up to there by the names of the errors.
DEPARTURE = "departure"
BEFORE_DEPARTURE = {name: f"{name}_before_departure" for name in ("position_error", "attitude_error")}

#: Columns at the end of a table in which any case has a robot whose limits or contacts act from an instant on.
DEPARTURE_COLUMNS = (
    Column(
        DEPARTURE,
        "number",
        "Departure",
        "last instant at which neither limits nor contacts of the robot's file have acted, which the case leaves out; empty if "
        "they do not act",
        "s",
    ),
    *(
        Column(
            column,
            "number",
            f"{FIGURES[name].title} before the departure",
            f"{name} up to the departure; empty if they act from the start",
            FIGURES[name].unit,
        )
        for name, column in BEFORE_DEPARTURE.items()
    ),
)

#: Columns at the end of a table in which any run has them: on driven joints, and on what engines are handed of contact laws.
ENGINE_COLUMNS = (
    Column(
        "efforts",
        "string",
        "Efforts",
        "when the efforts of driven joints were computed: between steps, or at the stages of the integrator; costs are "
        "compared among runs with the same alone; empty if no joint is driven",
        words=frozenset({"between steps", "at stages"}),
    ),
    Column(
        "control_law",
        "string",
        "Control law",
        "which law the motion of a single joint equals to the rounding of the engine's precision: continuous, sampled, delayed "
        "by N periods, implicit, or semi-implicit; empty if none, or if the scene does not distinguish them",
    ),
    Column(
        "contact_terms",
        "string",
        "Contact law given",
        "what the engine was handed in the place of the friction and restitution of the case; empty if it has exactly these",
    ),
)

#: All columns by name, in the order of tables.
COLUMNS: dict[str, Column] = {
    column.name: column
    for column in (
        *RUN_COLUMNS,
        *(FIGURES[name] for name in ALWAYS_TABLED),
        *COST_COLUMNS,
        *(FIGURES[name] for name in FURTHER),
        *CASE_COLUMNS,
        *LIMIT_COLUMNS,
        *METHOD_COLUMNS,
        *DEPARTURE_COLUMNS,
        *ENGINE_COLUMNS,
    )
}

#: The observed order of convergence: a case file may limit it, but it is computed from three runs, and is no column.
ORDER = Column(
    "order",
    "number",
    "Order",
    "power of the time step with which the attitude error decreases, measured at this step, its half and its quarter",
    remark="a number holds within 0.25",
)

#: Figures that a case file may limit, by name, in the order of its grammar.
LIMITED: dict[str, Column] = {figure.name: figure for figure in FIGURES.values() if figure.limited} | {ORDER.name: ORDER}

#: The columns and figures that messages about a broken expectation may name.
EXPECTED = COLUMNS | LIMITED

#: The units of the columns that have a unit.
UNITS = {column.name: column.unit for column in COLUMNS.values() if column.unit}


def most_possible(name: str, last: float) -> float:
    """Return the largest value that a figure of a run with this last instant (s) can have, in the figure's unit.

    The value is infinite for figures without a largest value, and for the observed order.
    """
    return FIGURES[name].most(last) if name in FIGURES else math.inf


def distance_from_ideal(name: str, value: Value) -> Value:
    """Return the distance of a value of a figure, or of several values (n,), from the value of a run without any error.

    The distance is the value itself if the ideal value is 0 or the name is no figure.
    """
    ideal = FIGURES[name].ideal if name in FIGURES else 0.0
    return abs(value - ideal) if ideal else value


def truth_bounds(truth: Truth) -> dict[str, Array]:
    """Return the known bounds (n,) of the truth's own errors, by the names of the figures that have no meaning below them.

    The bounds are in the units of these figures.
    """
    known = bounds_of(truth)
    return {figure.name: known[figure.bounded_by] for figure in FIGURES.values() if figure.bounded_by in known}


def largest_bounds(values: Mapping[str, float]) -> dict[str, float]:
    """Return the maxima over time of `truth_bounds`, taken from the values of a run by column."""
    return {figure.name: values[figure.bounded_by] for figure in FIGURES.values() if figure.bounded_by in values}


def bounds_of(truth: Truth) -> dict[str, Array]:
    """Return the known bounds (n,) of the truth's own errors, by the names and in the units of their columns."""
    compared = Comparison(truth, truth.trajectory)
    computed = {figure.name: figure.compute(compared) for figure in FIGURES.values() if figure.of_truth}
    return {name: values for name, values in computed.items() if isinstance(values, np.ndarray)}
