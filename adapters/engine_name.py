"""The name of an engine as users write it, as one value with one spelling.

The spelling is `ENGINE` or `ENGINE@VERSION`, for example `mujoco` or `mujoco@3.17.0`. Only this module parses it.
"""

from dataclasses import dataclass

from bodycheck.adapters.method import checked_name


@dataclass(frozen=True)
class EngineName:
    """The engine that is meant, and which version of it.

    Attributes
    ----------
    adapter
        The name of its adapter.
    version
        The version that is meant; empty for the one that is installed here.
    """

    adapter: str
    version: str = ""

    @classmethod
    def parse(cls, spelling: str) -> "EngineName":
        """Return the engine with this spelling. Raises `BadInput` for text that cannot be the name of an engine."""
        adapter, _, version = checked_name(spelling, "engine").partition("@")
        return cls(adapter, version)

    def __str__(self) -> str:
        return f"{self.adapter}@{self.version}" if self.version else self.adapter
