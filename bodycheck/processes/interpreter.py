"""Python interpreters in which worker processes run: this one, and those of the environments of engines."""

import base64
import contextlib
import json
import os
import socket
import subprocess
import sys
from dataclasses import dataclass
from importlib.util import cache_from_source
from pathlib import Path

#: The first code of a worker process: it reads its instructions, and sets the paths of imports and the folder of bytecode.
BOOT = """
import json, sys
told = json.loads(sys.stdin.buffer.readline())
sys.path[:] = told.pop("path") or sys.path
if bytecode := told.pop("bytecode"):
    sys.pycache_prefix, sys.dont_write_bytecode = bytecode, False
from bodycheck.processes.guard import guarded
guarded(told.pop("parent"), told["descriptor"])
from bodycheck.processes.worker import main
main(**told)
"""


@dataclass(frozen=True)
class Interpreter:
    """A Python interpreter that has bodycheck and the packages of an engine.

    Parameters
    ----------
    python
        The path of the program.
    variables
        Environment variables of its processes in addition to the variables of this process.
    apart
        Whether it ignores `PYTHONPATH` and `PYTHONHOME`, so that it imports from its own path.
    """

    python: Path
    variables: tuple[tuple[str, str], ...] = ()
    apart: bool = True

    def start(self, theirs: socket.socket, mark: bytes, memory: int, watched: bool) -> "subprocess.Popen[bytes]":
        """Start `bodycheck.processes.worker.main` in a new process, and return the process.

        The process leads its own session, so that an interruption from the terminal does not reach it. It inherits no
        descriptor of this process but the socket. Its output goes to stderr, because stdout is for results.

        Parameters
        ----------
        theirs, mark
            The worker's end of its channel, and the mark of messages.
        memory
            The memory that each of its calls may use (bytes).
        watched
            Whether a thread that a call leaves counts as a change of the process.

        Raises
        ------
        OSError
            The interpreter cannot be run.
        """
        alone = ["-E"] if self.apart else []  # PYTHONPATH and PYTHONHOME are for this interpreter
        process = subprocess.Popen(
            [str(self.python), "-P", *alone, *(f"-W{option}" for option in sys.warnoptions), "-c", BOOT],
            stdin=subprocess.PIPE,
            stdout=2,
            env={**os.environ, **dict(self.variables)},
            start_new_session=True,
            pass_fds=() if sys.platform == "win32" else (theirs.fileno(),),
        )
        settings = {
            "path": None if self.apart else sys.path,
            "bytecode": bytecode_folder(),
            "parent": os.getpid(),
            "descriptor": _shared(theirs, process.pid),
            "mark": mark.hex(),
            "memory": memory,
            "watched": watched,
        }
        assert process.stdin is not None
        with contextlib.suppress(OSError), process.stdin as stdin:  # a process that has ended already is seen by its channel
            stdin.write(json.dumps(settings).encode("utf-8") + b"\n")
        return process


def bytecode_folder() -> str | None:
    """Return the folder in the cache for the bytecode of worker processes; None if bytecode is beside the modules.

    If Python is configured to write no bytecode, and modules were not compiled when they were installed, every worker would
    otherwise parse them again. The folder is not used if anybody else can read or change it.
    """
    if not sys.dont_write_bytecode or os.path.exists(cache_from_source(__file__)):
        return None
    from bodycheck.environments import privacy, user_cache  # workers import this module too, but need neither

    folder = user_cache.folder() / "bytecode"
    try:
        privacy.make(folder)
        return str(folder) if privacy.is_closed(folder) else None
    except OSError:
        return None


def _shared(theirs: socket.socket, process: int) -> int | str:
    """Return the argument for `inherited` in a process: a descriptor, or on Windows an encoded description."""
    if sys.platform == "win32":
        return base64.b64encode(theirs.share(process)).decode("ascii")
    return theirs.fileno()


def inherited(descriptor: int | str) -> socket.socket:
    """Return the socket that this process inherited from the process that started it."""
    if sys.platform == "win32":
        return socket.fromshare(base64.b64decode(str(descriptor)))
    return socket.socket(fileno=int(descriptor))


#: The interpreter of this process. Its workers import from the same folders as this process.
HERE = Interpreter(Path(sys.executable), apart=False)
