"""Escape printed text so that the runners of CI systems, which read the log of a job, find no commands in it.

A runner of GitHub acts on a line that begins with `::`, even after white space, and on `##[` anywhere in a line. Runners of
Azure and TeamCity act on `##vso[` and `##teamcity[`. The names of files and the texts of case files and results may come from
strangers. The second character of each such mark is therefore printed as an escape, which has the same meaning in JSON and
TOML.

A terminal is not the log of a runner, so text that is printed there keeps such marks. Control characters in the texts of
strangers act on a terminal too, and `escaped` escapes them.
"""

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TextIO

#: The beginning of a command: two characters, of which the second is escaped, and the characters that may precede them.
COMMAND = re.compile(r"((?:\A|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029])[\s\ufeff\u200b]*:):|(#)#(?=\w*\[)")


def harmless(text: str) -> str:
    """Return a text of whole lines in which no runner finds a command."""
    return COMMAND.sub(lambda match: rf"{match[1]}\u003a" if match[1] else rf"{match[2]}\u0023", text)


def escaped(text: str) -> str:
    """Return a text of whole lines with control characters escaped, which would otherwise act on a terminal."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode("ascii") for c in text)


def printable(text: str) -> str:
    """Return a text of whole lines with control characters and commands to runners escaped."""
    return harmless(escaped(text))


class ReaderGone(Exception):
    """The program that read the output has ended, such as `head` after its last line."""


class Guarded:
    """A stream that passes whole lines through `harmless` and writes them to another stream.

    `write`, `flush` and `finish` raise `ReaderGone` if that stream is a pipe without a reader.
    """

    def __init__(self, stream: TextIO) -> None:
        self.stream = stream
        self.line = ""

    def write(self, text: str) -> int:
        """Write the complete lines of a text, and keep an incomplete last line: a command may be written in parts."""
        lines, newline, self.line = (self.line + text).rpartition("\n")
        if newline:
            with _read():
                self.stream.write(harmless(lines + newline))
        return len(text)

    def flush(self) -> None:
        """Flush the other stream. An incomplete last line is kept."""
        with _read():
            self.stream.flush()

    def finish(self) -> None:
        """Write the last line if it is incomplete."""
        if self.line:
            with _read():
                self.stream.write(harmless(self.line))
            self.line = ""

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


@contextmanager
def _read() -> Iterator[None]:
    """Turn the error of a pipe without a reader into `ReaderGone`, which no handler of other pipes catches."""
    try:
        yield
    except BrokenPipeError as error:
        raise ReaderGone from error


@contextmanager
def guarded() -> Iterator[None]:
    """Replace stdout and stderr by guarded streams while the context lasts, unless they are terminals."""
    before = sys.stdout, sys.stderr
    guards = [stream if stream.isatty() else Guarded(stream) for stream in before]
    sys.stdout, sys.stderr = guards
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before
        for guard in guards:
            if isinstance(guard, Guarded):
                guard.finish()


def print_command(command: str) -> None:
    """Print a command for the runner on stderr: it must be one line whose data are escaped."""
    print(command, file=sys.stderr.stream if isinstance(sys.stderr, Guarded) else sys.stderr)
