"""The models that a parity study is about: files of robots as the user names them, read by bodycheck and copied for engines."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.casefile.case import load
from bodycheck.casefile.finding import is_case_file
from bodycheck.errors import BadInput
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.physical import Unphysical, unphysical
from bodycheck.robots import elements, urdf
from bodycheck.robots.checked import checked
from bodycheck.robots.faults import FileFault
from bodycheck.robots.from_mechanism import robot_model
from bodycheck.robots.mjcf_text import mjcf
from bodycheck.robots.urdf_text import urdf as urdf_text
from bodycheck.running.robot_readings import Compile, Refused
from bodycheck.studies.parity.files import NamedFile
from bodycheck.studies.parity.limits import beyond, beyond_in_text, is_finite
from bodycheck.studies.parity.quantities import MODEL
from bodycheck.studies.parity.rows import Compared


@dataclass(frozen=True, eq=False)
class Robot:
    """A model, and the copy of its file that engines read.

    Attributes
    ----------
    name
        The name of its file, as in `NamedFile`.
    path
        The path that the user gave.
    file
        The copy.
    model
        The model that the file describes; None if it describes none, or one with a number that is not finite or too large.
    faults
        The faults for which the specification of the format refuses the file, and what is beyond the limits of models.
    impossible
        The values of the model that no body can have.
    stated_gravity
        Whether the file states the gravity.
    removed
        The parts of the file that the copy lacks, in words.
    unanswered
        The row about an MJCF file for which MuJoCo, which defines the format, has no answer; None for all other files.
    """

    name: str
    path: str
    file: RobotFile
    model: RobotModel | None
    faults: tuple[FileFault, ...]
    impossible: tuple[Unphysical, ...]
    stated_gravity: bool
    removed: tuple[str, ...]
    unanswered: Compared | None = None


@dataclass(frozen=True)
class Unreadable:
    """A file of which no model was made, and the reasons: it is not there, is no robot's file, or is beyond a limit."""

    name: str
    path: str
    reasons: tuple[str, ...]


def read(file: NamedFile, packages: Sequence[Path], into: Path, compile_: Compile) -> Robot | Unreadable:
    """Return the model of a file, and its copy for engines in an empty folder.

    Parameters
    ----------
    file
        The file: a URDF, an MJCF, or a case of format 2, which is written as a URDF or MJCF.
    packages
        The folders in which packages may be found.
    into
        The folder for the copy.
    compile_
        A function that returns the model of an MJCF.
    """
    try:
        return _robot(file, packages, into, compile_)
    except BadInput as error:
        return Unreadable(file.name, str(file.path), tuple(_with_path(line, file.path) for line in str(error).splitlines()))


def _with_path(reason: str, path: Path) -> str:
    """Return a reason with the path of a file in the place of its name."""
    return f"{path}{reason.removeprefix(path.name)}" if reason.startswith(f"{path.name}:") else reason


def _robot(file: NamedFile, packages: Sequence[Path], into: Path, compile_: Compile) -> Robot:
    """Return the model of a file. Raises `BadInput` if the file is no model."""
    path = file.path
    if file.refused:
        raise BadInput(f"{path}: {file.refused}")
    if not os.path.exists(path):
        raise BadInput(f"{path}: there is no such file")
    if is_case_file(path):
        return _of_case(file, into)
    copy = checked(path, packages, into)
    if copy.file.format == "mjcf":
        return _of_mjcf(file, copy.file, copy.removed, beyond_in_text(copy.root), compile_(copy.file))
    content = urdf.read(elements.content(path), path.name)
    return _of_model(file, copy.file, copy.removed, content.model, content.faults, False)


def _of_mjcf(
    file: NamedFile,
    copy: RobotFile,
    removed: tuple[str, ...],
    faults: tuple[FileFault, ...],
    compiled: RobotModel | Refused | Crashed | TimedOut,
) -> Robot:
    """Return the robot of an MJCF file with faults in its text, of which MuJoCo has made a model or has not."""
    if isinstance(compiled, RobotModel):
        robot = _of_model(file, copy, removed, compiled, faults, True)
        return replace(robot, model=None) if faults else robot
    text = f"{file.path}: {compiled.reason}"
    if isinstance(compiled, Refused):
        return _of_model(file, copy, removed, None, (*faults, FileFault("model", "", text)), True)
    row = Compared(compiled.status, None, MODEL, text)
    return replace(_of_model(file, copy, removed, None, faults, True), unanswered=row)


def _of_case(file: NamedFile, into: Path) -> Robot:
    case = load(file.path)
    if not isinstance(case.scene, Mechanism):
        raise BadInput(f"{file.path}: is a case of one body; a case of format 2, a URDF or an MJCF is needed")
    model = robot_model(case.scene, case.name)
    text, format = _text(model)
    copy = into / f"{case.name}.{format}"
    copy.write_text(text, "utf-8")
    return _of_model(file, RobotFile(str(copy), format), (), model, (), format == "mjcf")


def _of_model(
    file: NamedFile,
    copy: RobotFile,
    removed: tuple[str, ...],
    model: RobotModel | None,
    faults: Sequence[FileFault],
    stated_gravity: bool,
) -> Robot:
    """Return a robot; it has no model if a number of the model is not finite, or if the model is beyond the limits."""
    further = () if model is None else beyond(model, file.path.name)
    return Robot(
        file.name,
        str(file.path),
        copy,
        model if model is not None and not further and is_finite(model) else None,
        (*faults, *further),
        () if model is None else unphysical(model),
        stated_gravity,
        removed,
    )


def _text(model: RobotModel) -> tuple[str, Literal["urdf", "mjcf"]]:
    """Return a model as a URDF, or as an MJCF if a URDF cannot express it: armature, springs and ball joints."""
    try:
        return urdf_text(model), "urdf"
    except BadInput:
        return mjcf(model), "mjcf"
