"""The packages that install an engine, and the environment that its processes need."""

from collections.abc import Mapping
from dataclasses import dataclass, field

#: The placeholder for the folder of the engine's environment in the value of an environment variable.
ENVIRONMENT = "{environment}"


@dataclass(frozen=True)
class Installation:
    """The packages that install an engine, and the environment that its processes need.

    Parameters
    ----------
    distribution
        The package that installs the engine, as pip names it. The version of the engine is the version of this package.
    extras
        The extras of the package that are needed.
    others
        Further requirements, as pip spells them.
    variables
        Environment variables of the engine's processes. `ENVIRONMENT` in a value is replaced by the folder of the engine's
        separate environment; such a variable is not set if the engine is installed in the environment of bodycheck.
    modules
        The top-level modules of the engine, and of libraries that it shares with other engines, that the adapter imports and
        that nothing else in bodycheck imports. If it is empty, `imported` is the module with the name of the package.
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
        """Return the names and values of the environment variables of processes in the engine's separate environment.

        If `folder` is None, the engine has no separate environment, and the variables that contain its folder are left out.
        """
        return tuple(
            (name, value.replace(ENVIRONMENT, folder or ""))
            for name, value in self.variables.items()
            if folder is not None or ENVIRONMENT not in value
        )
