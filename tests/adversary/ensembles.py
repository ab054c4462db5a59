"""Trials of the folders of ensembles: damaged by chance, and then given to every command that reads or resumes one."""

import io
import random
import shutil
import tempfile
import time
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

import pytest

from tests.adversary import damage, saved
from tests.support import MINIATURES
from tests.support.commands import bodycheck, call
from tests.support.ensemble_texts import attitude, normal
from tests.support.processes import calls_here
from tests.support.saved_results import SPIN

Chance = random.Random

#: The case of the ensemble: few members, so that a trial is short.
CASE = (
    f"{SPIN.partition('[extremes]')[0]}[ensemble]\nmembers = 24\nseed = 1\n"
    f"[[ensemble.vary]]\n{normal('initial.velocity', 0.0, 1.0)}\n[[ensemble.vary]]\n{attitude()}\n"
)

#: The engines and steps of the ensemble.
METHODS = ("--engine", "batching", "--timestep", 0.1, "--timestep", 0.05)

#: Questions of a stranger, most of which reach for what is outside the folder.
QUESTIONS = (
    *("SELECT * FROM runs", "SELECT count(*) FROM runs JOIN members USING (member)", "SELECT * FROM truths"),
    *("SELECT * FROM read_text('/etc/passwd')", "SELECT * FROM glob('/etc/*')", "SELECT * FROM '../outside/victim'"),
    *(
        "COPY runs TO '../outside/victim'",
        "SELECT 1; DROP VIEW runs",
        "ATTACH '../outside/x.db'",
        "INSTALL httpfs",
        "",
        ";",
        "\0",
    ),
    *("SELECT * FROM runs a, runs b, runs c", "SELECT '\x1b[2J' AS \"=1+1\"", "PRAGMA database_list", "SELECT " + "(" * 300),
)


@cache
def good() -> tuple[Path, Path, Path]:
    """The case, the folder of an ensemble that is whole, and of one of which a share is done."""
    folder = Path(tempfile.mkdtemp(prefix="ensembles-"))
    case = folder / "spin.case.toml"
    case.write_text(CASE)
    with pytest.MonkeyPatch.context() as patch, calls_here(), redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        patch.syspath_prepend(MINIATURES)
        for name, options in (("whole", ()), ("share", ("--shard", "1/1"))):
            assert call("ensemble", case, *METHODS, "--jobs", 1, "--out", folder / name, *options) == 0
    return case, folder / "whole", folder / "share"


def command_on_damage(seed: int, folder: Path) -> str:
    """What is wrong with a command on the folder of an ensemble that was damaged by the seed."""
    chance = random.Random(seed)
    case, whole, share = good()
    results, outside = folder / "results", folder / "outside"
    shutil.copytree(chance.choice([whole, share]), results)
    saved.put_victims(outside)
    if chance.random() < 0.2:
        _rename(chance, results)
    else:
        damage.damage_folder(chance, results, outside)
    out = chance.choice([results, folder / "out"])
    words: tuple[object, ...] = chance.choice(
        [
            ("gather", results, "--out", out),
            ("gather", results, share, "--out", out),
            ("report", results),
            ("query", chance.choice(QUESTIONS), results, *chance.choice([(), ("--json",), ("--csv",), ("--show",)])),
            ("ensemble", case, *METHODS, "--jobs", 1, "--out", results),
        ]
    )
    before = saved.contents(outside)
    start = time.process_time()
    with pytest.MonkeyPatch.context() as patch, calls_here():
        patch.syspath_prepend(MINIATURES)
        done = bodycheck(*words)
    problem = saved.wrong(done, time.process_time() - start)
    if not problem and saved.contents(outside) != before:
        problem = "wrote outside the folder"
    return f"{words}: {problem}" if problem else ""


def _rename(chance: Chance, results: Path) -> None:
    """Give a file of a chunk or of a table another name or place, as nobody but a stranger would."""
    files = sorted(path for path in results.rglob("*.parquet"))
    path = chance.choice(files)
    name = chance.choice(
        [
            *(
                "..runs.parquet",
                f"{0:012}-{10**12 - 1:012}.runs.parquet",
                f"{7:012}-{3:012}.runs.parquet",
                "x.parquet",
                "\n.parquet",
            ),
            *(
                f"{10**12 - 1:012}-{1:012}.runs.parquet",
                f"{0:012}-{0:012}.runs.parquet",
                "::error::x.parquet",
                "é\u202e.parquet",
            ),
            *(path.name.replace("runs", "members"), path.name.replace("trajectories", "runs"), "part-00001.parquet"),
        ]
    )
    place = (
        path.parent if chance.random() < 0.7 else path.parent.with_name(chance.choice(["%2e%2e", "..x", "a'b", "mujoco", " "]))
    )
    place.mkdir(exist_ok=True)
    content = path.read_bytes()
    if chance.random() < 0.5:
        path.unlink()
    (place / name).write_bytes(content)
