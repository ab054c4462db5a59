"""What commands are given by name: cases and engines."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.errors import BadInput
from bodycheck.suggestion import did_you_mean

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Adapter
    from bodycheck.casefile.case import Case


def load_cases(names: tuple[str, ...]) -> "list[Case]":
    """The named cases, or all shipped ones. Raises `CaseFaults` with the faults of all files together."""
    from bodycheck.casefile.case import CaseFaults, Fault, load, shipped

    loaded: dict[str, Case] = {}
    faults: list[Fault] = []
    for name in dict.fromkeys(names or shipped()):
        try:
            case = load(name)
        except CaseFaults as error:
            faults += error.faults
            continue
        if case.name in loaded:
            faults.append(Fault(name, f"another case that was given has the name {case.name!r} too"))
        loaded[case.name] = case
    if faults:
        raise CaseFaults(tuple(faults))
    return list(loaded.values())


def load_engines(names: tuple[str, ...]) -> "tuple[dict[str, Adapter], dict[str, str]]":
    """The named adapters, or all, and why others cannot be used; a named one that is missing is bad usage."""
    from bodycheck.adapters import registry

    adapters: dict[str, Adapter] = {}
    missing: dict[str, str] = {}
    known = registry.names()
    for name in dict.fromkeys(names or known):
        check_engine(name)
        try:
            adapters[name] = registry.load(name)
        except registry.EngineMissing as error:
            if names:
                raise BadInput(str(error)) from error
            missing[name] = str(error)
            print(f"bodycheck: {error}; going on without it", file=sys.stderr)
    if not adapters:
        raise BadInput("no engine can be used")
    return adapters, missing


def check_engine(name: str) -> None:
    """Raises `BadInput` for an engine that has no adapter; whether it is installed is not asked."""
    from bodycheck.adapters import registry

    if name not in (known := registry.names()):
        raise BadInput(f"there is no engine {name!r}; there are: {', '.join(known)}{did_you_mean(name, known)}")


def files_of(cases: "list[Case]", names: tuple[str, ...]) -> dict[str, Path]:
    """The files of those loaded cases that were named by one, by the case's name."""
    from bodycheck.casefile.case import shipped

    given = zip(cases, dict.fromkeys(names or shipped()), strict=True)
    return {case.name: Path(name) for case, name in given if name not in shipped()}


def check_writable(option: str, path: Path | None) -> None:
    """Raises `BadInput` where an option names a file that cannot be there: better before a long run than after it."""
    if path is not None and (path.is_dir() or not path.parent.is_dir()):
        raise BadInput(f"{option} {path}: {'is a folder' if path.is_dir() else f'there is no folder {path.parent}'}")


def check_has_folder(figures: tuple[str, ...], out: Path | None) -> None:
    """Raises `BadInput` where plots are asked for and there is no folder to write them into."""
    if figures and out is None:
        raise BadInput(f"--figures {figures[0]}: needs --out, a folder to write into")


def folder_for(folders: tuple[Path, ...], out: Path | None) -> Path:
    """Where a report of the results in some folders goes. Raises `BadInput`."""
    if not folders:
        raise BadInput("report: give at least one folder of results")
    if out is None and len(folders) > 1:
        raise BadInput("report: give --out, a folder for what is made of several folders")
    if out is not None and len(folders) > 1 and out.resolve() in {folder.resolve() for folder in folders}:
        raise BadInput(f"--out {out}: is one of the folders to be compared, and keeps its own report")
    return folders[0] if out is None else out


def make_folder(option: str, path: Path | None) -> None:
    """Make the folder that an option names, where it names one. Raises `BadInput` where it cannot be."""
    try:
        if path is not None:
            path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput(f"{option} {path}: no folder can be made there: {error}") from error


def processes(jobs: int | None) -> int:
    """How many processes to use; as many as there are processors where none are given. Raises `BadInput`."""
    if jobs is not None and jobs < 1:
        raise BadInput(f"--jobs {jobs}: must be at least 1")
    return jobs or os.cpu_count() or 1
