"""Print the table of the ablation study to the terminal."""

from collections.abc import Sequence

from bodycheck.console.figures import figure_text, scaled
from bodycheck.console.options import View
from bodycheck.console.tables import Column, attribute, show
from bodycheck.studies.ablation.rows import Change, ModelRow


def print_ablation(rows: Sequence[ModelRow], view: View) -> None:
    """Print one line per model."""
    show(MODELS, rows, view)


def _cost(row: ModelRow) -> str:
    spread = f" ({figure_text(row.relative_cost_low)} to {figure_text(row.relative_cost_high)})" if row.relative_cost else ""
    return figure_text(row.relative_cost) + spread


def _change(quantity: str, unit: str, goes: int) -> Column[ModelRow]:
    def text(row: ModelRow) -> str:
        change: Change | None = row.changes.get(quantity)
        if change is None:
            return ""
        if change.is_rounding:
            return "none"
        return f"{change.size:.3g}" + ("" if change.agrees else " > time-step errors")

    def size(row: ModelRow) -> float | None:
        return row.changes[quantity].size if quantity in row.changes else None

    return Column(f"{quantity}_change", f"{quantity} change {unit}", text, size, goes)


def _microseconds(row: ModelRow) -> float | None:
    return scaled(1e6, row.time_per_step)


def _apart(row: ModelRow) -> float | None:
    return row.errors.get("constraint_error")


#: The columns of the table.
MODELS: tuple[Column[ModelRow], ...] = (
    attribute("case"),
    attribute("engine", goes=5),
    attribute("integrator", goes=6),
    attribute("timestep", "step", "g", goes=2),
    attribute("model"),
    Column("time_per_step", "us/step", lambda row: figure_text(_microseconds(row)), _microseconds, goes=4),
    Column("relative_cost", "cost", _cost, lambda row: row.relative_cost),
    _change("position", "m", goes=3),
    _change("attitude", "rad", goes=1),
    Column("constraint_error", "apart m", lambda row: figure_text(_apart(row)), _apart, goes=8),
    attribute("reason", goes=7, wraps=True),
)
