"""Tables of robot models without what would only be counted: most rows of them say that two numbers agree."""

from collections.abc import Sequence

#: The columns by which rows are about the same.
SAME = ("model", "engine", "version", "quantity")


def condensed(rows: Sequence[Sequence[str]]) -> list[Sequence[str]]:
    """Return the rows of parity.csv, with its head as the first, without most of those that agree.

    Of the bodies or joints of a robot of which an engine has the same as the file, the one with the largest relative difference
    stays for each quantity. All rows of what differs, is refused or is not modelled stay, in their order. A table that lacks
    columns, or with a row that is no row, is returned as it is.
    """
    head = list(rows[0]) if rows else []
    if not {*SAME, "status", "relative"} <= set(head) or any(len(row) != len(head) for row in rows):
        return list(rows)
    same, status, relative = [head.index(name) for name in SAME], head.index("status"), head.index("relative")
    largest: dict[tuple[str, ...], tuple[float, int]] = {}
    for place, row in enumerate(rows[1:], start=1):
        if row[status] == "agrees":
            about = tuple(row[column] for column in same)
            found = (_number(row[relative]), -place)
            largest[about] = max(largest.get(about, found), found)
    kept = {-place for _, place in largest.values()}
    return [row for place, row in enumerate(rows) if row[status] != "agrees" or place in kept]


def _number(text: str) -> float:
    """Return a number, or less than any where a text is none, as of what is compared as words."""
    try:
        return float(text)
    except ValueError:
        return -1.0
