"""The models that a parity study is about: files of robots as the user names them, read by bodycheck and copied for engines."""

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.casefile.case import load
from bodycheck.casefile.finding import is_case_file
from bodycheck.errors import BadInput
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.robots.model import RobotModel
from bodycheck.robots import elements, urdf
from bodycheck.robots.checked import checked
from bodycheck.robots.faults import FileFault
from bodycheck.robots.from_mechanism import robot_model
from bodycheck.robots.mjcf_text import mjcf
from bodycheck.robots.urdf_text import urdf as urdf_text
from bodycheck.running.robot_readings import Compile


@dataclass(frozen=True, eq=False)
class Robot:
    """A model, and the copy of its file that engines read.

    Attributes
    ----------
    name
        The name of its file without the ending, or the name of the case.
    path
        The path that the user gave.
    file
        The copy.
    model
        The model that the file describes; None if it describes none.
    faults
        The faults for which the specification of the format refuses the file.
    stated_gravity
        Whether the file states the gravity.
    removed
        The parts of the file that the copy lacks, in words.
    """

    name: str
    path: str
    file: RobotFile
    model: RobotModel | None
    faults: tuple[FileFault, ...]
    stated_gravity: bool
    removed: tuple[str, ...]


def named(paths: Sequence[Path]) -> dict[str, Path]:
    """Return the files by distinct names: the name without the ending, or a relative path where several files have one name.

    Raises `BadInput` for a path that is no file.
    """
    by_stem: dict[str, list[Path]] = {}
    for path in dict.fromkeys(paths):
        if not path.is_file():
            raise BadInput(f"{path}: {'is a folder' if path.is_dir() else 'there is no such file'}")
        by_stem.setdefault(re.sub(r"\.case$", "", path.stem), []).append(path)
    names: dict[Path, str] = {}
    for stem, same_stem in by_stem.items():
        shared = os.path.commonpath([path.resolve() for path in same_stem])
        names |= {path: stem if len(same_stem) == 1 else path.resolve().relative_to(shared).as_posix() for path in same_stem}
    return {names[path]: path for path in dict.fromkeys(paths)}


def robot(name: str, path: Path, packages: Sequence[Path], into: Path, compile_: Compile) -> Robot:
    """Return the model of a file, and its copy for engines in an empty folder.

    Parameters
    ----------
    name
        The name of the model.
    path
        The file: a URDF, an MJCF, or a case of format 2, which is written as a URDF or MJCF.
    packages
        The folders in which packages may be found.
    into
        The folder for the copy.
    compile_
        A function that returns the model of an MJCF.

    Raises
    ------
    BadInput
        If the file is no model.
    """
    if is_case_file(path):
        return _of_case(name, path, into)
    copy = checked(path, packages, into)
    if copy.file.format == "mjcf":
        compiled = compile_(copy.file.path)
        if isinstance(compiled, RobotModel):
            return Robot(name, str(path), copy.file, compiled, (), True, copy.removed)
        fault = FileFault("model", "", f"{path}: {compiled.reason}")
        return Robot(name, str(path), copy.file, None, (fault,), True, copy.removed)
    content = urdf.read(elements.content(path), path.name)
    return Robot(name, str(path), copy.file, content.model, content.faults, False, copy.removed)


def _of_case(name: str, path: Path, into: Path) -> Robot:
    case = load(path)
    if not isinstance(case.scene, Mechanism):
        raise BadInput(f"{path}: is a case of one body; a case of format 2, a URDF or an MJCF is needed")
    model = robot_model(case.scene, case.name)
    text, format = _text(model)
    copy = into / f"{case.name}.{format}"
    copy.write_text(text, "utf-8")
    return Robot(name, str(path), RobotFile(str(copy), format), model, (), format == "mjcf", ())


def _text(model: RobotModel) -> tuple[str, Literal["urdf", "mjcf"]]:
    """Return a model as a URDF, or as an MJCF if a URDF cannot express it: armature, springs and ball joints."""
    try:
        return urdf_text(model), "urdf"
    except BadInput:
        return mjcf(model), "mjcf"
