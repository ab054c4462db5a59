"""A limit on the processor time of a part of a report, so that no results can make a report take forever."""

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from types import FrameType


class TookTooLong(Exception):
    """The exception for a part of a report that takes more processor time than allowed."""


@contextlib.contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise `TookTooLong` inside the context once this process has used more than `seconds` of processor time in it.

    Waiting for other processes does not count, so the limit does not depend on the load of the machine. There is no limit on
    Windows, which has no such timer, and in threads other than the main thread, which receive no signals.
    """
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, frame: FrameType | None) -> None:
        raise TookTooLong(f"more than {seconds:g} s")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
