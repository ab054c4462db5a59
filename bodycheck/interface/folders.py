"""The folder of results: the one that the user gives, or a temporary one that exists as long as the results do."""

import weakref
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from bodycheck.files.temporary import temporary_folder


@dataclass(frozen=True)
class Kept:
    """A folder, and what removes it if it is temporary."""

    folder: Path
    stack: ExitStack

    def keep_for(self, owner: object) -> None:
        """Keep the folder until an object is collected, or this process ends."""
        weakref.finalize(owner, self.stack.pop_all().close)


@contextmanager
def kept(out: Path | None) -> Iterator[Kept]:
    """Provide a folder. A temporary one is removed at the end of the context, unless it is kept with an object."""
    with ExitStack() as stack:
        yield Kept(out or stack.enter_context(temporary_folder()), stack)
