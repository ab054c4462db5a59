"""The key of a run: its case, engine and method, and its set of results if there are several."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bodycheck.adapters.method import Method, checked_name, current


@dataclass(frozen=True)
class RunKey:
    """Identifies a run.

    Parameters
    ----------
    case
        The name of the case; empty if the key stands for all cases.
    engine
        The name of the engine.
    method
        Integrator, options and time step; the time step is 0 if the key stands for all time steps.
    label
        The label of the set of results; empty if there is only one set.
    """

    case: str
    engine: str
    method: Method
    label: str = ""

    @classmethod
    def of_row(cls, row: Mapping[str, Any], label: str = "") -> "RunKey":
        """Return the key of a row of any table with the columns case, engine, integrator and timestep (s).

        Rows of earlier versions of bodycheck, which spelled some methods differently, are accepted. Raises `BadInput` if the
        column `integrator` contains no spelling of a method, or `engine` no name of an engine.
        """
        engine = checked_name(row["engine"], "engine")
        return cls(row["case"], engine, Method.parse(current(row["integrator"]), float(row["timestep"])), label)

    @classmethod
    def of_method(cls, engine: str, spelling: str, timestep: float = 0.0, label: str = "") -> "RunKey":
        """Return the key of a method over all cases, and over all time steps if no time step (s) is given.

        Raises `BadInput` for text that is no spelling of a method.
        """
        return cls("", engine, Method.parse(spelling, timestep), label)

    @property
    def over_cases(self) -> "RunKey":
        """The key of the same engine and method that stands for all cases."""
        return RunKey("", self.engine, self.method, self.label)

    @property
    def over_steps(self) -> "RunKey":
        """The key of the same integrator and options that stands for all time steps."""
        return RunKey(self.case, self.engine, self.method.at(0.0), self.label)
