"""What worker processes are made to do in tests. They import this module, which therefore imports nothing that is slow."""

import _thread
import contextlib
import ctypes
import ctypes.util
import gc
import os
import pickle
import platform
import random
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from bodycheck.processes.channel import Worker

#: What a call keeps when it has returned.
KEPT: list[bytearray] = []

#: Set when a process in which `poisoned` was called with "poison" makes its next call.
_next_call = threading.Event()
_poisoned = False


#: The groups for which this process was prepared.
_prepared: list[str] = []


def warning(text: str) -> None:
    """Warn with a text, as an engine may."""
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.warn(text, stacklevel=1)


def preparing(group: str) -> None:
    """Prepare the process for a group, which changes its environment."""
    _prepared.append(group)
    os.environ["PREPARED"] = group
    if group == "dies":
        os._exit(9)
    if group == "raises":
        raise ValueError(group)


def prepared_for(argument: str) -> tuple[str, int, int]:
    """For which group the process was prepared, how often, and which process it is."""
    return _prepared[0], len(_prepared), os.getpid()


def poisoned(argument: str) -> str:
    """Poison leaves a thread behind that ends the process while it makes the next call."""
    global _poisoned
    if argument == "poison":
        _poisoned = True
        threading.Thread(target=lambda: _next_call.wait() and os._exit(7), daemon=True).start()
    elif _poisoned:
        _next_call.set()
        time.sleep(600)
    return argument


def keeping(size: int) -> int:
    """Keep so many bytes for good."""
    KEPT.append(bytearray(size))
    return size


def without_looking(size: int) -> None:
    """What C code does that does not look at what malloc answers."""
    libc = ctypes.CDLL(None)
    libc.malloc.restype = ctypes.c_void_p
    libc.malloc.argtypes = (ctypes.c_size_t,)
    ctypes.memset(libc.malloc(size), 1, size)


def aborting(name: str) -> None:
    os.kill(os.getpid(), getattr(signal, name))


class Treacherous:
    """Can be sent, but not received."""

    def __reduce__(self) -> tuple[Any, ...]:
        return int, ("no number",)


def misbehaving(how: str) -> Any:
    if how == "closes its files":
        os.closerange(3, 256)
    if how == "closes its files and goes on":
        os.closerange(3, 256)
        time.sleep(600)
    if how == "writes into all descriptors":
        for descriptor in range(3, 256):
            with contextlib.suppress(OSError):
                os.write(descriptor, b"\x00\x10" * 512)
    if how == "makes a copy of the process" and (copy := os.fork()):
        os.waitpid(copy, 0)
    if how == "answers twice":
        (own,) = (found for found in gc.get_objects() if isinstance(found, Worker))
        own.send(1, pickle.dumps(("ghost", True)))
    if how == "cannot be sent":
        return lambda: None
    if how == "cannot be received":
        return Treacherous()
    if how == "speaks in no encoding":
        raise OSError(os.fsdecode(b"\xff"))
    return how


def whose_process(what: str) -> int:
    """The process that this is called in, unless it is to die or to hang."""
    if what == "die":
        os.kill(os.getpid(), signal.SIGSEGV)
    if what == "hang":
        time.sleep(600)
    poisoned(what)
    return os.getpid()


#: What a call changes in its process, by the name of the change.
CHANGES: dict[str, Callable[[], object]] = {
    "path": sys.path.clear,
    "environment": os.environ.clear,
    "folder": lambda: os.chdir("/"),
    "rounding": lambda: round_up(),
    "handler": lambda: signal.signal(signal.SIGTERM, signal.SIG_IGN),
    "handler in C": lambda: ctypes.CDLL(None).signal(signal.SIGUSR1, ctypes.c_void_p(1)),
    "seed": lambda: random.seed(1),
    "seed of numpy": lambda: np.random.seed(1),
    "faults": lambda: np.seterr(all="raise"),
    "thread": lambda: threading.Thread(target=time.sleep, args=(600,), daemon=True).start(),
}

#: What a call leaves behind that only a call after the first one in its process must not.
LATE_CHANGES: dict[str, Callable[[], object]] = {
    # Python's module `threading` knows nothing of it.
    "thread in C": lambda: _thread.start_new_thread(time.sleep, (600,)),
}


#: What leaves nothing behind.
NO_CHANGES: dict[str, Callable[[], object]] = {
    # The first thread of a process lets the C library handle a signal of its own.
    "thread that ends": lambda: _end_a_thread(),
}


def _end_a_thread() -> None:
    thread = threading.Thread(target=int)
    thread.start()
    thread.join()


def round_up() -> None:
    """Let the arithmetic of this process round towards plus infinity (FE_UPWARD of fenv.h)."""
    upward = {"x86_64": 0x800, "aarch64": 0x400000, "arm64": 0x400000}[platform.machine()]
    ctypes.CDLL(ctypes.util.find_library("m")).fesetround(upward)


def changing(what: str) -> int:
    """Change something for good, or nothing, and return the process."""
    (CHANGES | LATE_CHANGES | NO_CHANGES).get(what, int)()
    return os.getpid()


def leaving_children(how: str, pids: str) -> None:
    """Starts a process and a daemon, which has left the session of this process, for ten minutes; then returns or ends."""
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    said, saying = os.pipe()
    if not os.fork():
        os.setsid()
        if not os.fork():
            os.write(saying, f"{os.getpid()}".encode())
            time.sleep(600)
        os._exit(0)
    os.wait()
    with open(pids, "a") as file:
        file.write(f"{child.pid}\n{os.read(said, 100).decode()}\n")
    if how == "dies":
        os.kill(os.getpid(), signal.SIGSEGV)
    if how == "hangs":
        time.sleep(600)


def holding_the_interpreter(pids: str) -> None:
    """Hangs in C with the lock of the interpreter held, so that no other thread of the process runs."""
    with open(pids, "a") as file:
        file.write(f"{os.getpid()}\n")
    ctypes.PyDLL(None).sleep(600)


def truth_without_end(question: object) -> None:
    """Stands in for `bodycheck.running.tasks.answer`, and hangs in C; the variable PIDS names the file for its process."""
    holding_the_interpreter(os.environ["PIDS"])


def hanging_or_not(pids: str) -> None:
    if pids:
        holding_the_interpreter(pids)


def pids_in(path: str | Path, count: int, patience: float = 60.0) -> list[int]:
    """The processes in which `holding_the_interpreter` was called, once there are so many; a busy machine has a minute."""
    deadline = time.monotonic() + patience
    while len(pids := Path(path).read_text().split() if Path(path).exists() else []) < count:
        assert time.monotonic() < deadline, f"after {patience:g} s there are {len(pids)} processes of {count}"
        time.sleep(0.01)
    return list(map(int, pids))


def is_running(pid: int) -> bool:
    """Whether a process is there and has not ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def performed(argument: Any) -> set[str]:
    """The modules that this process has imported when it has carried out a task of `bodycheck.running.tasks`."""
    from bodycheck.running.tasks import perform

    perform(argument)
    return {name for name, module in sys.modules.items() if module is not None}
