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
from bodycheck.casefile.robots.named import distinct, is_named_as_robot, short_name
from bodycheck.casefile.robots.reading import Ignored
from bodycheck.casefile.values import MAX_NAME_LENGTH

#: The name of a case of a robot whose file and folder have no name with letters or digits.
NAMELESS = "robot"


def is_robot(argument: str | Path) -> bool:
    """Return whether an argument is the path of a robot's file, not of a case file, and not the name of a shipped case."""
    return is_named_as_robot(argument) and not is_case_file(argument) and str(argument) not in case_files.shipped()


def names(arguments: Sequence[str]) -> Mapping[str, str]:
    """Return the names of the cases of those arguments that are robots' files, each with a name of its own."""
    robots = {Path(argument): argument for argument in arguments if is_robot(argument)}
    return {robots[path]: name for path, name in distinct(list(robots), _case_name).items()}


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
            loaded = direct.scene_of_robot(path, packages, ignore=ignore, name=name or _case_name(short_name(path)))
        except CaseFaults as error:
            raise CaseFaults(tuple(_of_robot(path, error.faults))) from error
    else:
        loaded = case_files.load(case, packages)
        path = Path(case).parent / loaded.robot.file if loaded.robot is not None else Path()
    if loaded.robot is None:
        return loaded
    return replace(loaded, robot=replace(loaded.robot, path=path, packages=tuple(packages)))


#: The advice in a fault of a robot's file on the key of [model] by which a case leaves something out.
ADVICE = re.compile(r'ignore = \["(\w+)"\] leaves')


def _of_robot(path: Path, faults: Sequence[Fault]) -> Iterator[Fault]:
    """Yield the faults of a robot's file with advice on options, and the command that runs it if they all can be avoided."""
    words = [match[1] for fault in faults if (match := ADVICE.search(fault.message)) is not None]
    for fault in faults:
        message = ADVICE.sub(r"--ignore \1 leaves", fault.message)
        in_file = re.match(rf"{re.escape(path.name)}:(\d+:)? ", message)
        line = "" if in_file is None or in_file[1] is None else f":{in_file[1].rstrip(':')}"
        yield Fault(f"{path}{line}", message if in_file is None else message[in_file.end() :])
    if len(words) == len(faults):
        options = [option for word in dict.fromkeys(words) for option in ("--ignore", word)]
        yield Fault(str(path), f"runs without them by: {shlex.join(['bodycheck', 'run', str(path), *options])}")


def _case_name(text: str) -> str:
    """Return the name of a case, made from the name or the path of a robot's file."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:MAX_NAME_LENGTH].rstrip("-") or NAMELESS
