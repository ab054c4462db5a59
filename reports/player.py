"""The player of motions: its script and its style, for pages that have animations."""

from importlib import resources

#: The files of `templates/player` without `.js`, each after those that it uses.
PLAYER = (
    "vectors", "tracks", "solids", "view", "elements", "motion", "body", "polhode",
    "ground", "controls", "legend", "readings", "panels", "player", "start",
)  # fmt: skip


def script() -> str:
    """Return the script that plays motions: its files in one scope, without indentation, blank lines and lines of comment."""
    folder = resources.files("bodycheck.reports") / "templates" / "player"
    lines = [line.strip() for name in PLAYER for line in (folder / f"{name}.js").read_text("utf-8").splitlines()]
    code = "\n".join(line for line in lines if line and not line.startswith("//"))
    return f'"use strict";\n(() => {{\n{code}\n}})();'


def style() -> str:
    """Return the style of the player."""
    return (resources.files("bodycheck.reports") / "templates" / "player.css").read_text("utf-8")
