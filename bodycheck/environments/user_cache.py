"""The folder in which bodycheck keeps what it can make again: the user's cache folder, or the one that a variable names."""

import os
from pathlib import Path

from platformdirs import user_cache_path

#: The environment variable that names another folder.
VARIABLE = "BODYCHECK_CACHE"


def folder() -> Path:
    """Return the cache folder, which may not exist yet."""
    chosen = os.environ.get(VARIABLE)
    return Path(chosen).absolute() if chosen else user_cache_path("bodycheck")
