"""The releases of engines that package sources offer, by which the versions in submissions are checked.

`released.toml` lists them, so that a site is made without a network. It is renewed by:

    python submissions/renew.py --releases
"""

import tomllib
from functools import cache
from importlib import resources
from typing import Any

from packaging.version import InvalidVersion, Version

from bodycheck.adapters import registry
from bodycheck.environments import installation

#: The file with the day of the lists, and the versions by the names of engines.
FILE = "released.toml"


def fault(engine: str, version: str) -> str | None:
    """Return why the version of an engine cannot be shown; None if it is in the list of its releases.

    An engine without a list, such as a package of somebody's own, has no fault.
    """
    listed = _lists()["releases"].get(engine)
    if listed is None:
        return None
    try:
        known = Version(version) in {Version(one) for one in listed}
    except InvalidVersion:
        known = False
    return None if known else f"no list of releases has {engine} {version[:60]!r}; the list is of {_lists()['day']}"


def listing(day: str) -> str:
    """Return the content of the file, for a day (YYYY-MM-DD), from the package sources.

    Releases that the present file has and the sources lack are kept, since older results have them. Raises
    `installation.InstallationFailed` if a source cannot be reached.
    """
    lines = ["# The releases of engines that package sources offer; renewed by: python submissions/renew.py --releases"]
    lines += [f'day = "{day}"', "", "[releases]"]
    for engine in registry.names():
        if (source := registry.known_installation(engine)) is not None:
            offered = {*installation.versions(source.distribution), *_lists()["releases"].get(engine, ())}
            in_order = sorted(offered, key=Version)
            lines += [f"{engine} = [", *(f'    "{version}",' for version in in_order), "]"]
    return "\n".join(lines) + "\n"


@cache
def _lists() -> dict[str, Any]:
    """Return the content of the file."""
    text = resources.files("bodycheck.site").joinpath(FILE).read_text("utf-8")
    return tomllib.loads(text)
