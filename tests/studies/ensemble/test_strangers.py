"""Folders of ensembles that are damaged or made by strangers: members are never left out or taken for others."""

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.errors import BadFolder, BadInput
from bodycheck.running.members.executors.own import Own, Shard
from bodycheck.studies.ensemble.execution.result_tables import gather
from bodycheck.studies.ensemble.findings import stored
from tests.support.ensembles import CASE, EULER, write
from tests.support.processes import calls_here
from tests.support.thrown import brick, check_same, run

MEMBERS = 24


@pytest.fixture(scope="module")
def here() -> Iterator[None]:
    with calls_here():
        yield


@pytest.fixture(scope="module")
def whole(here: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(brick(members=MEMBERS), tmp_path_factory.mktemp("whole") / "out", Own(1))


@pytest.fixture(scope="module")
def original(here: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(brick(members=MEMBERS), tmp_path_factory.mktemp("share") / "out", Shard(1, 1, 1))


@pytest.fixture
def share(original: Path, tmp_path: Path) -> Path:
    """The folder of an ensemble of which all chunks are done and not gathered yet."""
    return Path(shutil.copytree(original, tmp_path / "share"))


def chunk_file(folder: Path, kind: str) -> Path:
    (path,) = folder.glob(f"chunks/mujoco/*.{kind}.parquet")
    return path


@pytest.mark.parametrize("kind", ["members", "truths", "trajectories", "runs"])
def test_a_chunk_that_lacks_a_file_is_not_done(share: Path, whole: Path, tmp_path: Path, kind: str) -> None:
    chunk_file(share, kind).unlink()
    with pytest.raises(BadFolder, match="members 0 to 23 were not run in mujoco"):
        gather([share], tmp_path / "out")
    check_same(run(brick(members=MEMBERS), share, Own(1)), whole)


def changed(path: Path, change: Callable[[pa.Table], pa.Table]) -> None:
    table = pq.read_table(path)
    pq.write_table(change(table).replace_schema_metadata(table.schema.metadata), path)


@pytest.mark.parametrize("kind", ["members", "truths", "runs"])
@pytest.mark.parametrize(
    "change",
    [
        lambda table: table.slice(0, 1),
        lambda table: table.slice(0, 0),
        lambda table: pa.concat_tables([table, table]),
        lambda table: table.take(pa.array(range(len(table))[::-1])),
    ],
    ids=["few", "none", "twice", "backwards"],
)
def test_rows_of_other_members_are_refused(
    share: Path, tmp_path: Path, kind: str, change: Callable[[pa.Table], pa.Table]
) -> None:
    path = chunk_file(share, kind)
    changed(path, change)
    with pytest.raises(BadFolder, match=rf"{path.name}: damaged: .*; remove it, and run the same command again"):
        gather([share], tmp_path / "out")


@pytest.mark.parametrize(
    "change",
    [
        lambda table: table.drop_columns(["member"]),
        lambda table: table.set_column(2, "integrator", pa.array(["other"] * len(table))),
        lambda table: table.set_column(4, "member", pa.nulls(len(table), pa.int64())),
    ],
    ids=["no members", "other methods", "empty members"],
)
def test_trajectories_of_others_are_refused(share: Path, tmp_path: Path, change: Callable[[pa.Table], pa.Table]) -> None:
    path = chunk_file(share, "trajectories")
    changed(path, change)
    with pytest.raises(BadFolder, match=rf"{path.name}: damaged: .*; remove it and the file of runs beside it"):
        gather([share], tmp_path / "out")


def test_a_chunk_without_statistics_is_gathered(share: Path, whole: Path, tmp_path: Path) -> None:
    """Whoever wrote the file: figures that no run has are then columns, too."""
    path = chunk_file(share, "runs")
    pq.write_table(pq.read_table(path), path, write_statistics=False)
    gathered = gather([share], tmp_path / "out")
    (ours,), (theirs,) = (sorted(folder.glob("runs/mujoco/thrown/*.parquet")) for folder in (gathered, whole))
    known = [name for name in pq.read_table(theirs).column_names if name != "wall_time"]
    assert pq.read_table(ours).select(known).equals(pq.read_table(theirs).select(known))


def test_many_methods_in_a_small_file_do_not_fill_the_memory(tmp_path: Path) -> None:
    """A row for each of 500 methods, in 10,000 members, would take a table of 5 million places for 500 runs."""
    count = 500
    folder = write(tmp_path, {"body.mass": np.ones(10_000)}, {EULER: {"steps": np.ones(10_000)}})
    (path,) = folder.glob("runs/*/*/*.parquet")
    table = pq.read_table(path).slice(0, count)
    table = table.set_column(table.column_names.index("timestep"), "timestep", pa.array(np.arange(1.0, count + 1)))
    pq.write_table(table, path)
    with pytest.raises(BadFolder, match="has 500 runs of 10000 members with 500 methods; members are missing"):
        stored.read(folder, CASE)


def test_more_blocks_than_memory_has_room_for_are_refused_before_they_are_planned(tmp_path: Path) -> None:
    """A billion members of which each is a block, since it has many samples."""
    case = replace(brick(members=10**9), samples=10**6)
    with pytest.raises(BadInput, match="thrown: 1000000000 members, of which 1 are treated at once; allowed: at most 1000000"):
        run(case, tmp_path / "out", Own(1))
    assert not (tmp_path / "out").exists()
