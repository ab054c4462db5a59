"""The case that a robot's file is by itself: the scene of the file, with its keyframe or zero, its gravity, and one second."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

from bodycheck.casefile.case import CaseFaults, Fault, parse
from bodycheck.casefile.content import Case
from bodycheck.casefile.mechanisms import model_reading, stored
from bodycheck.casefile.mechanisms.grammar import IGNORED, USED
from bodycheck.casefile.mechanisms.model import BASE_KEYS
from bodycheck.casefile.mechanisms.model_files import ModelFiles
from bodycheck.casefile.robots.named import case_name, short_name
from bodycheck.casefile.robots.reading import FIRST_IF_ANY, Choice, Ignored, Read, Used
from bodycheck.casefile.toml_text import in_line, key_in_text
from bodycheck.errors import BadInput
from bodycheck.reference.mechanisms.joint_types import JOINT_TYPES
from bodycheck.robots.elements import quoted

#: The gravitational acceleration (m/s^2) where a file states none, as MuJoCo has it.
GRAVITY = 9.81

#: The duration (s) and the number of samples.
DURATION, SAMPLES = 1.0, 101

#: What is taken over beside bodies and joints. Ranges of joints are no stops: the truths of large robots with stops take ten
#: times as long, and end before the duration of the case for many that fall. The notices say from when on ranges would act.
TAKEN_OVER: frozenset[Used] = frozenset({"actuators"})

#: What leaves out a feature of a robot's file that is given in the place of a case.
OPTION = "--ignore {}"


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
        files, choice, read = _read(path, packages, base, ignore)
        text = _text(path, choice, read, name)
        whole = stored.appended(text, model_reading.with_files(read, choice, path.name, files))
    except model_reading.StillActing as error:
        faults = (Fault(str(path), each.sentence(OPTION), ignore=each.word) for each in error.refusals)
        raise CaseFaults(tuple(faults)) from error
    except BadInput as error:
        raise CaseFaults(tuple(Fault(str(path), line) for line in str(error).splitlines())) from error
    except ValueError as error:
        raise CaseFaults((Fault(str(path), "has a number that is too large"),)) from error
    try:
        return parse(whole, str(path))
    except CaseFaults as error:  # the case has no file, so that lines and keys in it say nothing
        start = f"read {quoted(path.name)}; "
        raise CaseFaults(tuple(Fault(str(path), fault.message.removeprefix(start)) for fault in error.faults)) from error


def text_of_robot(
    path: Path,
    packages: Sequence[Path] = (),
    *,
    base: Literal["fixed", "free"] = "fixed",
    ignore: Iterable[Ignored] = (),
    name: str | None = None,
) -> str:
    """Return the text of a case file for a robot's file, with the initial states of all joints.

    Joints start at the first keyframe of the file, or at zero if it has none. The gravity is that of the file. Actuators that
    can be controllers are, and the others are left out.

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
    _, choice, read = _read(path, packages, base, ignore)
    return _text(path, choice, read, name)


def _read(
    path: Path, packages: Sequence[Path], base: Literal["fixed", "free"], ignore: Iterable[Ignored]
) -> tuple[ModelFiles, Choice, Read]:
    """Return the files of a robot, the way in which they are read, and the result, whose joints start at the first keyframe."""
    files = ModelFiles(path, packages, follow=True)
    left_out = frozenset(ignore)
    used = TAKEN_OVER - left_out
    choice = Choice(files, left_out | used, base, FIRST_IF_ANY, use=used)
    read = model_reading.read(files.texts[path.name], path.name, choice)
    x, y, z = read.gravity or (0.0, 0.0, 0.0)
    if not (x or y or z > 0):
        return files, choice, read
    files = ModelFiles(path, packages, follow=True)
    choice = replace(choice, files=files, upright=True)
    return files, choice, model_reading.read(files.texts[path.name], path.name, choice)


def _text(path: Path, choice: Choice, read: Read, name: str | None) -> str:
    """Return the text of a case file for the result of reading a robot's file."""
    words, used = [word for word in IGNORED if word in choice.ignore], [word for word in USED if word in choice.use]
    keyframe = _first_keyframe(read)
    lines = [
        "format = 2",
        f"name = {in_line(name or case_name(short_name(path)))}",
        f"title = {in_line(f'The robot {quoted(path.name)[1:-1]}')}",
        "",
        "[model]",
        f"file = {in_line(path.name)}",
        f"base = {in_line(choice.base)}  # fixed: as the file says; free: the root link floats",
        f"ignore = {in_line(words)}  # what is left out on purpose, of: {', '.join(IGNORED)}",
        f"use = {in_line(used)}  # what is taken over, of: {', '.join(USED)}; ignore leaves out what cannot be",
        *(["upright = true  # the world is turned so that the gravity of the file is along -z"] if choice.upright else []),
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


def _first_keyframe(read: Read) -> str | int | None:
    """Return the first keyframe of a file, by its name or its number; None if it has none."""
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
