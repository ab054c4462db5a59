"""Let bodycheck take this system for another one, in this process and in all processes that it starts.

The folder of this file is put into PYTHONPATH, and Python imports it at its start. `EMULATED` names the system, as
`sys.platform` does there. What bodycheck uses of the standard library and of other packages is imported before, as it is here:
only bodycheck's own decisions are those of the other system. There is no `/proc`, and on Windows there are no modules and
functions of POSIX.
"""

import ctypes
import multiprocessing.connection
import multiprocessing.util
import os
import platform
import signal
import socket
import subprocess
import sys
import tempfile
from typing import Any

import cyclopts
import filelock
import jinja2
import numpy
import platformdirs
import pyarrow.parquet
import pydantic
import rich.console
import scipy.integrate

IMPORTED = (
    *(multiprocessing.connection, multiprocessing.util, platform, subprocess, tempfile),
    *(cyclopts, filelock, jinja2, numpy, platformdirs, pyarrow.parquet, pydantic, rich.console, scipy.integrate),
)

#: Modules of the standard library, and attributes of `os` and `signal`, that Windows lacks and bodycheck must not use there.
MODULES = ("fcntl", "resource", "pwd", "grp", "termios", "pty")
ATTRIBUTES: tuple[tuple[Any, tuple[str, ...]], ...] = (
    (os, ("fork", "killpg", "setsid", "getpgid", "sysconf", "WNOHANG")),
    (signal, ("SIGVTALRM", "SIGALRM", "SIGCHLD", "SIGHUP", "pthread_sigmask", "sigwaitinfo", "setitimer")),
)

#: The number of the system call that duplicates a descriptor of another process.
PIDFD_GETFD = 438


def refuse_proc(event: str, arguments: tuple[Any, ...]) -> None:
    """Refuse to open or list what is in /proc."""
    if event in ("open", "os.listdir", "os.scandir") and str(arguments[0]).startswith("/proc"):
        raise FileNotFoundError(2, "No such file or directory", arguments[0])


def share(shared: socket.socket, process: int) -> bytes:
    """Return what another process needs to get a socket, as on Windows."""
    return b"%d %d" % (os.getpid(), os.dup(shared.fileno()))


def from_share(data: bytes) -> socket.socket:
    """Return the socket that another process shares."""
    process, descriptor = map(int, data.split())
    other = os.pidfd_open(process)
    ours = ctypes.CDLL(None, use_errno=True).syscall(PIDFD_GETFD, other, descriptor, 0)
    os.close(other)
    return socket.socket(fileno=ours)


if emulated := os.environ.get("EMULATED"):
    sys.addaudithook(refuse_proc)
    if emulated == "win32":
        socket.socket.share = share  # type: ignore[method-assign]
        socket.fromshare = from_share
        sys.modules.update(dict.fromkeys(MODULES))  # type: ignore[arg-type]
        for module, names in ATTRIBUTES:
            for name in names:
                delattr(module, name)
    sys.platform = emulated
