"""The table `[model]` of a case file: a robot model, URDF or MJCF, instead of `[[bodies]]` and `[[joints]]`.

The model is a regular file in the folder of the case file. When the case is loaded, the text of the model is appended to the
text of the case as `[model.stored]`, so that the text of a case always contains its mechanism.
"""

import copy
import functools
import json
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

from bodycheck.casefile.content import Case
from bodycheck.casefile.formats import is_mechanism
from bodycheck.casefile.mechanisms.grammar import MAX_BODIES, WORLD
from bodycheck.casefile.raw_values import mapping
from bodycheck.casefile.robots import mjcf_tree, urdf
from bodycheck.casefile.robots.reading import Choice
from bodycheck.casefile.robots.tables import Tables
from bodycheck.casefile.toml_positions import Path
from bodycheck.errors import BadInput
from bodycheck.files import reading
from bodycheck.robots import elements
from bodycheck.robots.named_files import NotFound
from bodycheck.suggestion import did_you_mean

#: The mark between the text of a case file and the text of its model.
MARK = "\n# The text of the model, as it was read beside this file.\n[model.stored]\ntext = "

#: The name of a file, without a folder.
FILE_NAME = re.compile(r"(?!\.)[^/\\:\0\r\n]{1,100}")

#: The path of the key with the name of the model.
FILE: Path = ("model", "file")

#: The character that JSON writes unescaped, but TOML allows only escaped.
DELETE = "\x7f"


@dataclass(frozen=True)
class Expanded:
    """The document of a case file with the bodies and joints of its model.

    Attributes
    ----------
    document
        The document with the tables of the model; the document of the file if it has no model, or its model cannot be read.
    faults
        The faults of the table and of the model, as pairs of path and message.
    from_model
        Whether the bodies and joints come from a model.
    timestep
        The time step (s) that the file of the model states; None if it states none.
    """

    document: dict[str, Any]
    faults: tuple[tuple[Path, str], ...] = ()
    from_model: bool = False
    timestep: float | None = None

    def in_the_file(self, path: Path, message: str) -> tuple[Path, str]:
        """Return the path in the case file, and the message, of a fault in the document."""
        match path:
            case ("joints", int(index), "initial", *rest) if self.from_model:
                return ("initial", "joints", self.document["joints"][index]["name"], *rest), message
            case (("bodies" | "joints") as tables, int(index), *rest) if self.from_model:
                name = self.document[tables][index]["name"]
                key = ".".join(str(part + 1 if isinstance(part, int) else part) for part in rest)
                return (
                    FILE,
                    f"{tables.replace('ies', 'y').removesuffix('s')} {elements.quoted(name)}: {key and key + ': '}{message}",
                )
            case (("bodies" | "joints"), *_) if self.from_model:
                return FILE, message
        return path, message


def with_model(text: str, document: dict[str, Any], folder: FilePath) -> tuple[str, str | None]:
    """Return the text of a case file with the text of its model appended, and None; or the text alone, and a reason.

    The reason says why the model was not read; it is None if the file names no model, or has its text.

    document: the document of the text. folder: the folder of the case file.
    """
    table = mapping(document.get("model"))
    name = table.get("file")
    if not is_mechanism(document) or "stored" in table or not isinstance(name, str):
        return text, None
    if not FILE_NAME.fullmatch(name):
        return text, "must be the name of a file in the folder of this one"
    try:
        tomllib.loads(f'{text}{MARK}""')
    except tomllib.TOMLDecodeError:  # after an inline table
        return text, "is not in a table of its own; write it below a line [model]"
    try:
        content = reading.content(folder / name, elements.MAX_BYTES).decode("utf-8")
    except reading.Refused as error:
        return text, error.reason
    except UnicodeDecodeError:
        return text, "cannot be read: it is not UTF-8"
    except OSError as error:
        return text, f"cannot be read: {error.strerror}"
    return text + MARK + json.dumps(content, ensure_ascii=False).replace(DELETE, "\\u007f") + "\n", None


