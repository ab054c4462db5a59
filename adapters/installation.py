"""The packages that install an engine, and the environment that its processes need."""

from collections.abc import Mapping
from dataclasses import dataclass, field

#: What stands in the value of an environment variable for the folder of the engine's environment.
ENVIRONMENT = "{environment}"


@dataclass(frozen=True)
class Installation:
    """The packages that install an engine, and the environment that its processes need.

    Parameters
    ----------
    distribution
        The package that installs the engine, as pip names it. The version of the engine is that of this package.
    extras
        The extras of the package that are needed.
    others
        Further requirements, as pip spells them.
    variables
        Environment variables of the engine's processes. `ENVIRONMENT` in a value stands for the folder of the environment in
        which the engine is installed apart; such a variable is not set where the engine is installed beside bodycheck.
    modules
        The top-level modules by which the adapter imports the engine and what it shares with others, which nothing else in
        bodycheck imports. If it is empty, that is the module with the name of the package, as `imported` says.
    """

    distribution: str
    extras: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    variables: Mapping[str, str] = field(default_factory=dict)
    modules: tuple[str, ...] = ()

    @property
    def imported(self) -> tuple[str, ...]:
        """The top-level modules of engines that the adapter imports."""
        return self.modules or (self.distribution.replace("-", "_"),)

    def requirements(self, version: str) -> tuple[str, ...]:
        """Return the requirements, as pip spells them, of a version of the engine."""
        extras = f"[{','.join(self.extras)}]" if self.extras else ""
        return (f"{self.distribution}{extras}=={version}", *self.others)

    def variables_in(self, folder: str | None) -> tuple[tuple[str, str], ...]:
        """Return the environment variables of processes in an environment; None stands for none."""
        return tuple(
            (name, value.replace(ENVIRONMENT, folder or ""))
            for name, value in self.variables.items()
            if folder is not None or ENVIRONMENT not in value
        )
