"""Real clusters of Dask on this machine: a scheduler and workers that are processes of their own, which a test can kill."""

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from distributed import Client

#: Time limit for the start of a cluster (s).
START_S = 60.0


@dataclass
class Cluster:
    """A scheduler, and workers with nannies that start another worker in the place of one that was killed.

    Attributes
    ----------
    address
        The address of the scheduler.
    scheduler, nannies
        Their processes.
    """

    address: str
    scheduler: "subprocess.Popen[bytes]"
    nannies: list["subprocess.Popen[bytes]"]

    def pids(self) -> dict[str, int]:
        """The identifiers of the processes of the workers that are there, by their addresses."""
        with Client(self.address, timeout=START_S, set_as_default=False) as client:
            found: dict[str, int] = client.run(os.getpid, on_error="ignore")
        return found

    def kill_workers(self, count: int, chance: random.Random) -> int:
        """Kill some of the workers, once so many are there again; return how many there were to be killed."""
        deadline = time.monotonic() + START_S
        while len(pids := sorted(self.pids().values())) < count and time.monotonic() < deadline:
            time.sleep(0.2)
        chosen = chance.sample(pids, min(count, len(pids)))
        for pid in chosen:
            os.kill(pid, signal.SIGKILL)
        return len(chosen)

    def kill_scheduler(self) -> None:
        """Kill the scheduler, and wait for its end."""
        self.scheduler.kill()
        self.scheduler.wait()


def _address(file: Path) -> str | None:
    """The address of a scheduler in its file; None while the file is not there or not yet whole."""
    try:
        return str(json.loads(file.read_text())["address"])
    except (FileNotFoundError, json.JSONDecodeError):
        return None


@contextlib.contextmanager
def cluster(folder: Path, workers: int = 2, environment: Mapping[str, str] | None = None) -> Iterator[Cluster]:
    """A cluster with some workers of one thread each. environment: variables of its processes."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    variables = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)} | dict(environment or {})

    def start(*arguments: str) -> "subprocess.Popen[bytes]":
        command = [sys.executable, "-m", "dask", *arguments, "--scheduler-file", str(file), "--no-dashboard"]
        streams = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.Popen(command, cwd=folder, env=variables, start_new_session=True, **streams)

    started = [start("scheduler", "--port", "0", "--host", "127.0.0.1")]
    try:
        options = ("--nthreads", "1", "--death-timeout", "30", "--local-directory", str(folder))
        started += [start("worker", *options) for _ in range(workers)]
        deadline = time.monotonic() + START_S
        while (address := _address(file)) is None:
            assert time.monotonic() < deadline
            time.sleep(0.05)
        made = Cluster(address, started[0], started[1:])
        with Client(made.address, timeout=START_S, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=START_S)
        yield made
    finally:
        for process in reversed(started):
            process.terminate()
        for process in reversed(started):
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(2.0)
            with contextlib.suppress(ProcessLookupError):  # its workers too, which it may have left
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
