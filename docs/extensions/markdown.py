"""Markdown of generated pages: tables, and texts of the source code as Markdown."""

import re
from collections.abc import Iterable, Sequence

#: Code within a text, which is left as it is.
CODE = re.compile(r"(`[^`]*`)")

#: Options, names of files, and names of figures and keys.
IDENTIFIERS = re.compile(r"(?<![\w`-])(--[a-z][a-z-]*|[\w-]+\.(?:csv|jsonl?|html|md|parquet)|[a-z]+(?:_[a-z]+)+)(?![\w`])")


def prose(text: str) -> str:
    """Return a text of the source code as Markdown: what would be markup is escaped, and options and file names are code."""
    parts = CODE.split(" ".join(text.split()))
    return "".join(part if place % 2 else _marked(part) for place, part in enumerate(parts))


def code(text: str) -> str:
    """Return a text as code."""
    return f"`{text}`" if text else ""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table. A vertical bar within a cell does not end it."""
    lines = [head, ["---"] * len(head), *([cell.replace("|", "\\|") for cell in row] for row in rows)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _marked(text: str) -> str:
    text = re.sub(r"([*<>\[\]$])", r"\\\1", text)
    return IDENTIFIERS.sub(r"`\1`", text)
