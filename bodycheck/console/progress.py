"""Show the progress of a long command on stderr: as a bar on a terminal, else as a line from time to time."""

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bodycheck.running.campaign import Advance

#: Time between two lines if stderr is not a terminal (s).
INTERVAL_S = 4.0


@dataclass
class Count:
    """The completed part of some work, for lines in a file or in the log of a CI job.

    Attributes
    ----------
    title
        A name of the work.
    total
        The number of all units.
    clock
        Function that returns the time (s).
    done, before, last
        The number of completed units, how many of them were completed before the start, and a text about the last one.
    """

    title: str
    total: int
    clock: Callable[[], float] = time.monotonic
    done: int = 0
    before: int = 0
    last: str = ""
    start: float = field(init=False)

    def __post_init__(self) -> None:
        self.start = self.clock()

    def advance(self, last: str, count: int = 1, /) -> None:
        """Count completed units. last: a text about the last one; empty for units that were completed before."""
        self.done += count
        self.before += 0 if last else count
        self.last = last or self.last

    @property
    def text(self) -> str:
        """The completed part, the elapsed time and the estimated remaining time, in one line."""
        elapsed = self.clock() - self.start
        text = f"{self.title}: {self.done} of {self.total} after {elapsed:.0f} s"
        if completed := self.done - self.before:
            text += f", about {elapsed / completed * (self.total - self.done):.0f} s left"
        return f"{text}, last {self.last}" if self.last else text


@contextmanager
def progress(title: str, total: int, quiet: bool = False) -> "Iterator[Advance]":
    """Show progress on stderr while the context lasts.

    The context provides a function that counts completed work. Its arguments are a text about the last unit, and the number of
    completed units (1 by default).

    Parameters
    ----------
    title
        A name of the work.
    total
        The number of all units.
    quiet
        Whether nothing is shown.
    """
    count = Count(title, total)
    if quiet:
        yield count.advance
    elif sys.stderr.isatty():
        with _bar(title, total) as advance:
            yield advance
    else:
        with _repeated(lambda: print(count.text + "\n", end="", file=sys.stderr, flush=True)):
            yield count.advance


@contextmanager
def _bar(title: str, total: int) -> "Iterator[Advance]":
    # Only a terminal needs it.
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    times = (TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn())
    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), *times, TextColumn("{task.fields[last]}"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=total, last="")

        def advance(last: str, count: int = 1, /) -> None:
            bar.update(task, advance=count, last=escape(last))

        yield advance


@contextmanager
def _repeated(action: Callable[[], None]) -> Iterator[None]:
    """Repeat an action every `INTERVAL_S` in a separate thread while the context lasts, even during a single long run."""
    ended = threading.Event()

    def repeat() -> None:
        while not ended.wait(INTERVAL_S):
            action()

    thread = threading.Thread(target=repeat, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
