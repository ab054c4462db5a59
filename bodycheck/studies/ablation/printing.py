"""Print the table of the ablation study to the terminal."""

from collections.abc import Sequence

from bodycheck.console.figures import figure_text, scaled
from bodycheck.console.terminal import print_table
from bodycheck.studies.ablation.rows import Change, ModelRow


def print_ablation(rows: Sequence[ModelRow]) -> None:
    """Print one line per model."""
    header = ("case", "engine", "integrator", "step", "model", "us/step", "cost", "position change m", "attitude change rad")
    print_table((*header, "reason"), map(_model, rows))


def _model(row: ModelRow) -> tuple[str, ...]:
    names = (row.case, row.engine, row.integrator, f"{row.timestep:g}", row.model)
    spread = f" ({figure_text(row.relative_cost_low)} to {figure_text(row.relative_cost_high)})" if row.relative_cost else ""
    changes = [_change(row.changes.get(quantity)) for quantity in ("position", "attitude")]
    return (*names, figure_text(scaled(1e6, row.time_per_step)), figure_text(row.relative_cost) + spread, *changes, row.reason)


def _change(change: Change | None) -> str:
    if change is None:
        return ""
    if change.is_rounding:
        return "none"
    return f"{change.size:.3g}" + ("" if change.agrees else " > time-step errors")
