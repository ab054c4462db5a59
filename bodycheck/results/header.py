"""The header of results: the versions, the machine and the command that they were made with."""

from pathlib import Path
from typing import Annotated, NotRequired, TypedDict, get_type_hints

from bodycheck.casefile.content import Case


class Header(TypedDict):
    """The origin of a set of results. The descriptions of its entries are also in the JSON Schema of results.json."""

    bodycheck: Annotated[str, "Version of bodycheck."]
    command: Annotated[list[str], "Words of the command that made the results."]
    started: Annotated[str, "Date and time of the start, with the offset of the time zone."]
    machine: Annotated[dict[str, str], "Operating system, processor, number of cores and version of Python."]
    packages: Annotated[dict[str, str], "Versions of packages that the numbers depend on."]
    engines: Annotated[dict[str, str], "Versions of the engines."]
    missing: Annotated[dict[str, str], "Engines that could not be used, with the reason."]
    environments: Annotated[
        dict[str, dict[str, str]],
        "For each engine in an environment of its own, its packages, with the SHA-256 of each one's list of files and hashes.",
    ]
    demonstrations: Annotated[
        dict[str, dict[str, str]],
        "For each engine, the integrators that its adapter offers to demonstrate something, and what.",
    ]
    precisions: Annotated[dict[str, str], "For each engine, the precision of its arithmetic: float64 or float32."]
    defaults: Annotated[
        dict[str, dict[str, str]],
        "For each engine, what it chooses where a user does not: integrator, timestep and tolerance, as far as it has them.",
    ]
    soft: Annotated[
        dict[str, dict[str, str]],
        "For each engine, the requirements of mechanisms that it models by springs and dampers, with the options of these.",
    ]
    without_method: Annotated[
        dict[str, dict[str, str]],
        "For each engine, the cases for which it has none of the methods that were asked for, with why.",
    ]
    robots: Annotated[
        dict[str, list[str]],
        "For each case with a robot's file, sentences on what was left out of it, and on what does not act or acts later.",
    ]
    departures: Annotated[
        dict[str, float],
        "For each case with a robot's file, the last instant (s) at which neither limits nor contacts of the file have acted. "
        "Cases in which they do not act at all are missing.",
    ]


#: The entries that results of earlier versions lack.
LATER: dict[str, dict[str, dict[str, str]]] = {
    name: {}
    for name in ("environments", "demonstrations", "precisions", "defaults", "soft", "without_method", "robots", "departures")
}


class StoredCase(TypedDict):
    """A case in the header of a results folder: its name, and the text of its file when it was run.

    file: the path that was given; empty for a shipped case. Results of earlier versions lack it. packages: the folders of
    packages that the user named, if any, in which a robot's file finds others.
    """

    name: str
    text: str
    file: NotRequired[str]
    packages: NotRequired[list[str]]


def stored_case(case: Case, file: Path | None) -> StoredCase:
    """Return a case as it is stored. file: the path that was given; None for a shipped case."""
    stored = StoredCase(name=case.name, text=case.text, file=_shown(file))
    packages = [] if case.robot is None else [shown for folder in case.robot.packages if (shown := _shown(folder))]
    return StoredCase(**stored, packages=packages) if packages else stored


def _shown(file: Path | None) -> str:
    """Return a path as text; empty if there is none, or if it cannot be printed."""
    return str(file) if file is not None and str(file).isprintable() else ""


class StoredUnchecked(TypedDict):
    """An expectation that no run could check; see `bodycheck.results.unchecked`."""

    case: str
    engine: str
    integrator: str
    timestep: float
    reason: str
    tolerated: str


class StoredHeader(Header):
    """The header of a results folder, with the cases, the unchecked expectations, and the revisions of figures.

    Results of earlier versions lack the latter two.
    """

    cases: list[StoredCase]
    unchecked: NotRequired[list[StoredUnchecked]]
    revisions: NotRequired[dict[str, int]]


#: The entries of a header, each with a description.
DESCRIPTIONS: dict[str, str] = {
    name: hint.__metadata__[0] for name, hint in get_type_hints(Header, include_extras=True).items()
}
