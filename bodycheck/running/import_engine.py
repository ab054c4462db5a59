"""What a worker process of an engine does before its first call."""

import contextlib

from bodycheck.adapters import registry


def import_engine(name: str) -> None:
    """Import an engine. If that raises an exception, each call raises it again."""
    with contextlib.suppress(registry.EngineMissing):
        registry.load(name)
