"""The machine and the versions of packages on which results depend.

Versions must be the same wherever chunks of an ensemble are carried out; times are comparable only between equal machines.
"""

import os
import platform
from collections.abc import Mapping
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from bodycheck.errors import BadInput

#: The packages that the numbers of results depend on; the header of results lists the installed packages.
PACKAGES = ("numpy", "scipy", "heyoka", "pyarrow")


class OtherVersion(BadInput):
    """A worker has another version of a package than the command; the text says which."""


def here() -> dict[str, str]:
    """Return the versions of bodycheck and of the installed packages among `PACKAGES`, by name."""
    return {"bodycheck": version("bodycheck"), **packages()}


def packages() -> dict[str, str]:
    """Return the versions of the installed packages among `PACKAGES`, by name."""
    return {name: version(name) for name in PACKAGES if find_spec(name)}


def check(wanted: Mapping[str, str], present: Mapping[str, str], where: str) -> None:
    """Raise `OtherVersion` unless versions are equal. where: the place of the present versions, such as "the worker A"."""
    for name in sorted(wanted.keys() | present.keys()):
        ours, theirs = wanted.get(name), present.get(name)
        if ours != theirs:
            raise OtherVersion(
                f"{where} has {_in_words(name, theirs)}, and this command has {_in_words(name, ours)}: the same members would "
                "get other numbers; install the same versions in both places"
            )


def _in_words(name: str, version: str | None) -> str:
    return f"no {name}" if version is None else f"{name} {version}"


def fingerprint() -> dict[str, str]:
    """Return a description of system, processor and Python; times are comparable only between equal fingerprints."""
    return {
        "system": platform.platform(),
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "python": platform.python_version(),
    }


def _processor() -> str:
    """Return the model of the processor, if the system reports it, and its architecture."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        lines = []
    fields = dict(line.replace("\t", "").split(": ", 1) for line in lines if ": " in line)
    named = [fields["model name"] if "model name" in fields else platform.processor()]  # the latter starts a process
    if {"cpu family", "model", "stepping"} <= fields.keys():
        named.append(f"family {fields['cpu family']} model {fields['model']} stepping {fields['stepping']}")
    return ", ".join([*filter(None, named), platform.machine()])
