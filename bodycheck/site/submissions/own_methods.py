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
    places = {row["integrator"]: place for place, row in reversed(list(enumerate(rows)))}
    return next((places[name] for name in chosen(rows[0]["engine"], defaults) if name in places), 0)


def chosen(engine: str, defaults: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return the integrators that an engine itself chooses, the usual one first; none if it leaves that to its user.

    An engine may tell several, each with what it is for: "lagged, runge_kutta3 of a continuous plant".
    """
    told = (defaults.get(engine) or defaults.get(adapter_of(engine)) or {}).get("integrator", "")
    return [part.split()[0] for part in told.split(",") if part.strip()]
