"""The versions of what the rows of results depend on, which must be the same wherever chunks of an ensemble are carried out."""

from collections.abc import Mapping
from importlib.metadata import version
from importlib.util import find_spec

from bodycheck.errors import BadInput

#: The packages that the numbers of results depend on; those that are installed are in their header.
PACKAGES = ("numpy", "scipy", "heyoka", "pyarrow")


class OtherVersion(BadInput):
    """A worker has another version of something than the command; the text says which."""


def here() -> dict[str, str]:
    """Return the versions of bodycheck and of those packages that are installed here, by name."""
    return {"bodycheck": version("bodycheck"), **packages()}


def packages() -> dict[str, str]:
    """Return the versions of those packages that are installed here, by name."""
    return {name: version(name) for name in PACKAGES if find_spec(name)}


def check(wanted: Mapping[str, str], found: Mapping[str, str], where: str) -> None:
    """Raise `OtherVersion` unless versions are equal. where: the place of those that were found, such as "the worker A"."""
    for name in sorted(wanted.keys() | found.keys()):
        ours, theirs = wanted.get(name), found.get(name)
        if ours != theirs:
            raise OtherVersion(
                f"{where} has {_told(name, theirs)}, and this command has {_told(name, ours)}: the same members would get "
                "other numbers; install the same versions in both places"
            )


def _told(name: str, found: str | None) -> str:
    return f"no {name}" if found is None else f"{name} {found}"
