"""Renew the tables of figures and of axes in docs/cases.md. Run: python docs/tables.py"""

from collections.abc import Sequence
from pathlib import Path

from bodycheck.casefile.axes import AXES
from bodycheck.figures.columns import LIMITED

PAGE = Path(__file__).parent / "cases.md"

#: What a table stands between: a line for its name, and a line that is the same for all.
BEGIN, END = "<!-- {} from the source code; renewed by: python docs/tables.py -->", "<!-- end of the table -->"


def tables() -> dict[str, str]:
    """Return the tables as Markdown, by the names that stand in the lines before them."""
    axes = [(f"`{axis.name}`", axis.unit or "1", _sentence(axis.meaning, axis.remark)) for axis in AXES.values()]
    figures = [(f"`{name}`", column.unit or "1", _sentence(column.told, column.remark)) for name, column in LIMITED.items()]
    return {
        "Axes": _table(("axis", "unit", "what it sets"), axes),
        "Figures": _table(("key", "unit", "what it is"), figures),
    }


def renewed(text: str) -> str:
    """Return the text of the page with its tables renewed. Raises `ValueError` where the place of a table is missing."""
    for name, table in tables().items():
        before, begin, rest = text.partition(BEGIN.format(name))
        _, end, after = rest.partition(END)
        if not (begin and end):
            raise ValueError(f"the page has no place for the table {name!r}")
        text = f"{before}{begin}\n\n{table}\n\n{end}{after}"
    return text


def _sentence(meaning: str, remark: str) -> str:
    return f"{meaning}; {remark}" if remark else meaning


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text("utf-8")), "utf-8")
