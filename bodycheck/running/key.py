"""The key of a run: which case, which engine, which method, and which set of results where there are several."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bodycheck.adapters.method import Method, current


@dataclass(frozen=True)
class RunKey:
    """One run among others.

    Parameters
    ----------
    case
        The name of the case; empty where a method is meant over all cases.
    engine
        The name of the engine.
    method
        Integrator, options and time step; the time step is 0 where a method is meant with any.
    label
        The label of the set of results; empty where there is only one set.
    """

    case: str
    engine: str
    method: Method
    label: str = ""

    @classmethod
    def of_row(cls, row: Mapping[str, Any], label: str = "") -> "RunKey":
        """The key of a row of any table with the columns case, engine, integrator and timestep (s).

        The row may be of an earlier version of bodycheck, which spelled some methods otherwise. Raises `BadInput` where the
        column integrator has no spelling of a method.
        """
        return cls(row["case"], row["engine"], Method.parse(current(row["integrator"]), float(row["timestep"])), label)

    @property
    def over_cases(self) -> "RunKey":
        """The same engine and method over all cases."""
        return RunKey("", self.engine, self.method, self.label)

    @property
    def over_steps(self) -> "RunKey":
        """The same integrator and options with any time step."""
        return RunKey(self.case, self.engine, self.method.at(0.0), self.label)
