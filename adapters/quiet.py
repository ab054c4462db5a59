"""Keep the output of C code from the terminal."""

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
    """Discard all output to standard error, of Python or of C code, while this context lasts."""
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
    """Capture all output to standard output and standard error while this context lasts.

    The context yields a list that is empty at first, and that contains the lines of the output after the context has ended.
    """
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
    """Flush the buffers of Python and of the C library for standard output and standard error."""
    sys.stdout.flush()
    sys.stderr.flush()
    ctypes.CDLL(None).fflush(None)


def refusal(path: str, text: str) -> str:
    """Return the message by which an engine refuses a file, in one line, with the name of the file in place of its path."""
    return " ".join(text.replace(path, Path(path).name).split())
