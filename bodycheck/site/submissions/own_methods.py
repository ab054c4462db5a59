"""The methods that engines themselves choose, and the runs of these methods."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.adapters.engine_name import adapter_of


def own_method(rows: Sequence[Mapping[str, Any]], defaults: Mapping[str, Mapping[str, str]]) -> int:
    """Return the index of the run with the integrator that the engine itself chooses, or 0 if there is no such run.

    Parameters
    ----------
    rows
        The rows of one case in one version of an engine, in the order of results.csv, in which the first is the method that the
        adapter lists first. At least one row.
    defaults
        The settings that each engine chooses by default, as given in the header of results.
    """
    places = {row["integrator"]: place for place, row in reversed(list(enumerate(rows)))}
    return next((places[name] for name in chosen(rows[0]["engine"], defaults) if name in places), 0)


def chosen(engine: str, defaults: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return the integrators that an engine itself chooses, the usual one first; empty if the user has to choose.

    The entry of an engine in `defaults` may list several integrators, each with its use: "lagged, runge_kutta3 of a continuous
    plant".
    """
    told = (defaults.get(engine) or defaults.get(adapter_of(engine)) or {}).get("integrator", "")
    return [part.split()[0] for part in told.split(",") if part.strip()]