def split(text: str) -> tuple[str, dict[str, Any] | None]:
    """Return the text of a case file as it was read, and the table of the model appended to it (None without model)."""
    text_of_file, mark, stored = text.partition(MARK)
    if not mark:
        return text, None
    try:
        return text_of_file, {"text": json.loads(stored)}
    except ValueError:
        return text, None


def file_text(case: Case) -> str:
    """Return the text of the file of a case alone, without the text of its model."""
    return split(case.text)[0]


def expanded(document: dict[str, Any], refused: str | None = None) -> Expanded:
    """Return the document of a case file with the bodies and joints of its model, whose text is stored in it.

    The document may have other faults. refused: why the text of the model is missing, if known.
    """
    table = mapping(document.get("model"))
    if "model" not in document or not is_mechanism(document):
        return Expanded(document)
    both = tuple(((name,), "[model] is given too; give only one") for name in ("bodies", "joints") if name in document)
    file, text = table.get("file"), mapping(table.get("stored")).get("text")
    if both or not isinstance(file, str):
        return Expanded(document, both)
    if not isinstance(text, str):
        return Expanded(document, ((FILE, refused or "is read only where a case file is loaded from its folder"),))
    try:
        tables, timestep = copy.deepcopy(_read(text, file))
    except BadInput as error:
        return Expanded(document, ((FILE, str(error)),))
    return _started(document, tables, timestep)


@functools.lru_cache(maxsize=2)
def _read(text: str, file: str) -> tuple[Tables, float | None]:
    """Return the tables of the bodies and joints of a model, and its time step (s); None if it states none.

    Raises `BadInput` if they cannot be read.
    """
    root = elements.parsed(text.encode("utf-8", "replace"), file)
    if root.tag not in ("robot", "mujoco"):
        elements.refuse_root(root)
    timestep = None
    if root.tag == "mujoco":
        read = mjcf_tree.tree(root, WORLD, Choice(_NoFiles()))
        if acting := [feature for feature in read.features if feature.acts]:
            raise BadInput("\n".join(f"{feature.lines[0]}: {feature.noun[1]} {feature.text}" for feature in acting))
        tables, timestep = read.tables, read.timestep
    else:
        tables = urdf.tree(root, WORLD)
    if not tables["bodies"]:
        raise BadInput(f"{root.file}: has no body with a mass besides the root, which is the world")
    if len(tables["bodies"]) > MAX_BODIES:
        raise BadInput(f"{root.file}: has {len(tables['bodies'])} bodies; allowed: at most {MAX_BODIES}")
    return tables, timestep


class _NoFiles:
    """The files of a model of which only the text is at hand."""

    def text(self, name: str, near: str) -> tuple[str, str]:
        raise NotFound("is not there")

    def content(self, name: str) -> bytes:
        raise NotFound("is not there")


def _started(document: dict[str, Any], tables: Tables, timestep: float | None) -> Expanded:
    """Return a document with the tables of a model, whose joints get the initial states that the document states."""
    initial = mapping(mapping(document.get("initial")).get("joints"))
    joints = {joint["name"]: joint for joint in tables["joints"]}
    for name, start in initial.items():
        if name in joints:
            joints[name]["initial"] = mapping(joints[name].get("initial")) | copy.deepcopy(mapping(start))
    return Expanded(
        {**document, "bodies": tables["bodies"], "joints": tables["joints"]},
        tuple(_unknown(initial, list(joints))),
        from_model=True,
        timestep=timestep,
    )


def _unknown(initial: Mapping[str, Any], joints: list[str]) -> Iterator[tuple[Path, str]]:
    for name, start in initial.items():
        if name not in joints:
            listed = ", ".join(joints[:20]) + (", …" if len(joints) > 20 else "")
            yield ("initial", "joints", name), f"the model has no such joint; allowed: {listed}{did_you_mean(name, joints)}"
        elif not isinstance(start, dict):
            yield ("initial", "joints", name), "should be a table"


def standalone(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the document of a case file with tables of bodies and joints instead of a model, if the model can be read."""
    expansion = expanded(dict(document))
    if not expansion.from_model:
        return expansion.document
    return {name: value for name, value in expansion.document.items() if name not in ("model", "initial")}
