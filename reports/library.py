"""The script of Vega, Vega-Lite and Vega-Embed, which the pages of reports contain.

Bundling the script takes a second and a half of processor time, longer than everything else in most reports. It is therefore
stored in the cache folder.
"""

import contextlib
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

import vl_convert

from bodycheck.environments import privacy, user_cache
from bodycheck.files import writing

#: The statement that the script executes after the libraries.
ENTRY = "window.vegaEmbed = vegaEmbed;"


@cache
def script() -> str:
    """Return the script, which defines `vegaEmbed`."""
    path = _file()
    if (kept := _kept(path)) is not None:
        return kept
    made = str(vl_convert.javascript_bundle(ENTRY))
    _keep(path, made)
    return made


def _file() -> Path:
    """Return the path in the cache folder of the script of this release of vl-convert."""
    return user_cache.folder() / "scripts" / f"vega-{version('vl-convert-python')}.js"


def _kept(path: Path) -> str | None:
    """Return the stored script; None if it is missing or damaged, or if another user may have written it.

    The file begins with a comment that has the digest of the rest.
    """
    try:
        if privacy.open_to_others(path) is not None:
            return None
        digest, _, found = path.read_text("utf-8").partition("\n")
        return found if digest == _digest(found) else None
    except (OSError, ValueError):
        return None


def _keep(path: Path, made: str) -> None:
    """Store the script if the cache folder is writable."""
    with contextlib.suppress(OSError, writing.NotWritten):
        privacy.make(path.parent)
        writing.write(path, f"{_digest(made)}\n{made}".encode())


def _digest(text: str) -> str:
    return f"// {ENTRY} sha256 {sha256(text.encode()).hexdigest()}"
