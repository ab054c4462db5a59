"""The case that a robot's file is by itself: the scene of the file, with its keyframe or zero, its gravity, and one second."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

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
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.robots.elements import quoted

#: The gravitational acceleration (m/s^2) where a file states none, as MuJoCo has it.
GRAVITY = 9.81

#: The duration (s) and the number of samples.
DURATION, SAMPLES = 1.0, 101

#: What is taken over beside bodies and joints, and what of it if there is no truth with stops.
TAKEN_OVER: frozenset[Used] = frozenset({"limits", "actuators"})
WITHOUT_STOPS: frozenset[Used] = frozenset({"actuators"})

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

    The ranges of joints are rigid stops if one of them is reached: otherwise they do not act, and engines without stops can run
    the case. Where the truth with stops ends, they act until the last instant before its end, and not at all if this is the
    first one.

    Raises `CaseFaults` if the file cannot be read, or is no case.
    """
    case = _case(path, packages, base, ignore, name, TAKEN_OVER)
    if not _has_stops(case):
        return case
    ended = _ended(case)
    if ended is None:
        return case if _reaches_stops(case) else _case(path, packages, base, ignore, name, WITHOUT_STOPS)
    return _case(path, packages, base, ignore, name, TAKEN_OVER if ended[0] else WITHOUT_STOPS, ended)


def text_for_a_case_file(path: Path, packages: Sequence[Path], ignore: Iterable[Ignored], name: str) -> str:
    """Return `text_of_robot` with stops if there is a truth with them until the end of the case, otherwise without stops."""
    case = _case(path, packages, "fixed", ignore, name, TAKEN_OVER)
    stops = not _has_stops(case) or _ended(case) is None
    return text_of_robot(path, packages, ignore=ignore, name=name, stops=stops)


def _has_stops(case: Case) -> bool:
    return isinstance(case.scene, Mechanism) and any(joint.stops for joint in case.scene.joints)


def _ended(case: Case) -> tuple[float, str] | None:
    """Return when and why the truth of a case with stops ends; see `end_of_stops`."""
    assert isinstance(case.scene, Mechanism)  # robots are mechanisms
    from bodycheck.reference.mechanisms.truth import end_of_stops  # the mechanics takes long to import

    return end_of_stops(case.scene, case.instants)


def _reaches_stops(case: Case) -> bool:
    """Return whether joints of a case whose truth does not end may reach their stops."""
    assert isinstance(case.scene, Mechanism)  # robots are mechanisms
    from bodycheck.reference.mechanisms.hybrid.acting import acting_stops

    return bool(acting_stops(case.scene, case.duration))


def _case(
    path: Path,
    packages: Sequence[Path],
    base: Literal["fixed", "free"],
    ignore: Iterable[Ignored],
    name: str | None,
    taken_over: frozenset[Used],
    ended: tuple[float, str] | None = None,
) -> Case:
    """Return the case of a robot's file. ended: the time (s) until which stops act, and why the truth with stops ends then."""
    try:
        files, choice, read = _read(path, packages, base, ignore, taken_over)
        text = _text(path, choice, read, name)
        table = model_reading.with_files(read, choice, path.name, files)
        whole = stored.appended(text, table if ended is None else table | _end_of_stops(table, *ended))
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


def _end_of_stops(table: dict[str, Any], time: float, reason: str) -> dict[str, Any]:
    """Return the keys of `[model.stored]` that say that stops act until a time (s), and why they do not act any longer."""
    sentence = f"From {time:.4g} s on this is the robot without its stops, since the truth with stops ends there: {reason}."
    if not time:
        sentence = f"The ranges of joints are no stops, since there is no truth with stops: {reason}."
    ends = {"notices": [sentence, *table.get("notices", [])]}
    return ends | {"stops_until": time} if time else ends


def text_of_robot(
    path: Path,
    packages: Sequence[Path] = (),
    *,
    base: Literal["fixed", "free"] = "fixed",
    ignore: Iterable[Ignored] = (),
    name: str | None = None,
    stops: bool = True,
) -> str:
    """Return the text of a case file for a robot's file, with the initial states of all joints.

    Joints start at the first keyframe of the file, or at zero if it has none. The gravity is that of the file. Actuators that
    can be controllers are, and the others are left out. Likewise ranges of joints are rigid stops.

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
    stops
        Whether the ranges of joints are rigid stops.

    Raises
    ------
    BadInput
        The file cannot be read as a case, with a line for each reason.
    """
    _, choice, read = _read(path, packages, base, ignore, TAKEN_OVER if stops else WITHOUT_STOPS)
    return _text(path, choice, read, name)


def _read(
    path: Path,
    packages: Sequence[Path],
    base: Literal["fixed", "free"],
    ignore: Iterable[Ignored],
    taken_over: frozenset[Used],
) -> tuple[ModelFiles, Choice, Read]:
    """Return the files of a robot, the way in which they are read, and the result, whose joints start at the first keyframe."""
    files = ModelFiles(path, packages, follow=True)
    left_out = frozenset(ignore)
    used = taken_over - left_out
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
