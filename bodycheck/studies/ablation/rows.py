"""The rows of the ablation study, one for each model of a case, from the smallest model to the largest."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from bodycheck.figures.column import Column
from bodycheck.figures.columns import COLUMNS, FIGURES
from bodycheck.results.tables import RUN, Table


@dataclass(frozen=True)
class Change:
    """The largest difference between the motions on a model and on the smallest model, in position (m) or attitude (rad).

    `rounding` is the largest difference that the rounding of all steps can cause, and `time_step` is the sum of the time-step
    errors of both models.
    """

    size: float
    rounding: float
    time_step: float

    @property
    def is_rounding(self) -> bool:
        """True if rounding alone can explain the difference."""
        return self.size <= self.rounding

    @property
    def agrees(self) -> bool:
        """True if the two models may converge to the same motion as the time step vanishes."""
        return self.size <= self.rounding + self.time_step


#: The quantities whose changes are measured, with their units.
CHANGED = {"position": "m", "attitude": "rad"}

#: The name of each column of a `Change`, which follows the quantity in the column's full name, and its meaning.
CHANGE_COLUMNS = (
    ("change", "largest difference from the motion of the smallest model"),
    ("rounding", "part of it that the rounding of all steps can cause"),
    ("time_step", "sum of the time-step errors of both models"),
)


@dataclass(frozen=True)
class ModelRow:
    """One model of a scene.

    Parameters
    ----------
    case, engine, version, integrator, timestep, model
        The identification of the run; the time step is in s.
    adds
        A description of the parts of this model that the next smaller model does not have.
    status, reason
        The status of the run, and the reason why it did not complete or was not timed.
    time_per_step
        The time per step (s); None if it was not measured.
    relative_cost, relative_cost_low, relative_cost_high
        The median, the minimum and the maximum of the ratio of the time per step to the smallest model's; None if not measured.
    changes
        The differences from the smallest model in position and attitude; empty if any of the compared runs did not complete.
    errors
        The errors of the run by the columns of results; empty if the run did not complete.
    """

    case: str
    engine: str
    version: str
    integrator: str
    timestep: float
    model: str
    adds: str
    status: str
    reason: str
    time_per_step: float | None
    relative_cost: float | None
    relative_cost_low: float | None
    relative_cost_high: float | None
    changes: Mapping[str, Change]
    errors: Mapping[str, float]


def _cost(name: str, title: str, meaning: str) -> Column:
    return Column(name, "number", title, f"{meaning}; empty if it was not measured", counts="times")


#: The table of models. Its errors are columns of results.
MODELS: Table[Mapping[str, Any]] = Table(
    "ablation",
    "costs and effects of larger models",
    None,
    (
        *(COLUMNS[name] for name in ("case", "engine", "version", "integrator", "timestep")),
        Column("model", "string", "Model", "name of the model"),
        _cost("relative_cost", "Relative cost", "time per step divided by that of the smallest model"),
        _cost("relative_cost_low", "Relative cost, low", "smallest ratio of the repeated timings"),
        _cost("relative_cost_high", "Relative cost, high", "largest ratio of the repeated timings"),
        *FIGURES.values(),
        *(
            Column(f"{quantity}_{part}", "number", f"{quantity.capitalize()}: {part.replace('_', ' ')}", meaning, unit)
            for quantity, unit in CHANGED.items()
            for part, meaning in CHANGE_COLUMNS
        ),
        COLUMNS["time_per_step"],
        COLUMNS["status"],
        Column("reason", "string", "Reason", "why the run did not complete or was not timed"),
        Column("adds", "string", "Adds", "what this model contains and the next smaller one does not"),
    ),
    key=(*RUN, "model"),
)

#: The tables of the study.
TABLES = (MODELS,)


def records(rows: Sequence[ModelRow]) -> list[dict[str, Any]]:
    """Return rows as mappings from the columns of the table to values; missing values are None."""
    errors = dict.fromkeys(name for row in rows for name in row.errors)
    names = [name for name in MODELS.by_name if name in ModelRow.__annotations__]
    before = names[: names.index("time_per_step")]
    by_column = []
    for row in rows:
        record: dict[str, Any] = {name: getattr(row, name) for name in before} | errors | dict(row.errors)
        for quantity in CHANGED:
            change = row.changes.get(quantity)
            record |= {
                f"{quantity}_change": change.size if change else None,
                f"{quantity}_rounding": change.rounding if change else None,
                f"{quantity}_time_step": change.time_step if change else None,
            }
        by_column.append(record | {name: getattr(row, name) for name in names[len(before) :]})
    return by_column


def row_of(record: Mapping[str, Any]) -> ModelRow:
    """Return the row from which `records` made a record."""
    names = [field.name for field in fields(ModelRow) if field.name not in ("changes", "errors")]
    changes = {
        quantity: Change(*(record[f"{quantity}_{part}"] for part, _ in CHANGE_COLUMNS))
        for quantity in CHANGED
        if record[f"{quantity}_change"] is not None
    }
    errors = {name: record[name] for name in COLUMNS if name not in names and record.get(name) is not None}
    return ModelRow(**{name: record[name] for name in names}, changes=changes, errors=errors)
