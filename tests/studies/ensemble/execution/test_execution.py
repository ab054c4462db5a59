"""Ensembles give the same rows however they are carried out, and whatever is killed meanwhile."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Generator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from bodycheck.casefile.case import parse
from bodycheck.errors import BadFolder, BadInput, Failed
from bodycheck.processes.interpreter import Interpreter
from bodycheck.results import versions
from bodycheck.running.members.chunk_workers import ChunkWorkers
from bodycheck.running.members.chunks import Chunk, Receipt
from bodycheck.running.members.executors.dask_cluster import Cluster, ClusterLost
from bodycheck.running.members.executors.own import Own, Shard
from bodycheck.studies.ensemble import header, study
from bodycheck.studies.ensemble.execution.result_tables import gather
from tests.support import ROOT, processes
from tests.support.clusters import Cluster as Dask
from tests.support.clusters import cluster
from tests.support.planted_engines import plant
from tests.support.thrown import BALL, MORTAL, brick, check_same, check_whole, run, tables


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An ensemble that nothing disturbed, of four blocks in one chunk, made without worker processes."""
    with processes.calls_here():
        folder = run(brick(), tmp_path_factory.mktemp("whole") / "out", Own(1))
    check_whole(folder, brick(), 2)
    return folder


def test_the_number_of_chunks_and_of_threads_changes_nothing(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[Any] = []
    start = Interpreter.start
    monkeypatch.setattr(Interpreter, "start", lambda *told: started.append(told) or start(*told))
    check_same(run(brick(), tmp_path / "out", Own(2), blocks=1), whole)
    # Each thread keeps one process of the engine and one of the reference, and others compare the worst truths with witnesses;
    # a process in which a library has started a thread late is not used again. There are some forty calls.
    assert len(started) <= 12


def test_jobs_of_a_queue_give_the_same(calls_here: None, whole: Path, tmp_path: Path) -> None:
    folders = [tmp_path / "shared", tmp_path / "shared", tmp_path / "apart"]
    for number, folder in enumerate(folders, start=1):
        run(brick(), folder, Shard(number, 3, 1), blocks=1)
    with pytest.raises(BadFolder, match="members 2000 to 2999 were not run in mujoco"):
        gather(folders[:1], tmp_path / "out")
    check_same(gather(folders, tmp_path / "out"), whole)


def test_a_gathered_ensemble_must_be_one(calls_here: None, tmp_path: Path) -> None:
    case = brick(members=10)
    one = run(case, tmp_path / "one", Shard(1, 2, 1))
    other = run(case, tmp_path / "other", Shard(2, 2, 1), timesteps=(0.02,))
    with pytest.raises(BadFolder, match=r"not of the same ensemble as .*: the methods or engines differ"):
        gather([one, other], tmp_path / "out")
    stored = json.loads((other / header.FILE).read_text())
    stored["packages"]["numpy"] = "1.0"
    (other / header.FILE).write_text(json.dumps(stored))
    with pytest.raises(BadFolder, match=r"has numpy 1.0, and .* has numpy "):
        gather([one, other], tmp_path / "out")
    whole = run(case, tmp_path / "whole", Own(1))
    with pytest.raises(BadFolder, match="complete already"):
        gather([whole], tmp_path / "out")


class Stop(Exception):
    """Stops an ensemble in the middle."""


class Stopping:
    """A progress that stops the work after so many chunks."""

    def __init__(self, count: int) -> None:
        self.left, self.there = count, 0

    def __call__(self, done: str, count: int = 1, /) -> None:
        if not done:
            self.there = count
            return
        self.left -= 1
        if not self.left:
            raise Stop


def test_what_is_done_is_not_done_again(calls_here: None, whole: Path, tmp_path: Path) -> None:
    """Also with chunks of another size, and if a file that was there is damaged, or is one of other work."""
    folder = tmp_path / "out"
    with pytest.raises(Stop):
        run(brick(), folder, Own(1), blocks=1, progress=Stopping(3))
    files = sorted((folder / "chunks" / "mujoco").glob("*.runs.parquet"))
    assert len(files) == 3
    before = {file: file.stat().st_mtime_ns for file in files}
    files[1].write_bytes(files[1].read_bytes()[:-20])
    resumed = Stopping(2)
    with pytest.raises(Stop):
        run(brick(), folder, Own(1), blocks=2, progress=resumed)
    assert resumed.there == 2 * 2000
    assert {file: file.stat().st_mtime_ns for file in (files[0], files[2])} == {
        file: before[file] for file in (files[0], files[2])
    }
    check_same(run(brick(), folder, Own(1)), whole)


def test_another_ensemble_takes_the_place_of_one_that_is_there(calls_here: None, tmp_path: Path) -> None:
    folder = run(brick(members=20), tmp_path / "out", Own(1))
    run(brick(members=10), folder, Own(1))
    check_whole(folder, brick(members=10), 2)
    for name in ("ensemble.csv", "ensemble.csv-metadata.json", "sensitivity.csv", "report.html"):
        (folder / name).write_text("of the ensemble that is there", "utf-8")
    run(brick(members=20), folder, Own(1))
    assert not {path.name for path in folder.iterdir()} & {"ensemble.csv", "sensitivity.csv", "report.html", "worst"}
    with pytest.raises(BadFolder, match=f"has the ensemble of the case {brick().name}; give an empty or a new folder"):
        run(brick(name='"other"'), folder, Own(1))
    check_whole(folder, brick(members=20), 2)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "thesis.txt").write_text("42")
    with pytest.raises(BadFolder, match="contains files that are not results of an ensemble"):
        run(brick(members=10), tmp_path / "other", Own(1))


