"""Terminals of a given size, for what commands print there."""

import io
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout

import pytest


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    def isatty(self) -> bool:
        return True

    @property
    def lines(self) -> list[str]:
        """What was printed, without the signs for bold letters."""
        return self.getvalue().replace("\033[1m", "").replace("\033[0m", "").splitlines()


@contextmanager
def terminal(columns: int, lines: int = 24) -> Iterator[Terminal]:
    """Stdout is a terminal of so many columns and lines while the context lasts."""
    stream = Terminal()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(stream):
        patch.setenv("COLUMNS", str(columns))
        patch.setenv("LINES", str(lines))
        yield stream
