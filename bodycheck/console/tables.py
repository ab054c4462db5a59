"""Print tables on terminals of any width without cutting a number.

If a terminal is too narrow for a table, columns with the same value in every row are first replaced by one line above the
table. Then further columns are left out, in the order of their attribute `goes`. A line below the table names them, and says
how to see them. If even the remaining columns do not fit, each row is printed as a list of its values. In a pipe or a file, a
table has all columns, and each row is on one line.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from operator import attrgetter, itemgetter
from textwrap import wrap
from typing import Any, Generic, TypeVar

from rich.cells import cell_len

from bodycheck.console import output
from bodycheck.console.options import AS_USUAL, View
from bodycheck.console.output import bold, say, tell
from bodycheck.errors import BadInput
from bodycheck.suggestion import did_you_mean

Row = TypeVar("Row")

#: Characters between two columns.
GAP = 2

#: The smallest width (characters) of a column of sentences, which may be broken into lines.
NARROWEST_TEXT = 24


@dataclass(frozen=True)
class Column(Generic[Row]):
    """A column of a table on the terminal.

    Attributes
    ----------
    name
        The name of the column in `--columns` and `--sort`, which is also its name in the files of results, if they have it.
    head
        The head of the column, with the unit.
    text
        Function from a row to the text of its cell.
    value
        Function from a row to the value by which rows are sorted; None to sort by the text. It returns None for a row without a
        value.
    goes
        The order in which columns are left out on a narrow terminal: larger numbers first; columns with 0 stay.
    wraps
        Whether the column contains sentences, which may be broken into lines.
    asked
        Whether the column is printed only if `--columns` names it.
    """

    name: str
    head: str
    text: Callable[[Row], str]
    value: Callable[[Row], float | str | None] | None = None
    goes: int = 0
    wraps: bool = False
    asked: bool = False


def attribute(name: str, head: str = "", form: str = ".3g", at: str = "", **options: Any) -> Column[Any]:
    """Return the table column for an attribute of rows that are objects.

    Parameters
    ----------
    name
        The name of the column.
    head
        The head; if it is empty, the name.
    form
        The format of numbers.
    at
        The attribute, or a chain of attributes separated by dots; if it is empty, the name of the column.
    options
        Further fields of `Column`.
    """
    return _of(attrgetter(at or name), name, head, form, options)


def entry(name: str, head: str = "", form: str = ".3g", **options: Any) -> Column[Any]:
    """Return the table column for an entry of rows that are mappings, which may lack it. Parameters: see `attribute`."""
    return _of(lambda row: row.get(name), name, head, form, options)


def _of(get: Callable[[Any], Any], name: str, head: str, form: str, options: dict[str, Any]) -> Column[Any]:
    def text(row: Any) -> str:
        value = get(row)
        return "" if value is None else value if isinstance(value, str) else f"{value:{form}}"

    return Column(name, head or name, text, **({"value": get} | options))


@dataclass(frozen=True)
class Layout:
    """The layout of a table; columns are given by their indices.

    Attributes
    ----------
    shown
        The columns of the table.
    widths
        The widths of these columns, in characters.
    common
        The columns with the same value in every row, which is printed once, above the table.
    left_out
        The columns that are not printed, although they contain text.
    listed
        Whether each row is printed as a list of its values, because the columns are too wide.
    """

    shown: tuple[int, ...]
    widths: tuple[int, ...]
    common: tuple[int, ...] = ()
    left_out: tuple[int, ...] = ()
    listed: bool = False


def check(view: View, *tables: Sequence[Column[Any]]) -> None:
    """Raise `BadInput` if a view names a column that no table has, or columns of which no table has all.

    This is checked before a long run.
    """
    columns = {column.name: column for table in tables for column in table}
    usual = ", ".join(name for name, column in columns.items() if not column.asked)
    others = " and the columns of the CSV file" if any(column.asked for column in columns.values()) else ""
    known = {name for table in tables for name in _by_name(table)}
    for option, names in (("--columns", view.names), ("--sort", (view.sort,) if view.sort else ())):
        for name in names:
            if name not in known:
                there = f"there are: {usual}{others}{did_you_mean(name, known)}"
                raise BadInput(f"{option}: there is no column {name!r}; {there}")
    if not any(chosen(table, view) for table in tables):
        by_table = [[name for name in view.names if name in _by_name(table)] for table in tables]
        parts = "; ".join(" and ".join(names) for names in by_table if names)
        raise BadInput(f"--columns {view.columns}: no table has all of these columns; one table has: {parts}")


def _by_name(columns: Sequence[Column[Row]]) -> dict[str, Column[Row]]:
    """Return the columns of a table by their names and by their heads, either of which a user may give."""
    return {column.head: column for column in columns} | {column.name: column for column in columns}


def chosen(columns: Sequence[Column[Row]], view: View) -> list[Column[Row]]:
    """Return the columns of a table that a view prints; none if the table lacks a column that the view names."""
    by_name = _by_name(columns)
    if not view.names:
        return [column for column in columns if not column.asked]
    return [by_name[name] for name in view.names] if set(view.names) <= set(by_name) else []


def show(columns: Sequence[Column[Row]], rows: Iterable[Row], view: View = AS_USUAL) -> None:
    """Print a table.

    Parameters
    ----------
    columns
        The columns, in their order.
    rows
        The rows.
    view
        The columns and the order of rows that the user requests. A table that lacks one of these columns is not printed.
    """
    ordered = _sorted(columns, rows, view.sort)
    columns = chosen(columns, view)
    if not columns:
        return
    cells = [[_plain(column.text(row)) for column in columns] for row in ordered]
    table = layout(columns, cells, None if view.wide or view.names else output.width())
    if table.listed:
        _print_lists(columns, cells)
        return
    if table.common:
        shared = ", ".join(f"{columns[index].head} {cells[0][index]}" for index in table.common)
        tell(f"in every row: {shared}")
    bold(_line([columns[index].head for index in table.shown], table.widths))
    for row in cells:
        for line in _lines([row[index] for index in table.shown], table.widths):
            say(line)
    if table.left_out:
        names = ", ".join(columns[index].name for index in table.left_out)
        tell(f"not shown, for want of width: {names} (--wide shows all, --columns A,B,C those that you name)")


def print_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table of texts. On a narrow terminal the first column stays, and others are left out from the right."""
    show([Column(head, head, itemgetter(index), goes=index) for index, head in enumerate(header)], rows)


