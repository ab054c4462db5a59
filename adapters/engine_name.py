"""The name of an engine as users write it: `NAME`, or `NAME@VERSION` for one release of it.

The name occurs in case files, on the command line and in the column `engine` of every table. Only this module parses it.
"""

from dataclasses import dataclass

from packaging.version import InvalidVersion, Version

from bodycheck.adapters.method import checked_name
from bodycheck.errors import BadInput


@dataclass(frozen=True)
class EngineName:
    """The name of an engine's adapter, and the requested version; None for the version that is installed.

    The version is spelled as PEP 440 normalises it.
    """

    adapter: str
    version: str | None = None

    @classmethod
    def parse(cls, text: str) -> "EngineName":
        """Return the name of an engine from its spelling. Raises `BadInput` for any other text."""
        adapter, at, version = checked_name(text, "engine").partition("@")
        if not at:
            return cls(adapter)
        try:
            return cls(checked_name(adapter, "engine"), str(Version(version)))
        except InvalidVersion as error:
            raise BadInput(
                f"{text!r} names no engine: {version!r} is not a version; allowed: NAME or NAME@VERSION, such as mujoco@3.2.0"
            ) from error

    def __str__(self) -> str:
        return self.adapter if self.version is None else f"{self.adapter}@{self.version}"


def adapter_of(engine: str) -> str:
    """Return the name of the adapter in the name of an engine, which may be any text, because results may come from anyone."""
    return engine.partition("@")[0]


def in_words(engine: str, version: str) -> str:
    """Return the name of an engine's adapter and a version, such as `mujoco 4.0.0`; a version in `engine` is dropped."""
    return f"{adapter_of(engine)} {version}"
