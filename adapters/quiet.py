"""Keep what is written in C from the terminal."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

#: The file descriptor of standard error.
STDERR = 2


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
