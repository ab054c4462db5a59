"""The case of a robot's file that is given in the place of a case file: its own scene."""

import json
from collections.abc import Sequence
from pathlib import Path

from bodycheck.casefile.case import Case, loaded
from bodycheck.casefile.robots.reading import Ignored


def text_of_robot(path: Path, ignore: Sequence[Ignored], name: str) -> str:
    """Return the text of the case file of a robot's file."""
    lines = ["format = 2", f"name = {json.dumps(name)}", f"title = {json.dumps(path.name)}", "", "[model]"]
    lines += [f"file = {json.dumps(path.name)}", *([f"ignore = {json.dumps(list(ignore))}"] if ignore else [])]
    return "\n".join([*lines, "", "[scene]", "gravity = 9.81", "", "[run]", "duration = 1.0", "samples = 101", ""])


def scene_of_robot(path: Path, packages: Sequence[Path], ignore: Sequence[Ignored], name: str) -> Case:
    """Return the case of a robot's file."""
    return loaded(text_of_robot(path, ignore, name), str(path))