def layout(columns: Sequence[Column[Any]], cells: Sequence[Sequence[str]], width: int | None) -> Layout:
    """Return the layout of a table.

    Parameters
    ----------
    columns
        The columns.
    cells
        The texts of each row, one for each column.
    width
        The width of the terminal in characters; None for no limit.
    """
    places = range(len(columns))
    natural = [max(cell_len(text) for text in (column.head, *(row[i] for row in cells))) for i, column in enumerate(columns)]
    if width is None:
        return Layout(tuple(places), tuple(natural))
    least = [min(natural[i], NARROWEST_TEXT) if columns[i].wraps else natural[i] for i in places]
    shown = [i for i in places if not cells or any(row[i] for row in cells)]
    common, left_out = [], []
    first_to_go = sorted(shown, key=lambda i: (-columns[i].goes, -i))
    for i in first_to_go:
        if _total(least, shown) > width and len(cells) > 1 and len(shown) > 1 and len({row[i] for row in cells}) == 1:
            shown.remove(i)
            common.append(i)
    for i in first_to_go:
        if _total(least, shown) > width and i in shown and columns[i].goes:
            shown.remove(i)
            left_out.append(i)
    if _total(least, shown) > width:
        return Layout(tuple(places), tuple(natural), listed=True)
    spare = width - _total(least, shown)
    for i in shown:
        more = min(spare, natural[i] - least[i])
        least[i] += more
        spare -= more
    return Layout(tuple(shown), tuple(least[i] for i in shown), tuple(sorted(common)), tuple(sorted(left_out)))


def _total(widths: Sequence[int], shown: Sequence[int]) -> int:
    return sum(widths[i] for i in shown) + GAP * (len(shown) - 1)


def _sorted(columns: Sequence[Column[Row]], rows: Iterable[Row], name: str) -> list[Row]:
    """Return rows in ascending order of a column, rows without a value last; without such a column, in the given order."""
    table_rows = list(rows)
    by = _by_name(columns).get(name)
    if by is None:
        return table_rows
    value = by.value or by.text
    values = [value(row) for row in table_rows]
    known = [i for i, one in enumerate(values) if one is not None and one == one and one != ""]  # a NaN differs from itself
    order: list[int] = sorted(known, key=lambda i: values[i])  # type: ignore[arg-type, return-value]
    return [table_rows[i] for i in (*order, *(i for i in range(len(table_rows)) if i not in set(known)))]


def _plain(text: str) -> str:
    """Return a text on one line, without characters that move the cursor or change colours."""
    line = " ".join(text.split("\n")).replace("\t", " ")
    return "".join(sign if sign >= " " and not "\x7f" <= sign <= "\x9f" else f"\\x{ord(sign):02x}" for sign in line)


def _lines(texts: Sequence[str], widths: Sequence[int]) -> list[str]:
    """Return the lines of a row: more than one if a sentence is longer than the width of its column."""
    broken = [
        [text] if cell_len(text) <= width else wrap(text, width, break_on_hyphens=False)
        for text, width in zip(texts, widths, strict=True)
    ]
    height = max(map(len, broken), default=0)
    return [_line([lines[at] if at < len(lines) else "" for lines in broken], widths) for at in range(height)]


def _line(texts: Sequence[str], widths: Sequence[int]) -> str:
    padded = [text + " " * (width - cell_len(text)) for text, width in zip(texts, widths, strict=True)]
    return (" " * GAP).join(padded).rstrip()


def _print_lists(columns: Sequence[Column[Any]], cells: Sequence[Sequence[str]]) -> None:
    for number, row in enumerate(cells):
        if number:
            say("")
        for column, text in zip(columns, row, strict=True):
            if text:
                say(f"{column.head}: {text}")
