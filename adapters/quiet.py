"""Keep what is written in C from the terminal."""

import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

#: The file descriptors of standard output and standard error.
STDOUT, STDERR = 1, 2


@contextmanager
def no_stderr() -> Iterator[None]:
    """Discard what is written to standard error, by Python or in C, while this context lasts."""
    sys.stderr.flush()
    kept, nowhere = os.dup(STDERR), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, STDERR)
        yield
    finally:
        os.dup2(kept, STDERR)
        os.close(kept)
        os.close(nowhere)


@contextmanager
def overheard() -> Iterator[list[str]]:
    """Keep what is written to standard output and standard error while this context lasts; its lines are there afterwards."""
    lines: list[str] = []
    flush()
    kept = {stream: os.dup(stream) for stream in (STDOUT, STDERR)}
    with tempfile.TemporaryFile() as written:
        try:
            for stream in kept:
                os.dup2(written.fileno(), stream)
            yield lines
        finally:
            flush()
            for stream, copy in kept.items():
                os.dup2(copy, stream)
                os.close(copy)
            written.seek(0)
            lines += written.read().decode(errors="replace").splitlines()


def flush() -> None:
    """Write out what Python and the C library hold back of the two streams."""
    sys.stdout.flush()
    sys.stderr.flush()
    ctypes.CDLL(None).fflush(None)


def refusal(path: str, text: str) -> str:
    """Return the text of an engine that refuses a file, in one line, with the name of the file in place of its path."""
    return " ".join(text.replace(path, Path(path).name).split())
