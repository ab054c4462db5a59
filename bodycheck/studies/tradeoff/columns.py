"""The columns of tradeoff.csv after those of results."""

#: Columns after those of results: the interval of the time per step (s), the evaluations of the accelerations per step, the
#: computing time (s) per simulated second, the processor time per step (s), the time (s) of the first set-up in a process, in
#: which some engines compile code, and the share of the time that passes in the engine's own calls.
COST_COLUMNS = (
    *("time_per_step_low", "time_per_step_high", "evaluations", "cost"),
    *("processor_time_per_step", "setup_time", "engine_share"),
)

#: Columns after those of costs: the largest errors (m, rad) over all scenes of a batch, the number of its scenes that failed,
#: the number of its scenes, and the device and the precision of the engine's arithmetic. Rows of single runs have the last two.
BATCH_COLUMNS = ("worst_position_error", "worst_attitude_error", "failed_scenes", "batch", "device", "precision")
