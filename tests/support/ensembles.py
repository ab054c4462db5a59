"""Folders of ensembles, written by PyArrow in the layout of `bodycheck ensemble`, with any figures."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bodycheck.reference.trajectory import Array
from bodycheck.studies.ensemble.findings.stored import EngineMethod, Ensemble, read

#: The name of the case.
CASE = "spin"

EULER = EngineMethod("mujoco", "3.3.0", "Euler", 0.002)
RK4 = EngineMethod("mujoco", "3.3.0", "RK4", 0.002)


def many_methods(count: int) -> list[EngineMethod]:
    """As many methods of two engines."""
    return [
        EngineMethod("mujoco" if place % 2 else "pinocchio", "4", f"scheme:option={place}", 0.002) for place in range(count)
    ]


def write(
    folder: Path,
    drawn: Mapping[str, Array],
    runs: Mapping[EngineMethod, Mapping[str, Any]],
    rows_of_file: int = 1 << 18,
) -> Path:
    """Write an ensemble and return its folder.

    Parameters
    ----------
    folder
        The folder.
    drawn
        The drawn numbers (n,) by name.
    runs
        By the method, columns (n,) of its runs: figures, and `status`, `passed` and `reason` where they are not "ok" and None.
    rows_of_file
        Most rows of a file.
    """
    members = np.arange(len(next(iter(drawn.values()))))
    place = folder / "members" / CASE
    place.mkdir(parents=True)
    pq.write_table(pa.table({"case": [CASE] * len(members), "member": members, **drawn}), place / "part-00000.parquet")
    for engine in dict.fromkeys(by.engine for by in runs):
        own = {by: columns for by, columns in runs.items() if by.engine == engine}
        table = _interleaved([_table(by, members, columns) for by, columns in own.items()])
        where = folder / "runs" / engine / CASE
        where.mkdir(parents=True)
        for number, first in enumerate(range(0, len(table), rows_of_file)):
            pq.write_table(table.slice(first, rows_of_file), where / f"part-{number:05}.parquet", row_group_size=1 << 16)
    return folder


def made(folder: Path, drawn: Mapping[str, Array], runs: Mapping[EngineMethod, Mapping[str, Any]]) -> Ensemble:
    """Write an ensemble and read it."""
    return read(write(folder, drawn, runs), CASE, list(dict.fromkeys(by.engine for by in runs)))


def _table(by: EngineMethod, members: Any, columns: Mapping[str, Any]) -> pa.Table:
    count = len(members)
    named = {"engine": by.engine, "version": by.version, "integrator": by.integrator, "timestep": by.timestep}
    defaults = {"status": ["ok"] * count, "passed": pa.nulls(count, pa.bool_()), "reason": [""] * count}
    figures = {name: pa.array(values, from_pandas=True) for name, values in columns.items() if name not in defaults}
    told = {name: columns.get(name, values) for name, values in defaults.items()}
    same = {name: pa.repeat(value, count) for name, value in {"case": CASE, **named}.items()}
    return pa.table({**same, "member": members, **told, **figures})


def _interleaved(tables: Sequence[pa.Table]) -> pa.Table:
    """Return the rows of tables in the order of members, and of each member in the order of the tables."""
    count = len(tables[0])
    together = pa.concat_tables(tables, promote_options="default")
    return together.take(pa.array(np.arange(len(together)).reshape(len(tables), count).T.reshape(-1)))
