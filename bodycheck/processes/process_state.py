"""The state of a process that one call can change for the next call."""

import os
import random
import signal
import sys
import threading
from collections.abc import Hashable
from pathlib import Path

import numpy as np

#: Pairs whose quotients differ if rounding is directed, and a pair whose quotient is zero if small numbers are flushed to zero.
_ROUNDED, _SMALL = ((1.0, 3.0), (-1.0, 3.0)), ((sys.float_info.min, 3.0),)

#: All signals, in a fixed order.
_SIGNALS = tuple(sorted(signal.valid_signals()))

#: The mask of these signals, in which bit n - 1 stands for signal n.
_USABLE = sum(1 << (number - 1) for number in _SIGNALS)


def rounding() -> Hashable:
    """Return numbers that depend on the rounding mode of floating-point arithmetic."""
    return tuple(one / other for one, other in _ROUNDED)


#: The result of `rounding` for rounding to nearest, which is the mode when a process begins.
TO_NEAREST = rounding()


def state() -> tuple[Hashable, ...]:
    """Return the state that a call may change for the next call; the states are equal if nothing was changed.

    The state consists of the paths of imports, the environment, the working directory, the mode of floating-point arithmetic
    and the handling of its errors, the handlers of signals, the global generators of random numbers, and the number of Python's
    threads. For other threads see `threads`.
    """
    return (
        tuple(sys.path),
        tuple(sorted(os.environ.items())),
        _working_directory(),
        rounding(),
        tuple(one / other for one, other in _SMALL),
        tuple(np.reciprocal(np.array([3.0, -3.0, 1e308 * 1.7])).tolist()),
        tuple(np.geterr().items()),
        tuple(map(_handler, _SIGNALS)),
        random.getstate(),
        _numpy_generator(),
        threading.active_count(),
        _masks_of_signals(),
    )


def threads() -> int:
    """Return the number of all threads of the process, including threads of C libraries (on Linux; otherwise 0).

    The first call in a process may add threads, because many libraries keep the threads that they start when they are imported.
    """
    try:
        return len(os.listdir("/proc/self/task"))
    except OSError:
        return 0


def _working_directory() -> str | None:
    try:
        return os.getcwd()
    except OSError:  # the directory was removed
        return None


def _handler(number: int) -> str:
    return repr(signal.getsignal(number))


def _numpy_generator() -> tuple[Hashable, ...]:
    name, key, *rest = np.random.get_state(legacy=True)
    return name, np.asarray(key).tobytes(), *rest


def _masks_of_signals() -> tuple[str, ...]:
    """Return which signals are blocked, ignored and handled, also by C code; empty if the system does not report it.

    Signals that the C library reserves are left out: it begins to handle such a signal when a process starts its first thread.
    """
    try:
        lines = Path("/proc/self/status").read_text("ascii", "replace").splitlines()
    except OSError:
        return ()
    masks = (line.split(":") for line in lines if line.startswith(("SigBlk:", "SigIgn:", "SigCgt:")))
    return tuple(f"{name}: {int(mask, 16) & _USABLE:x}" for name, mask in masks)
