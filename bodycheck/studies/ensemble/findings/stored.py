"""Read the runs and the members of an ensemble from its folder, one column at a time.

The files are `runs/ENGINE/CASE/*.parquet`, with one row for each member and method, and `members/CASE/*.parquet`, with the
numbers that were drawn. Each run takes memory for its place in the table of methods and members (6 bytes) and for its outcome;
a column of numbers takes 8 bytes per run while it is used.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from bodycheck.adapters.method import Method
from bodycheck.errors import BadFolder
from bodycheck.reference.trajectory import Array
from bodycheck.results.key import RunKey
from bodycheck.studies.ensemble.drawing.draws import SEQUENCES

#: Folders of an ensemble: of runs by engine and case, and of members by case.
RUNS, MEMBERS = "runs", "members"

#: The columns of runs that identify the method of a row.
METHOD = ("engine", "version", "integrator", "timestep")

#: The statuses of runs that completed, of runs that diverged, and of runs that the engine cannot make.
OK, DIVERGED, UNSUPPORTED = "ok", "diverged", "unsupported"

#: Rows that are read at once.
BATCH = 1 << 16

#: The most methods, and the most places per run in the table of methods and members; a complete table has one place per run.
MOST_METHODS, MOST_PLACES = 10_000, 16

Codes = NDArray[np.int16]
Places = NDArray[np.int32]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class EngineMethod:
    """A method of an ensemble: an engine with its version, an integrator with its options, and a time step (s)."""

    engine: str
    version: str
    integrator: str
    timestep: float

    def key(self, case: str) -> RunKey:
        """Return the key of the runs with this method of a case."""
        return RunKey(case, self.engine, Method.parse(self.integrator, self.timestep))


@dataclass(frozen=True, eq=False)
class Ensemble:
    """The runs of an ensemble of one case.

    Attributes
    ----------
    case
        The name of the case.
    methods
        The m methods, engine by engine.
    members
        The numbers of the n members (n,), in ascending order.
    statuses
        The names of the statuses that occur.
    status
        The status of each run (m, n), as an index of `statuses`; -1 where there is no run.
    broken
        Whether each run (m, n) has not passed: it ended badly, or breaks an expectation of the case.
    figures
        The names of all columns of numbers of the runs, figures and measured times.
    drawn
        The names of the drawn numbers, as their columns are called.
    parts
        The files of runs, each with the indices of the method and of the member of each row.
    member_files
        The files of members.
    """

    case: str
    methods: tuple[EngineMethod, ...]
    members: NDArray[np.int64]
    statuses: tuple[str, ...]
    status: NDArray[np.int8]
    broken: Flags
    figures: tuple[str, ...]
    drawn: tuple[str, ...]
    parts: tuple[tuple[Path, Codes, Places], ...]
    member_files: tuple[Path, ...]

    @cached_property
    def supported(self) -> Flags:
        """Flags (m, n) of the runs that were made: each has a row, and the engine supports it."""
        return (self.status >= 0) & ~self._has(UNSUPPORTED)

    @cached_property
    def failed(self) -> Flags:
        """Flags (m, n) of the runs that were made and failed: the status is not ok, or an expectation is broken."""
        return self.supported & (~self._has(OK) | self.broken)

    @property
    def measured(self) -> Flags:
        """Flags (m, n) of the runs with a motion: they completed, diverged, or ended as an expectation of the case says."""
        return self.supported & (self._has(OK) | self._has(DIVERGED) | ~self.broken)

    @property
    def sequence(self) -> NDArray[np.int64]:
        """The sequence that each member (n,) was drawn from."""
        return self.members % SEQUENCES

    def column(self, name: str) -> Array:
        """Return a column of numbers of all runs (m, n); NaN where a run has none."""
        values = np.full(self.status.shape, np.nan)
        for path, codes, places in self.parts:
            first = 0
            for batch in _batches(path, (name,)):
                last = first + len(batch)
                values[codes[first:last], places[first:last]] = _floats(batch.column(0))
                first = last
        return values

    def values(self, name: str) -> Array:
        """Return a drawn number of all members (n,); NaN where a member has none."""
        values = np.full(len(self.members), np.nan)
        for path in self.member_files:
            for batch in _batches(path, ("member", name)):
                places = _places(batch.column(0), self.members, path)
                values[places] = _floats(batch.column(1))
        return values

    def reasons(self, method: int, places: Sequence[int]) -> dict[int, str]:
        """Return the reasons of some runs of a method, by the places of their members. Missing runs are left out."""
        by_member: dict[int, str] = {}
        for path, codes, where in self.parts:
            wanted = np.flatnonzero((codes == method) & np.isin(where, places))
            if not wanted.size:
                continue
            first = 0
            for batch in _batches(path, ("reason",)):
                here = wanted[(wanted >= first) & (wanted < first + len(batch))]
                by_member |= {int(where[row]): str(batch.column(0)[int(row) - first].as_py() or "") for row in here}
                first += len(batch)
        return by_member

    def _has(self, status: str) -> Flags:
        if status not in self.statuses:
            return np.zeros(self.status.shape, np.bool_)
        return np.asarray(self.status == self.statuses.index(status))


def read(folder: Path, case: str, engines: Sequence[str] = ()) -> Ensemble:
    """Return the runs of an ensemble of a case.

    Parameters
    ----------
    folder
        The folder of the ensemble.
    case
        The name of the case.
    engines
        The engines in the order of the methods; others come after them by name.

    Raises
    ------
    BadFolder
        The folder has no runs of the case, or a file of it cannot be read or is no such table.
    """
    files = sorted((folder / RUNS).glob(f"*/{case}/*.parquet"))
    member_files = tuple(sorted((folder / MEMBERS / case).glob("*.parquet")))
    if not files or not member_files:
        raise BadFolder(f"{folder}: has no runs of an ensemble of {case}")
    members = np.sort(
        np.concatenate([_ints(batch.column(0)) for path in member_files for batch in _batches(path, ("member",))])
    )
    known: dict[EngineMethod, int] = {}
    parts = [(path, *_table(path, members, known)) for path in files]
    order = _order(known, engines)
    runs = sum(len(codes) for _, codes, _ in parts)
    if len(order) * len(members) > MOST_PLACES * runs:  # so that a small file does not fill the memory
        raise BadFolder(f"{folder}: has {runs} runs of {len(members)} members with {len(order)} methods; members are missing")
    places = np.empty(len(order), np.int16)
    places[[known[method] for method in order]] = np.arange(len(order))
    sorted_parts = tuple((path, places[codes], where) for path, codes, where in parts)
    statuses, status, broken = _outcomes(sorted_parts, (len(order), len(members)))
    return Ensemble(
        case=case,
        methods=order,
        members=members,
        statuses=statuses,
        status=status,
        broken=broken,
        figures=_numbers(files, (*METHOD, "case", "member")),
        drawn=_numbers(member_files, ("member", "case")),
        parts=sorted_parts,
        member_files=member_files,
    )


def _order(known: Mapping[EngineMethod, int], engines: Sequence[str]) -> tuple[EngineMethod, ...]:
    """Return methods in the order of the engines. Methods of one engine keep the order in which they were found."""
    ranks = {name: index for index, name in enumerate(engines)}
    return tuple(sorted(known, key=lambda method: (ranks.get(method.engine, len(ranks)), method.engine, known[method])))


def _table(path: Path, members: NDArray[np.int64], known: dict[EngineMethod, int]) -> tuple[Codes, Places]:
    """Return the method and the place of the member of each row of a file of runs, and add new methods to `known`."""
    codes, places = [], []
    for batch in _batches(path, ("member", *METHOD)):
        places.append(_places(batch.column(0), members, path))
        codes.append(_codes(path, batch, known))
    return np.concatenate([np.empty(0, np.int16), *codes]), np.concatenate([np.empty(0, np.int32), *places])


def _codes(path: Path, batch: Any, known: dict[EngineMethod, int]) -> Codes:
    """Return the index of the method of each row, and add new methods to `known`. Raises `BadFolder` for too many."""
    columns = [_encoded(batch.column(1 + index)) for index in range(len(METHOD))]
    rows = np.zeros(len(batch), np.int64)
    for indices, values in columns:
        rows = rows * max(1, len(values)) + indices
    different, first, inverse = np.unique(rows, return_index=True, return_inverse=True)
    method_codes = np.empty(len(different), np.int16)
    for index in np.argsort(first):  # in the order of the rows
        engine, version, integrator, timestep = (values[indices[first[index]]] for indices, values in columns)
        method = EngineMethod(str(engine), str(version), str(integrator), float(timestep))
        if method not in known and len(known) == MOST_METHODS:
            raise BadFolder(f"{path}: has more than {MOST_METHODS} methods")
        method_codes[index] = known.setdefault(method, len(known))
    return method_codes[inverse.reshape(-1)]


def _encoded(column: Any) -> tuple[NDArray[np.int64], list[Any]]:
    """Return the index of the value of each row among the distinct values of a column, and the distinct values."""
    encoded = column if pa.types.is_dictionary(column.type) else column.dictionary_encode(null_encoding="encode")
    return encoded.indices.to_numpy(zero_copy_only=False).astype(np.int64), encoded.dictionary.to_pylist()


def _outcomes(
    parts: Collection[tuple[Path, Codes, Places]], shape: tuple[int, int]
) -> tuple[tuple[str, ...], NDArray[np.int8], Flags]:
    """Return the statuses that occur, the status of each run (m, n), and whether each run has not passed (m, n)."""
    names: dict[str, int] = {}
    status, broken = np.full(shape, -1, np.int8), np.zeros(shape, np.bool_)
    for path, codes, places in parts:
        first = 0
        for batch in _batches(path, ("status", "passed")):
            last = first + len(batch)
            indices, values = _encoded(batch.column(0))
            status_codes = np.array([names.setdefault(str(value), len(names)) for value in values], np.int8)
            where = codes[first:last], places[first:last]
            status[where] = status_codes[indices]
            broken[where] = ~batch.column(1).fill_null(True).to_numpy(zero_copy_only=False)
            first = last
    return tuple(names), status, broken


def _numbers(files: Sequence[Path], others: Collection[str]) -> tuple[str, ...]:
    """Return the names of the columns of numbers of files, in the order of the first file that has them."""
    names: dict[str, None] = {}
    for path in files:
        with _reading(path) as file:
            schema = file.schema_arrow
        numeric = (pa.types.is_floating, pa.types.is_integer)
        names |= {field.name: None for field in schema if any(kind(field.type) for kind in numeric)}
    return tuple(name for name in names if name not in others)


def _batches(path: Path, names: Sequence[str]) -> Iterator[Any]:
    """Yield the rows of a file in parts, with some columns in this order. A column that the file lacks has only nulls."""
    try:
        with pq.ParquetFile(path) as file:
            schema = file.schema_arrow
            there = [name for name in names if name in schema.names]
            for batch in file.iter_batches(BATCH, columns=there, use_threads=False):
                columns = [
                    batch.column(there.index(name)) if name in there else pa.nulls(len(batch), pa.float64()) for name in names
                ]
                yield pa.RecordBatch.from_arrays(columns, list(names))
    except (OSError, pa.ArrowException) as error:
        raise BadFolder(f"{path}: cannot be read as a table: {error}") from error


def _reading(path: Path) -> Any:
    try:
        return pq.ParquetFile(path)
    except (OSError, pa.ArrowException) as error:
        raise BadFolder(f"{path}: cannot be read as a table: {error}") from error


def _places(column: Any, members: NDArray[np.int64], path: Path) -> Places:
    """Return the place of each member among all members. Raises `BadFolder` for an unknown member."""
    numbers = _ints(column)
    places = np.searchsorted(members, numbers).clip(max=len(members) - 1)
    if not np.array_equal(members[places], numbers):
        raise BadFolder(f"{path}: has members that the folder {MEMBERS} has not")
    return places.astype(np.int32)


def _ints(column: Any) -> NDArray[np.int64]:
    return np.asarray(column.to_numpy(zero_copy_only=False)).astype(np.int64)


def _floats(column: Any) -> Array:
    if pa.types.is_dictionary(column.type):
        column = column.dictionary_decode()
    return np.asarray(column.to_numpy(zero_copy_only=False), np.float64)
