"""Pages that are made when the documentation is built, from what they describe.

The file of such a page is an ordinary page with the line `MARKER`, which the generated text replaces. So the page has its place
in the table of contents, may say something in front, and can be linked to in the repository.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

from benchmarks import speed
from docs.extensions import case_grammar, command_line, python_interface, result_columns

ROOT = Path(__file__).resolve().parents[2]

MARKER = "<!-- this page is made by docs/extensions/generated.py when the documentation is built -->"


def setup(app: Sphinx) -> dict[str, Any]:
    """Fill the generated pages in when they are read."""
    # They change without a change of their files.
    app.connect("env-get-outdated", lambda *_: sorted(PAGES))
    app.connect("source-read", _fill)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def filled(page: str, text: str) -> str:
    """Return the text of a page with its generated part. Raises `ValueError` if the page has no place for it."""
    if page not in PAGES:
        return text
    if MARKER not in text:
        raise ValueError(f"docs/{page}.md has no line {MARKER!r}")
    return text.replace(MARKER, PAGES[page]())


def _fill(app: Sphinx, page: str, source: list[str]) -> None:
    source[0] = filled(page, source[0])


def _of_the_repository(name: str) -> Callable[[], str]:
    """A file beside docs/, as a page of docs/development/. Its links are changed accordingly."""

    def page() -> str:
        text = (ROOT / name).read_text("utf-8")
        text = re.sub(r"\]\(docs/", "](../", text)
        return re.sub(r"\]\((\w+)\.md", lambda link: f"]({DEVELOPMENT[link[1]]}.md", text)

    return page


#: Pages about the development by the names of the files beside docs/.
DEVELOPMENT = {
    "CONTRIBUTING": "contributing",
    "SECURITY": "security",
    "CHANGELOG": "changes",
    "SUPPORT": "support",
    "GOVERNANCE": "governance",
    "CODE_OF_CONDUCT": "code-of-conduct",
}

#: What makes the generated parts of pages, by the pages' names.
PAGES: dict[str, Callable[[], str]] = {
    "development/speed": speed.page,
    "reference/case-files": case_grammar.page,
    "reference/columns": result_columns.page,
    "reference/command-line": command_line.page,
    "reference/python": python_interface.page,
    **{f"development/{page}": _of_the_repository(f"{name}.md") for name, page in DEVELOPMENT.items()},
}
