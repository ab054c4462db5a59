"""What a process may take, held by the system itself whatever the code in the process does: memory, and no life after its
parent's.

Linux holds both. Elsewhere memory is not limited, and a process outlives its parent until the call that it is in ends.
"""

import contextlib
import ctypes
import multiprocessing
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

if sys.platform != "win32":
    import resource

#: From linux/prctl.h.
PR_SET_PDEATHSIG = 1

_allowance: int | None = None
_at_first = 0


def allow_memory(allowance: int) -> None:
    """From now on `limited_memory` limits to so many bytes."""
    global _allowance, _at_first
    with contextlib.suppress(OSError):  # a system that does not tell what is in use cannot hold the limit either
        _at_first = _memory_in_use()
        _allowance = allowance


@contextlib.contextmanager
def limited_memory() -> Iterator[None]:
    """In this context the process may take as much more memory as was allowed, and no more.

    What asks for more gets none: a MemoryError in Python, a null pointer in C. Counted is private memory that can be written
    (RLIMIT_DATA), touched or not. Reserved addresses, mapped files, shared memory and a GPU's are not.
    """
    if _allowance is None:
        yield
        return
    before = soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    others = [limit for limit in before if limit != resource.RLIM_INFINITY]
    resource.setrlimit(resource.RLIMIT_DATA, (min([_memory_in_use() + _allowance, *others]), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def keeps_much() -> bool:
    """Whether this process has come to hold more than half of what it may take at a time."""
    return _allowance is not None and _memory_in_use() - _at_first > _allowance / 2


def shortage() -> str:
    """What there is to say of a MemoryError."""
    return f"it ran out of its memory of {_allowance / (1 << 30):g} GiB" if _allowance is not None else "it ran out of memory"


def die_with_parent() -> None:
    """Have the system kill this process when the thread that started it ends, however that ends."""
    parent = multiprocessing.parent_process()
    if sys.platform == "linux" and parent is not None:
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent.pid:  # it ended before this was asked for
            os._exit(0)


def _memory_in_use() -> int:
    """Bytes of private memory that this process can write."""
    pages = Path("/proc/self/statm").read_text("ascii").split()[5]
    return int(pages) * os.sysconf("SC_PAGE_SIZE")
