"""The tables of the study: tradeoff.csv, with the columns of results, costs and batches, and orders.csv."""

from collections.abc import Mapping
from typing import Any

from bodycheck.figures.column import Column
from bodycheck.results.tables import RESULTS, RUN, RUN_FILLED, Table
from bodycheck.studies.orders import ORDERS

#: The columns of costs, which follow the columns of results.
COSTS = (
    Column("time_per_step_low", "number", "Time per step, low", "smallest time per step of the repeated timings", "s"),
    Column("time_per_step_high", "number", "Time per step, high", "largest time per step of the repeated timings", "s"),
    Column(
        "evaluations",
        "integer",
        "Evaluations",
        "evaluations of the accelerations per step, with error control on average",
        counts="evaluations",
    ),
    Column("cost", "number", "Cost", "computing time per simulated second", "s/s"),
    Column("processor_time_per_step", "number", "Processor time per step", "time of all processors per step", "s"),
    Column(
        "setup_time", "number", "Set-up time", "time of the first set-up in a process, in which some engines compile code", "s"
    ),
    Column("engine_share", "number", "Engine share", "share of the time that passes in the engine's own calls", counts="share"),
)

#: The columns of batches, which follow the columns of costs. In rows of single runs, only the last two of them are not empty.
BATCHES = (
    Column("worst_position_error", "number", "Worst position error", "largest position error of all scenes of a batch", "m"),
    Column("worst_attitude_error", "number", "Worst attitude error", "largest attitude error of all scenes of a batch", "rad"),
    Column("failed_scenes", "integer", "Failed scenes", "number of the scenes of a batch that failed", counts="scenes"),
    Column("batch", "integer", "Batch", "number of the scenes of a batch", counts="scenes"),
    Column("device", "string", "Device", "device of the engine's arithmetic"),
    Column(
        *("precision", "string", "Precision", "precision of the engine's arithmetic"),
        words=frozenset(("float64", "float32")),
    ),
)

COST_COLUMNS = tuple(column.name for column in COSTS)
BATCH_COLUMNS = tuple(column.name for column in BATCHES)

#: The table of runs and of batches, with their costs.
RUNS: Table[Mapping[str, Any]] = Table(
    "tradeoff",
    "errors and costs over time steps",
    None,
    (*(column for column in RESULTS.columns if column.name not in COST_COLUMNS), *COSTS, *BATCHES),
    key=(*RUN, "device", "precision", "batch"),
    filled=RUN_FILLED,
    shown=(
        *("case", "engine", "integrator", "timestep", "status", "position_error", "attitude_error"),
        *("energy_drift", "energy_error", "cost", "reason"),
    ),
)

#: The tables of the study, the main one first.
TABLES = (RUNS, ORDERS)
