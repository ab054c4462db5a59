"""Trials, each made of a seed in a folder of its own, in processes of their own whose deaths and hangs are failures.

A trial returns what is wrong as text, empty where all is as it should be; whatever it raises, a warning included, is wrong.
As a program, this module makes trials and writes a line at the begin and the end of each.
"""

import importlib
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.support import ROOT

#: What makes a trial. It has the seed and an empty folder.
Trial = Callable[[int, Path], str]

#: A trial that takes longer (s) hangs. Trials take seconds at most; a busy machine has a multiple of that.
PATIENCE_S = 300.0


@dataclass(frozen=True)
class Failure:
    """A trial that failed, and what it told."""

    trial: str
    seed: int
    problem: str

    def __str__(self) -> str:
        return f"seed {self.seed}: {self.problem}\n    repeat it: {repeating(self.trial, self.seed)}"


def repeating(trial: str, seed: int) -> str:
    """The command that repeats a trial."""
    return f"python -W error -m tests.adversary.trials {trial} {seed} 1"


def failures(trial: str, first: int, count: int) -> list[Failure]:
    """Which of so many trials failed, from a seed on.

    trial: the function, as MODULE:NAME with a module of `tests.adversary`.
    """
    print(f"{trial}: {count} seeds from {first} on")
    found: list[Failure] = []
    end = first + count
    while first < end:
        first = _batch(trial, first, end - first, found)
    print(f"{trial}: {count} tried, {len(found)} failed")
    return found


def _batch(trial: str, first: int, count: int, found: list[Failure]) -> int:
    """Make trials until they are done or their process dies or hangs; the seed of the next one to make."""
    command = [sys.executable, "-W", "error", "-m", "tests.adversary.trials", trial, str(first), str(count)]
    with (
        tempfile.TemporaryFile() as errors,
        tempfile.TemporaryDirectory(prefix="trials-") as folder,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=errors, cwd=ROOT, env=os.environ | {"TMPDIR": folder}
        ) as process,
    ):
        assert process.stdout is not None
        seed, hangs = first, False
        unread = b""
        while True:
            if not select.select([process.stdout], [], [], PATIENCE_S)[0]:
                process.kill()
                hangs = True
            unread += (read := os.read(process.stdout.fileno(), 1 << 16))
            *lines, unread = unread.split(b"\n")
            for line in lines:
                seed, problem = json.loads(line)
                if problem:
                    found.append(Failure(trial, seed, problem))
                seed += problem is not None  # None at its begin
            if not read:
                break
        if process.wait() == 0 and seed == first + count:
            return seed
        errors.seek(0)
        what = f"no end after {PATIENCE_S:g} s" if hangs else f"the process ended with {process.returncode}"
        found.append(Failure(trial, seed, f"{what}: {errors.read()[-3000:].decode(errors='replace')}"))
        return seed + 1


def _main(trial: str, first: str, count: str) -> None:
    module, _, name = trial.partition(":")
    make: Trial = getattr(importlib.import_module(f"tests.adversary.{module}"), name)
    with os.fdopen(os.dup(1), "w") as channel:
        os.dup2(2, 1)  # whatever else is printed is no line of the channel
        for seed in range(int(first), int(first) + int(count)):
            print(json.dumps([seed, None]), file=channel, flush=True)
            folder = Path(tempfile.mkdtemp(prefix=f"{seed}-"))
            try:
                problem = make(seed, folder)
            except Exception:
                problem = traceback.format_exc(limit=-12)
            shutil.rmtree(folder, ignore_errors=True)
            print(json.dumps([seed, problem]), file=channel, flush=True)


if __name__ == "__main__":
    _main(*sys.argv[1:])
