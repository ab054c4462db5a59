"""Trials of what is read again: damaged results and studies through `report`, damaged baselines through `diff`."""

import io
import os
import random
import shutil
import tempfile
import time
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

import pytest

from tests.adversary import damage
from tests.support import MINIATURES, saved_results
from tests.support.commands import Done, bodycheck, call
from tests.support.processes import calls_here

#: The kinds of folders that are damaged; most are of runs.
KINDS = ("run", "run", "run", "tradeoff", "recommend", "extremes", "ablate")

#: What reading a small folder again may take of processor time (s).
READING_S = 60.0

#: The variable with the folder of results and studies that a test run has made already.
SAVED = "BODYCHECK_SAVED"


@cache
def good() -> Path:
    """The folder of the undamaged results, studies and baselines, which are made where no test has made them."""
    if SAVED in os.environ:
        return Path(os.environ[SAVED])
    folder = Path(tempfile.mkdtemp(prefix="saved-"))
    with pytest.MonkeyPatch.context() as patch, calls_here(), redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        patch.syspath_prepend(MINIATURES)
        saved_results.run(folder)
        for kind in sorted({*KINDS} - {"run"}):
            saved_results.study(kind, folder)
    return folder


@cache
def baseline() -> Path:
    """A baseline of a case in an engine that is exact and in one that raises."""
    folder = Path(tempfile.mkdtemp(prefix="baseline-"))
    case = folder / "spin.case.toml"
    case.write_text(saved_results.SPIN.partition("[[expect]]")[0])
    with pytest.MonkeyPatch.context() as patch, calls_here(), redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        patch.syspath_prepend(MINIATURES)
        engines = ("--engine", "exact", "--engine", "drifting", "--engine", "raising")
        assert call("run", case, *engines, "--timestep", 0.1, "--timestep", 0.05, "--save", folder / "good.parquet") == 1
    return folder / "good.parquet"


def report_of_damage(seed: int, folder: Path) -> str:
    """What is wrong with the report of a folder that was damaged by the seed."""
    chance = random.Random(seed)
    kind = chance.choice([kind for kind in KINDS if (good() / kind).is_dir()])
    results, outside = folder / "results", folder / "outside"
    shutil.copytree(good() / kind, results, ignore=shutil.ignore_patterns("report.*", "*.svg"))
    put_victims(outside)
    damage.damage_folder(chance, results, outside)
    folders = [results, good() / "run"] if chance.random() < 0.2 else [results]
    out = ["--out", folder / "out"] if len(folders) > 1 or chance.random() < 0.5 else []
    before = contents(outside)
    start = time.process_time()
    done = bodycheck("report", *folders, *out)
    return wrong(done, time.process_time() - start) or ("" if contents(outside) == before else "wrote outside the folder")


def diff_of_damage(seed: int, folder: Path) -> str:
    """What is wrong with the difference between a baseline and one that was damaged by the seed."""
    chance = random.Random(seed)
    paths = folder / "now.parquet", folder / "base.parquet"
    for path in paths:
        shutil.copyfile(baseline(), path)
    put_victims(folder / "outside")
    for path in paths[: chance.choice([1, 1, 2])]:
        damage.damage_file(chance, path, folder / "outside")
    start = time.process_time()
    given = paths if chance.random() < 0.5 else paths[::-1]
    options = ["--json"] if chance.random() < 0.5 else []
    done = bodycheck("diff", *given, *options, GITHUB_ACTIONS=chance.choice(["", "true"]))
    return wrong(done, time.process_time() - start)


def wrong(done: Done, taken: float) -> str:
    if done.returncode not in (0, 1, 2):
        return f"exit {done.returncode}: {done.stderr[-1000:]}"
    if done.returncode == 2 and not done.stderr.strip():
        return "exit 2 without a message"
    if "Traceback" in done.stderr:
        return done.stderr[-3000:]
    return f"took {taken:.0f} s" if taken > READING_S else ""


def put_victims(outside: Path) -> None:
    outside.mkdir()
    (outside / "victim").write_text("nobody writes here\n")
    (outside / "below").mkdir()
    (outside / "below" / "victim.parquet").write_text("nor here\n")


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() if path.is_file() else b"" for path in sorted(folder.rglob("*"))}
