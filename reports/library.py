"""The script of Vega, Vega-Lite and Vega-Embed, which the pages of reports contain.

Bundling the script takes a second and a half of processor time, longer than everything else in most reports. It is therefore
stored in the cache folder.
"""

from functools import cache
from hashlib import sha256
from importlib.metadata import version

import vl_convert

from bodycheck.environments import user_cache

#: The statement that the script executes after the libraries.
ENTRY = "window.vegaEmbed = vegaEmbed;"


@cache
def script() -> str:
    """Return the script, which defines `vegaEmbed`."""
    name = _name()
    if (entry := user_cache.kept(name)) is not None:
        return entry.text
    made = str(vl_convert.javascript_bundle(ENTRY))
    user_cache.keep(name, made)
    return made


def _name() -> str:
    """Return the name in the cache of the script of this release of vl-convert."""
    return f"scripts/vega-{version('vl-convert-python')}-{sha256(ENTRY.encode()).hexdigest()[:8]}.js"
