"""Which run of an engine is that of the method that the engine itself chooses."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.adapters.engine_name import adapter_of


def own_method(rows: Sequence[Mapping[str, Any]], defaults: Mapping[str, Mapping[str, str]]) -> int:
    """Return the place of the run with the integrator that the engine itself chooses, or that its adapter offers first.

    Parameters
    ----------
    rows
        The rows of one case in one version of an engine in the order of results.csv, at least one.
    defaults
        What each engine chooses, as the header of results has it.
    """
    engine = rows[0]["engine"]
    own = (defaults.get(engine) or defaults.get(adapter_of(engine)) or {}).get("integrator", "")
    return next((place for place, row in enumerate(rows) if row["integrator"] == own), 0)
