"""The guard of a worker process, which ends everything that the worker has started, however the worker or its parent ends.

On Linux the started process forks before it imports what is slow. The child is the worker. The process itself is the guard: it
adopts every descendant whose own parent has ended, also those that have left the worker's group and session, and ends with
the exit code or the signal of the worker. On other systems there is no guard, and only the worker's group ends with it.
"""

import contextlib
import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

from bodycheck.processes import limits

if sys.platform != "win32":
    import resource

#: Whether worker processes have guards.
GUARDED = sys.platform == "linux"

#: Time limit for the end of killed processes. Those of a program that has changed its user cannot be killed.
ENDING_S = 5.0

#: Polling interval while descendants are being killed (s).
INTERVAL_S = 0.002

#: What wakes the guard: a process of its own has ended, or it is to end itself.
WAKING = {signal.SIGCHLD, signal.SIGTERM} if GUARDED else set()


def guarded(parent: int, descriptor: int | str) -> None:
    """Return in a worker process, whose guard is the process that this one was.

    parent: the identifier of the process that started this one. descriptor: that of the worker's end of the channel.
    """
    if GUARDED:
        limits.end_with(parent, signal.SIGTERM)
        _fork(int(descriptor))


def stop(process: "subprocess.Popen[bytes]", patience: float) -> None:
    """Kill a worker process and what it has started; a guard that does not end within its patience (s) is killed."""
    if GUARDED:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(patience)
    limits.kill_group(process.pid)
    process.kill()
    process.wait()


def _fork(descriptor: int) -> None:
    """Return in a new process, the worker. This one is its guard and ends here."""
    limits.adopt_descendants()
    signal.pthread_sigmask(signal.SIG_BLOCK, WAKING)
    guard = os.getpid()
    with warnings.catch_warnings():
        # A program may have threads that it began when its main module was imported; the worker does not use them.
        warnings.simplefilter("ignore", DeprecationWarning)
        worker = os.fork()
    if worker:
        os.close(descriptor)
        try:
            _end_as(_ending(worker))
        finally:
            os._exit(1)
    limits.end_with(guard, signal.SIGKILL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, WAKING)


def _ending(worker: int) -> int:
    """Wait for the end of the worker or for the request to end; end all descendants, and return the status of the worker."""
    status = None
    while status is None and signal.sigwaitinfo(WAKING).si_signo != signal.SIGTERM:
        status = _reaped().get(worker)
    deadline = time.monotonic() + ENDING_S
    with contextlib.suppress(ChildProcessError):  # none is left
        while time.monotonic() < deadline:
            status = _reaped().get(worker, status)
            for child in _children():
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(child, signal.SIGKILL)
            time.sleep(INTERVAL_S)
    return status or 0


def _reaped() -> dict[int, int]:
    """The statuses of the children that have ended. Raises `ChildProcessError` if there is none, ended or not."""
    statuses = dict([os.waitpid(-1, os.WNOHANG)])
    while 0 not in statuses:
        try:
            statuses.update([os.waitpid(-1, os.WNOHANG)])
        except ChildProcessError:  # those were all
            break
    return statuses


def _children() -> list[int]:
    """The processes whose parent is this one, those that have been adopted included."""
    guard, children = str(os.getpid()), []
    for process in Path("/proc").iterdir():
        with contextlib.suppress(OSError):  # gone meanwhile
            if process.name.isdigit() and (process / "stat").read_bytes().rpartition(b")")[2].split()[1] == guard.encode():
                children.append(int(process.name))
    return children


def _end_as(status: int) -> None:
    """End as the worker has ended."""
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # there is nothing to find in the memory of the guard
        if number != signal.SIGKILL:
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {number})
        os.kill(os.getpid(), number)
    os._exit(os.WEXITSTATUS(status))
