"""The player of motions: its script and its style, for pages with animations."""

from collections.abc import Iterable, Mapping
from importlib import resources
from typing import Any

#: The files of `templates/player` without `.js`, each after the files that it uses.
PLAYER = (
    "vectors", "tracks", "solids", "view", "elements", "motion", "body", "polhode",
    "ground", "controls", "legend", "readings", "panels", "trace", "stage", "driven", "mechanism", "player",
)  # fmt: skip

#: The file for a page that contains the data of its players, and the file for a page that loads the data later.
AT_ONCE, LATER = "start", "later"

#: The files that only pages with mechanisms need.
OF_MECHANISMS = ("driven", "mechanism")


def script(played: Iterable[Mapping[str, Any] | None] = ()) -> str:
    """Return the script that plays motions: its files in one scope, without indentation, blank lines and comment lines.

    played: the data of the animations of a page; the script supports mechanisms only if any of the data is of a mechanism.
    """
    mechanisms = any(data is not None and "bodies" in data for data in played)
    return _joined(name for name in (*PLAYER, AT_ONCE) if mechanisms or name not in OF_MECHANISMS)


def library() -> str:
    """Return the script for pages that load the data of animations later. It adds the function `play(figure, data)`."""
    return _joined((*PLAYER, LATER))


def _joined(names: Iterable[str]) -> str:
    folder = resources.files("bodycheck.reports") / "templates" / "player"
    lines = [line.strip() for name in names for line in (folder / f"{name}.js").read_text("utf-8").splitlines()]
    code = "\n".join(line for line in lines if line and not line.startswith("//"))
    return f'"use strict";\n(() => {{\n{code}\n}})();'


def style() -> str:
    """Return the style of the player."""
    return (resources.files("bodycheck.reports") / "templates" / "player.css").read_text("utf-8")
