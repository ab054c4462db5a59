"""Read a robot's file, URDF or MJCF, for a case, and return what a case stores of it: numbers, notices, digests and texts."""

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bodycheck.casefile.mechanisms import model_sentences as sentences
from bodycheck.casefile.mechanisms.grammar import MAX_BODIES, WORLD
from bodycheck.casefile.mechanisms.model_files import ModelFiles, NoFiles
from bodycheck.casefile.robot_notes import JointRange, TendonRange
from bodycheck.casefile.robots import stops
from bodycheck.casefile.robots.mjcf import tree as mjcf_tree
from bodycheck.casefile.robots.reading import Choice, Read
from bodycheck.casefile.robots.urdf import tree as urdf_tree
from bodycheck.errors import BadInput
from bodycheck.robots import elements

#: The functions that read a file, by the tag of its root.
READERS = {"robot": urdf_tree.tree, "mujoco": mjcf_tree.tree}


class StillActing(BadInput):
    """Features of a file that act from the beginning of a motion, and are not ignored; the text has a line for each."""

    def __init__(self, refusals: Sequence[sentences.Refusal]) -> None:
        super().__init__("\n".join(refusal.sentence() for refusal in refusals))
        self.refusals = refusals


def read(text: str, file: str, choice: Choice) -> Read:
    """Return the result of reading the text of a robot's file.

    Raises `BadInput` with a line for each fault of the file, and `StillActing` for features of the file that act from the
    beginning of a motion, but that a case can neither state nor ignores.
    """
    root = elements.parsed(text.encode("utf-8", "replace"), file)
    if root.tag not in READERS:
        elements.refuse_root(root)
    result = READERS[root.tag](root, WORLD, choice)
    if "limits" in choice.use:
        result = stops.with_stops(result)
    if refusals := list(sentences.refusals(result, choice.ignore)):
        raise StillActing(refusals)
    if not result.tables["bodies"]:
        advice = '; base = "free" lets it move' if result.welded else ""
        raise BadInput(f"{root.file}: has no body with a mass besides the root, which is the world{advice}")
    if len(result.tables["bodies"]) > MAX_BODIES:
        raise BadInput(f"{root.file}: has {len(result.tables['bodies'])} bodies; allowed: at most {MAX_BODIES}")
    return result


def stored(result: Read, choice: Choice, file: str) -> dict[str, Any]:
    """Return the table `[model.stored]` for the result of reading a file, without the files that were read."""
    limits = () if "limits" in choice.ignore - choice.use else result.ranges
    table = {
        "base": result.base,
        "timestep": result.timestep,
        "without": list(sentences.without(result, choice.ignore - choice.use)),
        "notices": list(sentences.notices(result, choice, file)),
        "touching": result.touching and "contacts" not in choice.ignore,
        "ranges": [_range(each) for each in limits if isinstance(each, JointRange)],
        "tendons": [_range(each) for each in limits if isinstance(each, TendonRange)],
        **{name: result.tables.get(name, []) for name in ("bodies", "joints", "loops")},
        "controllers": list(result.controllers),
    }
    return {name: value for name, value in table.items() if value not in (None, [], False)}


def _range(limits: JointRange | TendonRange) -> dict[str, Any]:
    table = {name: value for name, value in vars(limits).items() if value is not None}
    return table | {"terms": [list(term) for term in limits.terms]} if isinstance(limits, TendonRange) else table


def stored_of_file(path: Path, packages: Sequence[Path], follow: bool, **keys: Any) -> dict[str, Any]:
    """Return the table `[model.stored]` for a robot's file.

    Parameters
    ----------
    path
        The file.
    packages
        The folders of packages, which the user named.
    follow
        Whether the path itself may be a symbolic link.
    keys
        The fields of `Choice` except `files`.

    Raises
    ------
    BadInput
        The file cannot be read; see `read`.
    """
    files = ModelFiles(path, packages, follow)
    choice = Choice(files, **keys)
    return with_files(read(files.texts[path.name], path.name, choice), choice, path.name, files)


def with_files(result: Read, choice: Choice, file: str, files: ModelFiles) -> dict[str, Any]:
    """Return the table `[model.stored]` for the result of reading a file, with the files that were read."""
    return {
        "files": [{"name": name, "sha256": digest} for name, digest in files.digests.items()],
        **stored(result, choice, file),
        "texts": [[name, text] for name, text in files.texts.items()],
    }


@functools.lru_cache(maxsize=2)
def stored_of_text(text: str, file: str, **keys: Any) -> dict[str, Any]:
    """Return the table `[model.stored]` for the text of a robot's file, which names no other file; see `stored_of_file`.

    Callers must not change the result.
    """
    choice = Choice(NoFiles(), **keys)
    return stored(read(text, file, choice), choice, file)
