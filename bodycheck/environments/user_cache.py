"""The folder for files that bodycheck can make again: the user's cache folder, or the folder in a variable."""

import os
from pathlib import Path

from platformdirs import user_cache_path

#: The environment variable that names another cache folder.
VARIABLE = "BODYCHECK_CACHE"


def folder() -> Path:
    """Return the cache folder, which may not exist yet."""
    chosen = os.environ.get(VARIABLE)
    return Path(chosen).absolute() if chosen else user_cache_path("bodycheck")
