"""The methods that represent engines in results, by their roles, which results of earlier versions lack."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.adapters.contract import Role
from bodycheck.adapters.engine_name import adapter_of
from bodycheck.running.roles import BOTH


def own_method(rows: Sequence[Mapping[str, Any]], defaults: Mapping[str, Mapping[str, str]]) -> int:
    """Return the index of the run that represents an engine.

    This is the run of the engine's default method. If no row has this role, because the results are of an earlier version or
    the engine has no default method, it is the run with the integrator that the engine itself chooses, or else the first run.

    Parameters
    ----------
    rows
        The rows of one case in one version of an engine, in the order of results.csv, in which the first is the method that the
        adapter lists first. At least one row.
    defaults
        The settings that each engine chooses by default, as given in the header of results.
    """
    if (index := in_role(rows, "default")) is not None:
        return index
    indices = {row["integrator"]: index for index, row in reversed(list(enumerate(rows)))}
    return next((indices[name] for name in chosen(rows[0]["engine"], defaults) if name in indices), 0)


def in_role(rows: Sequence[Mapping[str, Any]], role: Role) -> int | None:
    """Return the index of the first run whose method has a role; None if there is none."""
    return next((index for index, row in enumerate(rows) if role in roles_of(row)), None)


def roles_of(row: Mapping[str, Any]) -> list[str]:
    """Return the roles of the method of a run; empty if it has none, or if they are not known."""
    return [role for role in str(row.get("role") or "").split(BOTH) if role]


def in_words(row: Mapping[str, Any]) -> str:
    """Return the roles of the method of a run in words, also if it has none or they are not known."""
    if roles := roles_of(row):
        return f"{' and '.join(roles)} method"
    return "neither default nor recommended" if "role" in row else "role not known"


def chosen(engine: str, defaults: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return the integrators that an engine itself chooses, the usual one first; empty if the user has to choose.

    The entry of an engine in `defaults` may list several integrators, each with its use: "lagged, runge_kutta3 of a continuous
    plant".
    """
    told = (defaults.get(engine) or defaults.get(adapter_of(engine)) or {}).get("integrator", "")
    return [part.split()[0] for part in told.split(",") if part.strip()]