@pytest.fixture
def mortal(miniatures: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of an engine whose process ends with any scene that spins fast enough."""
    plant(tmp_path / "engines", {"mortal": MORTAL.format(limit=3.0)})
    monkeypatch.syspath_prepend(tmp_path / "engines")
    return "mortal"


def test_members_that_kill_their_process_are_alone(mortal: str, tmp_path: Path) -> None:
    case = parse(BALL.replace("members = 3500", "members = 8"), "ball")
    folder = run(case, tmp_path / "out", Own(1), (mortal,), ())
    found = tables(folder)
    spins = found["members"]["initial.angular_velocity.0"].to_pylist()
    fast = [member for member, spin in enumerate(spins) if spin > 3.0]
    assert len(fast) == 1
    runs = {row["member"]: row for row in found["runs"].to_pylist()}
    assert [member for member, row in runs.items() if row["status"] == "crashed"] == fast
    assert {runs[member]["reason"] for member in fast} == {"its process exited with code 3"}
    assert not any(runs[member]["passed"] for member in fast)
    # The others are what the engine makes of them in whose process none dies.
    with processes.calls_here():
        alive = tables(run(case, tmp_path / "alive", Own(1), ("batching",), ()))["runs"]
    undisturbed = {row["member"]: row | {"engine": mortal} for row in alive.to_pylist()}
    assert {member: row for member, row in runs.items() if member not in fast} == {
        member: row for member, row in undisturbed.items() if member not in fast
    }


KILLED = """
import sys
from pathlib import Path
from bodycheck.running.members.executors.own import Own
from tests.support.thrown import brick, run
run(brick(), Path(sys.argv[1]), Own(2), blocks=1)
"""


def kill_runs(folder: Path, kills: int, seed: int) -> None:
    """Kill a command at random moments, and go on with it, until it has been killed so often."""
    chance = random.Random(seed)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    for _ in range(kills):
        with subprocess.Popen([sys.executable, "-c", KILLED, folder], env=environment) as process:
            while not (folder / header.FILE).exists() and process.poll() is None:
                time.sleep(0.01)
            time.sleep(chance.uniform(0.0, 4.0))
            process.send_signal(signal.SIGKILL)


@pytest.mark.slow
def test_a_command_that_is_killed_goes_on(whole: Path, tmp_path: Path) -> None:
    kill_runs(tmp_path / "out", 2, seed=1)
    check_same(run(brick(), tmp_path / "out", Own(2), blocks=1), whole)


@pytest.fixture(scope="module")
def dask_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("dask")


@dataclass
class Killing:
    """A progress that kills workers after each chunk, and the scheduler after some of them.

    Attributes
    ----------
    workers
        How many workers are to be killed.
    schedulers
        After which chunks the scheduler is killed.
    each
        How many workers are killed after a chunk.
    """

    workers: int
    schedulers: tuple[int, ...]
    each: int = 1
    cluster: Dask | None = None
    chance: random.Random = field(default_factory=lambda: random.Random(1))
    done: list[str] = field(default_factory=list)
    killed: int = 0

    def __call__(self, name: str, count: int = 1, /) -> None:
        if not name:
            return
        assert self.cluster is not None
        self.done.append(name)
        if len(self.done) in self.schedulers:
            self.cluster.kill_scheduler()
        elif self.killed < self.workers:
            self.killed += self.cluster.kill_workers(min(self.each, self.workers - self.killed), self.chance)


def test_a_cluster_gives_the_same_whatever_is_killed(whole: Path, dask_folder: Path, tmp_path: Path) -> None:
    """A worker and then the scheduler are killed. Threads of this machine go on from the files."""
    killing = Killing(1, (2,))
    with (
        cluster(dask_folder) as killing.cluster,
        pytest.raises(ClusterLost, match="start a new scheduler and new workers"),
    ):
        run(brick(), tmp_path / "out", Cluster(killing.cluster.address, 1), blocks=1, progress=killing)
    assert (len(killing.done), killing.killed) == (2, 1)
    resumed = Stopping(100)
    run(brick(), tmp_path / "out", Own(2), blocks=1, progress=resumed)
    assert resumed.there >= 2 * 1500
    check_same(tmp_path / "out", whole)


@pytest.mark.slow
def test_nothing_is_lost_or_twice_after_many_kills(dask_folder: Path, tmp_path: Path) -> None:
    """Twenty workers, three schedulers; five minutes: `pytest -m slow tests/studies/ensemble/execution/test_execution.py`."""
    case, both = brick(members=10_000), ("mujoco", "pinocchio")
    whole = run(case, tmp_path / "whole", Own(2), both, ())
    killing = Killing(20, (4, 6, 8), each=3)
    for lost in (True, True, True, False):
        with (
            cluster(dask_folder, workers=3) as killing.cluster,
            pytest.raises(ClusterLost) if lost else nullcontext(),
        ):
            run(case, tmp_path / "out", Cluster(killing.cluster.address, 1), both, (), blocks=1, progress=killing)
    print(f"{killing.killed} workers were killed after {len(killing.done)} chunks")
    assert killing.killed == 20
    check_same(tmp_path / "out", whole)


def test_a_worker_with_other_versions_is_refused(dask_folder: Path, tmp_path: Path) -> None:
    other = tmp_path / "packages" / "scipy-0.1.dist-info"
    other.mkdir(parents=True)
    (other / "METADATA").write_text("Metadata-Version: 2.1\nName: scipy\nVersion: 0.1\n")
    path = os.pathsep.join([str(other.parent), *sys.path])
    with (
        cluster(dask_folder, workers=1, environment={"PYTHONPATH": path}) as made,
        pytest.raises(versions.OtherVersion, match=r"the worker tcp://.* has scipy 0.1, and this command has scipy "),
    ):
        run(brick(members=10), tmp_path / "out", Cluster(made.address, 1))


def test_a_scheduler_that_is_not_there_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bodycheck.running.members.executors.dask_cluster.CONNECT_S", 0.5)
    with pytest.raises(BadInput, match=r"--dask tcp://127.0.0.1:9: the scheduler cannot be reached"):
        run(brick(members=10), tmp_path / "out", Cluster("tcp://127.0.0.1:9", 1))


@pytest.mark.parametrize("text", ["0/3", "4/3", "3", "1/0", "-1/3", "a/b", "1/2/3", "١/٣"])
def test_a_share_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(BadInput, match="--shard"):
        Shard.parse(text, 1)


class Elsewhere:
    """An executor whose files are written elsewhere, and appear in the folder of the ensemble later or never."""

    whole, chunks = True, 1

    def __init__(self, hidden: Path, later: float | None) -> None:
        self.hidden, self.later = hidden, later
        hidden.mkdir()

    def __call__(self, perform: Any, chunks: Sequence[Chunk]) -> Generator[Receipt, None, None]:
        folder = perform.keywords["folder"]
        for chunk in chunks:
            with ChunkWorkers() as workers:
                receipt = perform.func(chunk, workers, folder=self.hidden)
            if self.later is not None:
                copied = partial(shutil.copytree, self.hidden / "chunks", folder / "chunks", dirs_exist_ok=True)
                threading.Timer(self.later, copied).start()
            yield receipt


def test_files_that_a_network_shows_late_are_waited_for(calls_here: None, whole: Path, tmp_path: Path) -> None:
    check_same(run(brick(), tmp_path / "out", Elsewhere(tmp_path / "hidden", 0.3)), whole)


def test_a_folder_that_workers_do_not_share_is_told(calls_here: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "PATIENCE_S", 0.5)
    with pytest.raises(Failed, match="the folder must be one that this machine and all workers share"):
        run(brick(members=10), tmp_path / "out", Elsewhere(tmp_path / "hidden", None))
