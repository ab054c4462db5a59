"""Operating-system limits for worker processes: a memory cap (RLIMIT_DATA) and termination with the parent (Linux).

On other systems memory is not limited, and a process that outlives its parent ends after its current call.
"""

import contextlib
import ctypes
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

from bodycheck.environments.subprocesses import PR_SET_PDEATHSIG

if sys.platform != "win32":
    import resource

#: From linux/prctl.h.
PR_SET_CHILD_SUBREAPER = 36

_allowance_bytes: int | None = None
_initial_bytes = 0


def allow_memory(allowance: int) -> None:
    """Set the allowance in bytes that `limited_memory` enforces from now on."""
    global _allowance_bytes, _initial_bytes
    with contextlib.suppress(OSError):  # a system that does not report memory use cannot limit it either
        _initial_bytes = _memory_in_use()
        _allowance_bytes = allowance


@contextlib.contextmanager
def limited_memory() -> Iterator[None]:
    """Limit the memory that the process can allocate within the context to the allowance.

    An allocation beyond the limit fails: with a MemoryError in Python, and a null pointer in C. The limit counts private
    writable memory (RLIMIT_DATA), whether it is used or not, but not reserved addresses, mapped files, shared memory, or GPU
    memory.
    """
    if sys.platform == "win32" or _allowance_bytes is None:
        yield
    else:
        before = soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
        others = [limit for limit in before if limit != resource.RLIM_INFINITY]
        resource.setrlimit(resource.RLIMIT_DATA, (min([_memory_in_use() + _allowance_bytes, *others]), hard))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def keeps_much() -> bool:
    """Return whether the process has accumulated more than half of its memory allowance."""
    return _allowance_bytes is not None and _memory_in_use() - _initial_bytes > _allowance_bytes / 2


def shortage() -> str:
    """Return the error message for a `MemoryError`."""
    return (
        f"it ran out of its memory of {_allowance_bytes / (1 << 30):g} GiB"
        if _allowance_bytes is not None
        else "it ran out of memory"
    )


def end_with(parent: int, number: signal.Signals) -> None:
    """Let the system send this process a signal when the parent's thread that started it ends for any reason."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, number)
        if os.getppid() != parent:  # the parent ended before the request took effect
            os._exit(0)


def adopt_descendants() -> None:
    """Become the parent of every descendant whose own parent has ended (Linux)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)


def kill_group(leader: int) -> None:
    """Kill the remaining processes of a leader's group, before or after the end of the leader."""
    if sys.platform != "win32":
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, signal.SIGKILL)


def _memory_in_use() -> int:
    """Return the private writable memory of this process in bytes. Raises `OSError` where there is no /proc."""
    if sys.platform != "win32":
        pages = Path("/proc/self/statm").read_text("ascii").split()[5]
        return int(pages) * resource.getpagesize()
    raise OSError("Windows has no /proc")
