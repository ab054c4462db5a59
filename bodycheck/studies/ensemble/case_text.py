"""Write a case file of few lines: tables without tables of their own, and arrays on one line."""

from collections.abc import Mapping, Sequence
from typing import Any

from bodycheck.casefile.toml_text import in_line

#: Lines that a case file of a worst member has at most, unless its numbers take more. Tables are set apart where there is room.
MOST_LINES = 30


def case_text(document: Mapping[str, Any], comments: Sequence[str]) -> str:
    """Return the text of a case file.

    Parameters
    ----------
    document
        The case file as `tomllib` would read it: keys of the file before its tables.
    comments
        Sentences that stand at the beginning, each on a line of its own.
    """
    blocks = [[f"# {comment}" for comment in comments]]
    blocks.append([_line(key, value) for key, value in document.items() if not isinstance(value, dict) and key != "expect"])
    for name, table in document.items():
        if isinstance(table, dict):
            blocks.append([f"[{name}]", *(_line(key, value) for key, value in table.items())])
    for table in document.get("expect", ()):
        blocks.append(["[[expect]]", *(_line(key, value) for key, value in table.items())])
    blocks[:2] = [blocks[0] + blocks[1]]
    apart = sum(map(len, blocks)) + len(blocks) - 1 <= MOST_LINES
    return ("\n\n" if apart else "\n").join("\n".join(block) for block in blocks) + "\n"


def _line(key: str, value: Any) -> str:
    return f"{key} = {in_line(value)}"
