"""The guard of a worker process, which ends all processes that the worker started, however the worker or its parent ends.

On Linux the started process forks before it imports slow modules. The child is the worker. The process itself is the guard: it
adopts every descendant whose own parent has ended, even outside the worker's group and session, and ends with the exit code or
the signal of the worker (`forking`). On other systems there is no guard, and only the worker's group ends with it.
"""

import contextlib
import signal
import subprocess
import sys

from bodycheck.processes import limits


def guarded(parent: int, descriptor: int | str) -> None:
    """Fork this process, if the system has guards, and return in the child, the worker; this process becomes its guard.

    parent: the identifier of the process that started this one. descriptor: the descriptor of the worker's end of the channel.
    """
    if sys.platform == "linux":
        from bodycheck.processes import forking

        limits.end_with(parent, signal.SIGTERM)
        forking.fork(int(descriptor))


def stop(process: "subprocess.Popen[bytes]", patience: float) -> None:
    """Kill a worker process and the processes that it started, and its guard if that does not end within `patience` (s)."""
    if sys.platform == "linux":
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(patience)
    limits.kill_group(process.pid)
    process.kill()
    process.wait()
