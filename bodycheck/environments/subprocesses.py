"""Run a program that ends when this process does, even if this process is killed.

On Linux, the kernel ends the program and limits its memory. On other systems, a time limit or an interruption ends the program,
and its memory is not limited.
"""

import contextlib
import ctypes
import os
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from subprocess import DEVNULL, PIPE, CompletedProcess, Popen

if sys.platform != "win32":
    import resource

#: From linux/prctl.h.
PR_SET_PDEATHSIG = 1

#: Private memory (bytes) that a program may use unless another limit is given.
MEMORY_LIMIT_BYTES = 4 << 30


def run(
    command: Sequence[str], variables: Mapping[str, str], stdin: str | None, timeout: float, memory: int | None = None
) -> CompletedProcess[str]:
    """Run a command to its end and return its exit code, stdout and stderr.

    Parameters
    ----------
    command
        The program and its arguments.
    variables
        All environment variables of the program.
    stdin
        The text of its standard input; None for an empty one.
    timeout
        Seconds after which the program and the processes that it started are killed.
    memory
        Bytes of private memory that it may use (RLIMIT_DATA, Linux); None for no limit.

    Raises
    ------
    subprocess.TimeoutExpired
        It took longer than `timeout`.
    OSError
        It cannot be started.
    """
    with Popen(
        command,
        stdin=DEVNULL if stdin is None else PIPE,
        stdout=PIPE,
        stderr=PIPE,
        env=dict(variables),
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
        preexec_fn=_before_exec(memory),
    ) as process:
        try:
            stdout, stderr = process.communicate(stdin, timeout)
        except BaseException:
            _kill(process)
            raise
    return CompletedProcess(command, process.returncode, stdout, stderr)


def _before_exec(memory: int | None) -> Callable[[], None] | None:
    """Return a function for the child process before it executes the program, so that it ends with its parent."""
    if sys.platform != "linux":
        return None
    libc, parent = ctypes.CDLL(None), os.getpid()

    def bind() -> None:
        libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:  # the parent ended before the request took effect
            os._exit(1)
        if sys.platform != "win32" and memory is not None:
            _, hard = resource.getrlimit(resource.RLIMIT_DATA)
            resource.setrlimit(resource.RLIMIT_DATA, (memory, hard))

    return bind


def _kill(process: Popen[str]) -> None:
    """Kill a process and the processes that it started."""
    if sys.platform == "win32":
        process.kill()
        return
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
