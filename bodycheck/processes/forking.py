"""The worker of a process and its guard, which watches it and ends what it started: the part of `guard` that only Linux has."""

import contextlib
import os
import resource
import signal
import sys
import time
import warnings
from pathlib import Path

from bodycheck.processes import limits

assert sys.platform == "linux", "guards need the process functions of Linux"  # type checkers skip the rest elsewhere

#: Time limit for the end of killed processes (s). Processes of a program that has changed its user cannot be killed.
ENDING_S = 5.0

#: Polling interval while descendants are being killed (s).
INTERVAL_S = 0.002

#: The signals that wake the guard: a child has ended, or the guard itself must end.
WAKING = {signal.SIGCHLD, signal.SIGTERM}


def fork(descriptor: int) -> None:
    """Fork and return in the new process, the worker. The calling process becomes its guard and ends in this function."""
    limits.adopt_descendants()
    signal.pthread_sigmask(signal.SIG_BLOCK, WAKING)
    guard = os.getpid()
    with warnings.catch_warnings():
        # The import of a program's main module may have started threads; the worker does not use them.
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
    with contextlib.suppress(ChildProcessError):  # no child is left
        while time.monotonic() < deadline:
            status = _reaped().get(worker, status)
            for child in _children():
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(child, signal.SIGKILL)
            time.sleep(INTERVAL_S)
    return status or 0


def _reaped() -> dict[int, int]:
    """Return the statuses of the children that have ended. Raises `ChildProcessError` if there are no children at all."""
    statuses = dict([os.waitpid(-1, os.WNOHANG)])
    while 0 not in statuses:
        try:
            statuses.update([os.waitpid(-1, os.WNOHANG)])
        except ChildProcessError:  # no more children
            break
    return statuses


def _children() -> list[int]:
    """Return the processes whose parent is this process, including adopted ones."""
    guard, children = str(os.getpid()), []
    for process in Path("/proc").iterdir():
        with contextlib.suppress(OSError):  # it has ended meanwhile
            if process.name.isdigit() and (process / "stat").read_bytes().rpartition(b")")[2].split()[1] == guard.encode():
                children.append(int(process.name))
    return children


def _end_as(status: int) -> None:
    """End with the exit code or the signal of the worker."""
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # there is nothing to find in the memory of the guard
        if number != signal.SIGKILL:
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {number})
        os.kill(os.getpid(), number)
    os._exit(os.WEXITSTATUS(status))
