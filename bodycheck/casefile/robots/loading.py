"""Load cases: shipped cases, case files, and robots' files that are given in the place of cases."""

import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from bodycheck.casefile import case as case_files
from bodycheck.casefile.case import CaseFaults, Fault
from bodycheck.casefile.content import Case
from bodycheck.casefile.finding import is_case_file
from bodycheck.casefile.robots import direct
from bodycheck.casefile.robots.named import case_name, distinct, is_named_as_robot
from bodycheck.casefile.robots.reading import Ignored


def is_robot(argument: str | Path) -> bool:
    """Return whether an argument is the path of a robot's file, not of a case file, and not the name of a shipped case."""
    return is_named_as_robot(argument) and not is_case_file(argument) and str(argument) not in case_files.shipped()


def names(arguments: Sequence[str]) -> Mapping[str, str]:
    """Return the names of the cases of those arguments that are robots' files, each with a name of its own."""
    robots = {Path(argument): argument for argument in arguments if is_robot(argument)}
    return {robots[path]: name for path, name in distinct(list(robots), case_name).items()}


def load(case: str | Path, *, packages: Sequence[Path] = (), ignore: Sequence[Ignored] = (), name: str | None = None) -> Case:
    """Load a case: a shipped case, a case file, or the file of a robot.

    The scene of a robot's file is its own: its gravity, its first keyframe or zeros, and a duration of 1 s.

    Parameters
    ----------
    case
        The name of a shipped case, the path of a case file, or the path of a URDF or MJCF file.
    packages
        Folders of packages in which the files are found that a robot's file names, besides its own folder.
    ignore
        What is left out of a robot's file that is given in the place of a case; case files say so themselves.
    name
        The name of the case of a robot's file; by default, that of the file, or of its folder if many files have that name.

    Raises
    ------
    CaseFaults
        With every fault of the file; a file that cannot be read has one fault.
    TypeError
        The case is neither a text nor a path.
    """
    if isinstance(case, str | Path) and is_robot(case):
        path = Path(case)
        try:
            loaded = direct.scene_of_robot(path, packages, ignore=ignore, name=name)
        except CaseFaults as error:
            raise CaseFaults(tuple(_of_robot(path, packages, ignore, error.faults))) from error
    else:
        loaded = case_files.load(case, packages)
        path = Path(case).parent / loaded.robot.file if loaded.robot is not None else Path()
    if loaded.robot is None:
        return loaded
    return replace(loaded, robot=replace(loaded.robot, path=path, packages=tuple(packages)))


def _of_robot(path: Path, packages: Sequence[Path], ignore: Sequence[Ignored], faults: Sequence[Fault]) -> Iterator[Fault]:
    """Yield the faults of a robot's file, each with its line, and the command that runs it if they all can be avoided."""
    for fault in faults:
        in_file = re.match(rf"{re.escape(path.name)}:(\d+:)? ", fault.message)
        line = "" if in_file is None or in_file[1] is None else f":{in_file[1].rstrip(':')}"
        yield Fault(f"{path}{line}", fault.message if in_file is None else fault.message[in_file.end() :], ignore=fault.ignore)
    words = [fault.ignore for fault in faults if fault.ignore is not None]
    if len(words) == len(faults):
        command = ["bodycheck", "run", str(path), *options(packages, (*ignore, *words))]
        yield Fault(str(path), f"runs without them by: {shlex.join(command)}")


def options(packages: Sequence[Path], ignore: Sequence[str]) -> list[str]:
    """Return the options of the command line by which a robot's file is read."""
    named = [word for package in packages for word in ("--package-path", str(package))]
    return [*named, *(option for word in dict.fromkeys(ignore) for option in ("--ignore", word))]
