"""The program of a worker process: it reports that it has started, and answers one call after another."""

import math
import os
import pickle
import warnings
from collections.abc import Callable
from typing import Any

from bodycheck.processes import channel, limits
from bodycheck.processes.failures import crash
from bodycheck.processes.interpreter import inherited
from bodycheck.processes.process_state import state, threads
from bodycheck.runner_log import printable


def main(descriptor: int | str, mark: str, memory: int, watched: bool) -> None:
    """Answer the calls of the process that started this one until it closes the channel.

    A call consists of a function, its argument, and whether it prepares the process for further calls, for example by importing
    an engine. A preparation may change the state of the process. After any other call that changes it, the process is not used
    again.

    Parameters
    ----------
    descriptor
        The argument from which `bodycheck.processes.interpreter.inherited` makes the socket.
    mark
        The mark of messages, in hexadecimal digits.
    memory
        The memory that each call may use (bytes).
    watched
        Whether a thread that a call leaves counts as a change of the process.
    """
    with open(os.devnull, "rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    served, process = channel.Worker(inherited(descriptor), bytes.fromhex(mark)), os.getpid()
    warnings.formatwarning = _cleaned(warnings.formatwarning)
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=served.close)
    limits.allow_memory(memory)
    before = state()
    allowed: float = math.inf  # number of threads, until the first call after a preparation has ended
    try:
        served.send(0, pickle.dumps((None, True)))
        while True:
            number, message = served.receive()
            result, preparing = _made(message)
            if os.getpid() != process:  # the engine has made a copy of the process, and the copy must not answer
                os._exit(0)
            if preparing:
                limits.allow_memory(memory)
                before = state()
            changed = state() != before or threads() > allowed
            allowed = threads() if watched and not preparing else math.inf
            served.send(number, _pickled(result, reusable=not changed and not limits.keeps_much()))
    except (EOFError, ConnectionError):
        return  # the parent has ended


def _cleaned(formatted: Callable[..., str]) -> Callable[..., str]:
    """Return a function that makes the text of a warning, in which control characters and commands to runners are escaped."""

    def text(*warning: Any, **line: Any) -> str:
        return printable(formatted(*warning, **line))

    return text


def _made(message: bytes) -> tuple[Any, bool]:
    """Make the call in a message, and return its result and whether it prepares the process."""
    preparing = False
    try:
        function, argument, preparing = pickle.loads(message)
        with limits.limited_memory():
            return function(argument), preparing
    except BaseException as error:
        return crash(error), preparing


def _pickled(result: Any, reusable: bool) -> bytes:
    try:
        return pickle.dumps((result, reusable))
    except Exception as error:
        return pickle.dumps((crash(error), False))
