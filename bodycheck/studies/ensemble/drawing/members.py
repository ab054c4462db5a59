"""The members of an ensemble: the source of their numbers, and the scenes, cases and files that are made of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.casefile.case import Case, CaseFaults, parse_stored
from bodycheck.casefile.distributions import Ensemble, Key
from bodycheck.casefile.drawn import member_document, outside, wholes
from bodycheck.casefile.key_paths import ATTITUDE, Unknown, find, keys
from bodycheck.casefile.mechanisms.stored import loads
from bodycheck.casefile.toml_text import written
from bodycheck.casefile.values import MAX_MEMBERS
from bodycheck.errors import BadInput
from bodycheck.reference.scene import Scene
from bodycheck.reference.scenes import Scenes, variable, vary
from bodycheck.reference.trajectory import Array
from bodycheck.studies.ensemble.drawing import draws, tables

#: The keys whose values may be arrays for many scenes, with the names of these arrays.
QUICK = {
    "body.mass": "mass",
    "body.semi_axes": "semi_axes",
    "body.radius": "radius",
    "body.half_length": "half_length",
    "body.inertia": "moments",
    "initial.position": "position",
    ATTITUDE: "quaternion",
    "initial.velocity": "velocity",
    "initial.angular_velocity": "angular_velocity",
    "scene.gravity": "gravity",
}

#: The number of members whose numbers are checked at once.
PORTION = 100_000

#: The number of members that are checked before any is run, which takes some seconds. Others are checked when they are made.
CHECKED = 1_000_000


@dataclass(frozen=True)
class Source:
    """The source of the numbers of the members: they are drawn, or are rows of a table.

    Attributes
    ----------
    size
        The number of members.
    origin
        The table [ensemble] of the case by which they are drawn, or the table of the user.
    names
        The paths of all single numbers that differ, such as "initial.velocity.0", in the order of `values`.
    vectors
        The vectors of which a table has all components as columns.
    """

    size: int
    origin: Ensemble | tables.Table
    names: tuple[str, ...]
    vectors: tuple[str, ...] = ()

    def values(self, first: int, count: int) -> dict[str, Array]:
        """Return the numbers of consecutive members as arrays (count,) and vectors as arrays (count, k), by key paths.

        Raises `BadInput` if a table cannot be read, and `ValueError` for members that do not exist.
        """
        if not 0 <= first <= first + count <= self.size:
            raise ValueError(f"read {count} members from member {first}; allowed: members 0 to {self.size - 1}")
        if isinstance(self.origin, Ensemble):
            return draws.values(self.origin, first, count)
        return _grouped(tables.values(self.origin, first, count), self.vectors)


def _grouped(read: Mapping[str, Array], vectors: Sequence[str]) -> dict[str, Array]:
    """Return columns by name, with the components of each of the vectors put together as an array (m, k)."""
    grouped = dict[str, Array]()
    for name, column in read.items():
        whole = name.rpartition(".")[0]
        if whole not in vectors:
            grouped[name] = column
        elif whole not in grouped:
            size = sum(other.rpartition(".")[0] == whole for other in read)
            grouped[whole] = np.stack([read[f"{whole}.{component}"] for component in range(size)], axis=1)
    return grouped


def of_columns(case: Case, columns: Mapping[str, Array]) -> dict[str, Array]:
    """Return numbers as `Source.values` does, from columns (m,) of single numbers by their names."""
    known = keys(loads(case.text))
    return _grouped(columns, [text for text, key in known.items() if key.components and set(key.names) <= set(columns)])


def drawn(case: Case, members: int | None = None) -> Source:
    """Return the source of members that are drawn as the table `[ensemble]` of a case says.

    Parameters
    ----------
    case
        The case.
    members
        The number of members; None for the number in the file.

    Raises
    ------
    BadInput
        The case has no such table, or the number of members is not allowed.
    """
    if case.ensemble is None:
        advice = (
            "" if case.robot is None else "; `bodycheck new NAME --model FILE` writes a case of a robot, to which it is added"
        )
        raise BadInput(f"{case.name}: has no table [ensemble], and members are not given by a table either{advice}")
    size = case.ensemble.members if members is None else members
    if not 1 <= size <= MAX_MEMBERS:
        raise BadInput(f"read {size} members; allowed: 1 to {MAX_MEMBERS:,}")
    return Source(size, case.ensemble, tuple(name for variation in case.ensemble.vary for name in variation.key.names))


def tabled(case: Case, path: Path, members: int | None = None) -> Source:
    """Return the source of members that are the rows of a table, Parquet or CSV, whose columns are key paths.

    Parameters
    ----------
    case
        The case that the rows are members of.
    path
        The file.
    members
        The number of rows to use, from the first; None for all rows.

    Raises
    ------
    BadInput
        The file cannot be read; a column is no key path of a single number of the case; two columns are about one quantity;
        there are fewer rows than members.
    """
    table = tables.opened(path)
    size = table.rows if members is None else members
    if not 1 <= size <= table.rows:
        raise BadInput(f"{path}: read {size} members; allowed: 1 to {table.rows}, the rows of the table")
    document = loads(case.text)
    names, vectors = _read(path, table.columns, document)
    return Source(size, table, names, vectors)


def check(case: Case, source: Source) -> None:
    """Raise `BadInput` if single numbers or moments make a member an invalid case. The text names the member and the key.

    Faults that only the whole body shows, such as particles that lie on a line, and faults of members after the first `CHECKED`
    are found when a member is made.
    """
    document, size = loads(case.text), min(source.size, CHECKED)
    for first in range(0, size, PORTION):
        values = source.values(first, min(PORTION, size - first))
        _check_outside(case, document, _wholes(case, document, values), first)


def scenes(case: Case, values: Mapping[str, Array], first: int = 0) -> Scenes | list[Case]:
    """Return members as scenes that differ in numbers only or, if that is not possible, as separate cases.

    Parameters
    ----------
    case
        The case.
    values
        The numbers of consecutive members by key paths, as `Source.values` returns them.
    first
        The number of the first member, for the names of cases and for messages.

    Raises
    ------
    BadInput
        A member is no valid case, or a key path leads to no number of the case. The text names the member and the key.
    """
    document = loads(case.text)
    whole = _wholes(case, document, values)
    _check_outside(case, document, whole, first)
    if all(key in QUICK for key in whole) and np.ndim(whole.get("body.inertia", ())) < 3:
        like = _member(case, document, whole, 0, first)
        if isinstance(like.scene, Scene) and variable(like.scene):
            return vary(like.scene, {QUICK[key]: array for key, array in whole.items()})
    return [_member(case, document, whole, index, first + index) for index in range(len(next(iter(whole.values()))))]


def text(case: Case, source: Source, member: int) -> str:
    """Return the text of a case file of one member alone, without `[ensemble]`. Raises `BadInput` as `scenes` does."""
    if not 0 <= member < source.size:
        raise BadInput(f"{case.name}: read member {member}; allowed: 0 to {source.size - 1}")
    document = loads(case.text)
    whole = _wholes(case, document, source.values(member, 1))
    return _member(case, document, whole, 0, member).text


def _member(case: Case, document: dict[str, Any], whole: Mapping[str, Array], index: int, member: int) -> Case:
    """Return one member as a separate case."""
    content = written(member_document(document, whole, index, member))
    try:
        return parse_stored(content, case.name)
    except CaseFaults as error:
        faults = "; ".join(f"{fault.key}: {fault.message}" if fault.key else fault.message for fault in error.faults)
        raise BadInput(f"{case.name}: member {member}: {faults}") from error


def _wholes(case: Case, document: dict[str, Any], values: Mapping[str, Array]) -> dict[str, Array]:
    try:
        return wholes(document, values)
    except Unknown as error:
        raise BadInput(f"{case.name}: {error}") from error


def _check_outside(case: Case, document: dict[str, Any], whole: Mapping[str, Array], first: int) -> None:
    """Make the members that may be invalid cases, which raises `BadInput` with their faults."""
    for index in np.flatnonzero(outside(whole, document)).tolist():
        _member(case, document, whole, index, first + index)


def _read(path: Path, columns: Sequence[str], document: dict[str, Any]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the columns of a table, with components of a vector together, and the vectors of which it has all components.

    Raises `BadInput` for a column that is no number of the case, and for two that are about the same quantity.
    """
    known, read_keys = keys(document), dict[str, Key]()
    for name in columns:
        whole = known.get(name.rpartition(".")[0])
        try:
            if whole is not None and set(whole.names) <= set(columns):
                read_keys[whole.text] = whole
            else:
                read_keys[name] = find(name, document, known)
        except Unknown as error:
            raise BadInput(f"{path}: the column {name}: {error}") from error
        if name in read_keys and read_keys[name].components is not None:
            raise BadInput(f"{path}: the column {name} is that of a vector; allowed: {', '.join(read_keys[name].names)}")
    for one, other in combinations(read_keys.values(), 2):
        if one.is_about(other):
            raise BadInput(f"{path}: has columns for {one.text} and for {other.text}; allowed: one of them")
    names = tuple(name for key in read_keys.values() for name in key.names)
    return names, tuple(text for text, key in read_keys.items() if key.components is not None)
