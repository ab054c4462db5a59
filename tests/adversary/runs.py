"""Trials of runs: a hostile case file through `run` in an engine that does what engines should not do."""

import random
import time
from pathlib import Path

import pytest

from bodycheck import Case, CaseFaults
from bodycheck.casefile.case import parse
from bodycheck.casefile.values import MAX_SAMPLES
from bodycheck.results import journal, store
from tests.adversary import case_files
from tests.support import MINIATURES
from tests.support.commands import bodycheck
from tests.support.processes import calls_here

#: Engines that a process outlives, so that they can run in that of the trials.
ENGINES = ("exact", "wrong", "drifting", "exploding", "not-a-number", "raising", "exiting", "shapeless", "frozen", "mujoco")

#: What a short run, its truth and its report may take of processor time (s).
RUN_S = 60.0

#: Most samples of a case that is run.
MOST_SAMPLES = 101


def run_of_a_file(seed: int, folder: Path) -> str:
    """What is wrong with a run of the accepted case file of a seed, in an engine, with few steps."""
    chance = random.Random(seed)
    text, case = _accepted(chance)
    path, out = folder / "hostile.case.toml", folder / "out"
    path.write_text(text)
    steps = [word for _ in range(chance.choice([1, 2])) for word in ("--timestep", case.duration / chance.randint(1, 30))]
    options = ["--json"] if chance.random() < 0.2 else []
    start = time.process_time()
    with pytest.MonkeyPatch.context() as patch, calls_here():
        patch.syspath_prepend(MINIATURES)
        done = bodycheck("run", path, "--engine", chance.choice(ENGINES), *steps, *options, "--out", out)
    taken = time.process_time() - start
    if done.returncode not in (0, 1):
        return f"exit {done.returncode}: {done.stderr[-2000:]}"
    if taken > RUN_S:
        return f"took {taken:.0f} s"
    broken = [record for record in journal.read(out / store.RECORDS).records if _is_broken(record)]
    return f"no truth: {broken[0]}" if broken else ""


def _is_broken(record: journal.Record) -> bool:
    """Whether a truth or a stop failed by an error of the program; the reference names what it does not know otherwise."""
    return record["record"] != "run" and any(
        f"{kind}: " in record.get("reason", "") for kind in ("Error", "Warning", "Exception")
    )


def _accepted(chance: random.Random) -> tuple[str, Case]:
    """The text of a good file with extreme numbers, of few samples and time steps, and its case."""
    while True:
        text = case_files.extreme(chance).partition("[[expect]]")[0]
        text = text.replace(f"samples = {MAX_SAMPLES}", f"samples = {MOST_SAMPLES}")
        try:
            return text, parse(text, "hostile")
        except CaseFaults:
            continue
