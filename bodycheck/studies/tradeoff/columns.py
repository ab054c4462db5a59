"""The columns of tradeoff.csv after those of results."""

from bodycheck.figures.definition import Column

#: Columns after those of results: what a step costs.
COSTS = (
    Column("time_per_step_low", "number", "Time per step, low", "smallest time per step of the repeated timings", "s"),
    Column("time_per_step_high", "number", "Time per step, high", "largest time per step of the repeated timings", "s"),
    Column("evaluations", "number", "Evaluations", "evaluations of the accelerations per step", counts="evaluations"),
    Column("cost", "number", "Cost", "computing time per simulated second", "s/s"),
    Column("processor_time_per_step", "number", "Processor time per step", "time of all processors per step", "s"),
    Column(
        "setup_time", "number", "Set-up time", "time of the first set-up in a process, in which some engines compile code", "s"
    ),
    Column("engine_share", "number", "Engine share", "share of the time that passes in the engine's own calls", counts="share"),
)

#: Columns after those of costs. Rows of single runs have the last two, and the others are empty in them.
BATCHES = (
    Column("worst_position_error", "number", "Worst position error", "largest position error of all scenes of a batch", "m"),
    Column("worst_attitude_error", "number", "Worst attitude error", "largest attitude error of all scenes of a batch", "rad"),
    Column("failed_scenes", "integer", "Failed scenes", "number of the scenes of a batch that failed", counts="scenes"),
    Column("batch", "integer", "Batch", "number of the scenes of a batch", counts="scenes"),
    Column("device", "string", "Device", "device of the engine's arithmetic"),
    Column("precision", "string", "Precision", "precision of the engine's arithmetic"),
)

COST_COLUMNS = tuple(column.name for column in COSTS)
BATCH_COLUMNS = tuple(column.name for column in BATCHES)
