"""Addresses of pages that were joined with others: each leads on to where the text is now."""

from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

#: The page, and where the text is a part of it the part, by the former address.
MOVED = {
    "ci": "howto/gate-ci",
    "driven_engines": "driven#what-each-engine-does",
    "howto/choose-a-step": "howto/choose-a-method",
    "howto/edit-case-files": "cases#in-an-editor",
    "python": "reference/python",
    "recommend": "howto/choose-a-method",
    "releases": "howto/compare-releases",
    "robot_files": "robots#robots-files-as-cases",
    "scaling": "howto/run-on-a-cluster",
}

#: The page at a former address. A part that the address names wins over that of the table. Without scripts its link is left.
PAGE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>bodycheck</title>
<script>location.replace(location.hash ? "{page}" + location.hash : "{to}")</script>
<noscript><meta http-equiv="refresh" content="0; url={to}"></noscript>
<p>This page is now a part of <a href="{to}">another one</a>.</p>
</html>
"""


def setup(app: Sphinx) -> dict[str, Any]:
    """Write these pages before the versions of the documentation are told which pages there are."""
    app.connect("build-finished", _write, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def page(old: str, new: str) -> str:
    """Return the page at the address `old`, which leads to `new`, both from the folder of the documentation on."""
    name, mark, part = new.partition("#")
    target = f"{'../' * old.count('/')}{name}.html"
    return PAGE.format(page=target, to=f"{target}{mark}{part}")


def _write(app: Sphinx, failure: Exception | None) -> None:
    if failure is None and app.builder.name == "html":
        for old, new in MOVED.items():
            path = Path(app.outdir) / f"{old}.html"
            path.parent.mkdir(exist_ok=True)
            path.write_text(page(old, new), "utf-8")
