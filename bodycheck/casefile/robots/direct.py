"""The case that a robot's file is by itself: the scene of the file, with its keyframe or zero, its gravity, and one second."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

from bodycheck.casefile.case import CaseFaults, Fault, loaded
from bodycheck.casefile.content import Case
from bodycheck.casefile.mechanisms import model_reading
from bodycheck.casefile.mechanisms.grammar import IGNORED
from bodycheck.casefile.mechanisms.model import BASE_KEYS
from bodycheck.casefile.mechanisms.model_files import ModelFiles
from bodycheck.casefile.robots.reading import Choice, Ignored, Read
from bodycheck.casefile.toml_text import in_line, key_in_text
from bodycheck.casefile.values import MAX_NAME_LENGTH
from bodycheck.errors import BadInput
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.robots.elements import quoted

#: The gravitational acceleration (m/s^2) where a file states none, as MuJoCo has it.
GRAVITY = 9.81

#: The duration (s) and the number of samples.
DURATION, SAMPLES = 1.0, 101

#: The stems of files that name no robot: the folder of such a file names it.
COMMON_STEMS = frozenset({"main", "model", "robot", "scene"})


def scene_of_robot(
    path: Path,
    packages: Sequence[Path] = (),
    *,
    base: Literal["fixed", "free"] = "fixed",
    ignore: Iterable[Ignored] = (),
    name: str | None = None,
) -> Case:
    """Return the case that a robot's file is by itself; see `text_of_robot`.

    Raises `CaseFaults` if the file cannot be read, or is no case.
    """
    try:
        text = text_of_robot(path, packages, base=base, ignore=ignore, name=name)
    except BadInput as error:
        raise CaseFaults(tuple(Fault(str(path), line) for line in str(error).splitlines())) from error
    try:
        return loaded(text, str(path), path.parent, packages, follow=True)
    except CaseFaults as error:  # the case has no file, so that lines and keys in it say nothing
        read = f"read {quoted(path.name)}; "
        raise CaseFaults(tuple(Fault(str(path), fault.message.removeprefix(read)) for fault in error.faults)) from error


def text_of_robot(
    path: Path,
    packages: Sequence[Path] = (),
    *,
    base: Literal["fixed", "free"] = "fixed",
    ignore: Iterable[Ignored] = (),
    name: str | None = None,
) -> str:
    """Return the text of a case file for a robot's file, with the initial states of all joints.

    Joints start at the first keyframe of the file, or at zero if it has none. The gravity is that of the file.

    Parameters
    ----------
    path
        The file, URDF or MJCF, beside which the case file belongs.
    packages
        Folders that the user named, in which the file may name files.
    base
        "free" if the root link floats, "fixed" if it is as the file says.
    ignore
        What is left out on purpose.
    name
        The name of the case; None for a name made from that of the file.

    Raises
    ------
    BadInput
        The file cannot be read as a case, with a line for each reason.
    """
    words: tuple[Ignored, ...] = tuple(word for word in IGNORED if word in set(ignore))
    read, keyframe, upright = _read(path, packages, base, frozenset(words))
    lines = [
        "format = 2",
        f"name = {in_line(name or case_name(path))}",
        f"title = {in_line(f'The robot {quoted(path.name)[1:-1]}')}",
        "",
        "[model]",
        f"file = {in_line(path.name)}",
        f"base = {in_line(base)}  # fixed: as the file says; free: the root link floats",
        f"ignore = {in_line(list(words))}  # what is left out on purpose, of: {', '.join(IGNORED)}",
        *(["upright = true  # the world is turned so that the gravity of the file is along -z"] if upright else []),
        *([] if keyframe is None else [f"keyframe = {in_line(keyframe)}  # the states below replace its states"]),
        *_starts(read),
        "",
        "[scene]",
        f"gravity = {in_line(_gravity(read))}  # m/s^2, along -z",
        "",
        "[run]",
        f"duration = {in_line(DURATION)}  # s",
        f"samples = {SAMPLES}",
    ]
    return "\n".join(lines) + "\n"


def case_name(path: Path) -> str:
    """Return the name of the case of a robot's file: its stem, or its folder if many robots have files of this name."""
    names = [path.stem, path.resolve().parent.name]
    for name in reversed(names) if path.stem.lower() in COMMON_STEMS else names:
        if allowed := re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")[:MAX_NAME_LENGTH]:
            return allowed
    return "robot"


def _read(
    path: Path, packages: Sequence[Path], base: Literal["fixed", "free"], ignore: frozenset[Ignored]
) -> tuple[Read, str | int | None, bool]:
    """Return the result of reading a file, its first keyframe by name or number, None if it has none, and `upright`."""
    files = ModelFiles(path, packages, follow=True)
    text = files.texts[path.name]
    read = model_reading.read(text, path.name, Choice(files, ignore, base))
    x, y, z = read.gravity or (0.0, 0.0, 0.0)
    upright, keyframe = bool(x or y or z > 0), _first_keyframe(read)
    if not upright and keyframe is None:
        return read, None, False
    again = ModelFiles(path, packages, follow=True)
    return model_reading.read(text, path.name, Choice(again, ignore, base, keyframe, upright)), keyframe, upright


def _first_keyframe(read: Read) -> str | int | None:
    """Return the first keyframe of a file, by its name or number; None if it has none."""
    if not read.keyframes:
        return None
    first = read.keyframes[0]
    return first if first and read.keyframes.count(first) == 1 else 0


def _starts(read: Read) -> list[str]:
    """Return the lines of the tables of initial states: of the free base, and of the joints that move by themselves."""
    lines: list[str] = []
    for joint in read.tables["joints"]:
        keys = JOINT_TYPES[joint["type"]].start
        if keys is None or "mimic" in joint:
            continue
        start = {key.name: key.default for key in keys.keys} | joint.get("initial", {})
        header = f"[initial.joints.{key_in_text(joint['name'])}]"
        if joint["name"] == read.base:
            start = {name: start[key] for key, name in BASE_KEYS.items()}
            header = "[initial.base]  # of the origin of the root link; angular_velocity along its axes"
        lines += ["", header, *(f"{name} = {in_line(_listed(value))}" for name, value in start.items())]
    return lines


def _listed(value: float | Sequence[float]) -> float | list[float]:
    return value if isinstance(value, int | float) else list(value)


def _gravity(read: Read) -> float:
    """Return the gravitational acceleration of a file (m/s^2), which is along -z in the world of the case."""
    return GRAVITY if read.gravity is None else abs(read.gravity[2])
