"""A limit on the processor time of a part of a report, so that no results make a report without end."""

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from types import FrameType


class TookTooLong(Exception):
    """A part of a report took more processor time than it may."""


@contextlib.contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise `TookTooLong` in the context when this process has computed for some seconds in it.

    What waits for other processes does not count, so that the limit does not depend on how busy the machine is. There is no
    limit on Windows, which has no such timer, and in threads other than the main one, which receive no signals.
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
