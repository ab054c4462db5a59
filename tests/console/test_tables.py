"""Tables on terminals of any width: numbers are never cut, and what is left out is said."""

import io
import random
from contextlib import redirect_stdout

import pytest
from rich.cells import cell_len

from bodycheck.console.options import View
from bodycheck.console.tables import Column, attribute, check, entry, layout, show
from bodycheck.errors import BadInput
from tests.support.terminals import terminal

COLUMNS = (
    entry("case"),
    entry("engine", goes=1),
    entry("error", "error rad", ".3g"),
    entry("cost", goes=2),
    entry("reason", goes=3, wraps=True),
    entry("hidden", asked=True),
)
ROWS = [
    {"case": "flip", "engine": "mujoco", "error": 1.36e-9, "cost": 29.5, "reason": "", "hidden": 1.0},
    {"case": "fall", "engine": "mujoco", "error": 0.0625, "cost": None, "reason": "it stopped after a while", "hidden": 2.0},
    {"case": "slide", "engine": "mujoco", "error": float("nan"), "cost": 1.25e-7, "reason": "", "hidden": 3.0},
]


def printed(width: int | None, view: View = View()) -> list[str]:  # noqa: B008
    if width is None:
        with redirect_stdout(io.StringIO()) as stream:
            show(COLUMNS, ROWS, view)
        return stream.getvalue().splitlines()
    with terminal(width) as screen:
        show(COLUMNS, ROWS, view)
    return screen.lines


def test_a_wide_terminal_and_a_pipe_get_every_column_of_the_table() -> None:
    assert printed(200) == printed(None)
    assert printed(None)[:2] == [
        "case   engine  error rad  cost      reason",
        "flip   mujoco  1.36e-09   29.5",
    ]


def test_what_is_the_same_in_every_row_goes_first_and_is_said_once() -> None:
    lines = printed(55)
    assert lines[0] == "in every row: engine mujoco"
    assert lines[1].split() == ["case", "error", "rad", "cost", "reason"]
    assert not any("not shown" in line for line in lines)


def test_columns_go_in_their_order_and_are_named() -> None:
    lines = printed(28)
    assert lines[1].split() == ["case", "error", "rad", "cost"]
    assert " ".join(lines[5:]).startswith("not shown, for want of width: reason (--wide shows all")
    assert printed(20)[2].split() == ["case", "error", "rad"]


def test_rows_are_listed_where_even_the_columns_that_stay_are_too_wide() -> None:
    assert printed(12)[:6] == ["case: flip", "engine: mujoco", "error rad: 1.36e-09", "cost: 29.5", "", "case: fall"]


@pytest.mark.parametrize("width", range(18, 90, 3))
def test_no_number_is_cut_and_no_line_too_long(width: int) -> None:
    lines = printed(width)
    words = {word for line in lines for word in line.split()}
    assert {"1.36e-09", "0.0625"} <= words
    assert max(map(cell_len, lines)) <= width
    numbers = [word for word in words if word[0].isdigit()]
    assert set(numbers) <= {"1.36e-09", "0.0625", "29.5", "1.25e-07"}


def test_random_tables_lose_nothing_without_saying_so() -> None:
    draw = random.Random(7)
    for _ in range(300):
        size = draw.randint(1, 8)
        columns = [
            Column[tuple[str, ...]](
                f"c{place}", f"c{place}", lambda row: "", goes=draw.randint(0, 3), wraps=draw.random() < 0.2
            )
            for place in range(size)
        ]
        cells = [["x" * draw.randint(0, 30) for _ in range(size)] for _ in range(draw.randint(1, 4))]
        found = layout(columns, cells, width := draw.randint(5, 100))
        filled = {place for place in range(size) if any(row[place] for row in cells)}
        assert filled <= {*found.shown, *found.common, *found.left_out}
        assert all(columns[place].goes for place in found.left_out)
        if not found.listed:
            assert sum(found.widths) + 2 * (len(found.widths) - 1) <= width
            for place, wide in zip(found.shown, found.widths, strict=True):
                assert columns[place].wraps or all(len(row[place]) <= wide for row in cells)


def test_columns_may_be_chosen_and_all_are_printed_however_wide() -> None:
    assert printed(20, View(columns="hidden, case")) == ["hidden  case", "1       flip", "2       fall", "3       slide"]
    assert printed(20, View(wide=True)) == printed(None)


def test_rows_are_sorted_by_value_those_without_one_at_the_end() -> None:
    def order(name: str) -> list[str]:
        return [line.split()[0] for line in printed(None, View(sort=name))[1:]]

    assert order("error") == ["flip", "fall", "slide"]
    assert order("cost") == ["slide", "flip", "fall"]
    assert order("hidden") == ["flip", "fall", "slide"]
    assert order("case") == ["fall", "flip", "slide"]


def test_a_column_that_no_table_has_is_bad_input() -> None:
    check(View(columns="case", sort="error"), COLUMNS, [attribute("other")])
    with pytest.raises(BadInput, match=r"--columns: there is no column 'eror'; there are: case, engine, error, .*'error'"):
        check(View(columns="case,eror"), COLUMNS)
    with pytest.raises(BadInput, match="--sort: there is no column 'size'"):
        check(View(sort="size"), COLUMNS)


def test_columns_that_no_table_has_together_are_bad_input() -> None:
    with pytest.raises(BadInput, match="no table has all of these columns; one table has: case; other"):
        check(View(columns="case,other"), COLUMNS, [attribute("other")])


def test_a_table_that_lacks_a_named_column_is_not_printed() -> None:
    assert printed(None, View(columns="case,nothing")) == []


def test_a_column_may_be_named_by_its_head() -> None:
    column = Column[dict[str, float]]("timestep", "step s", lambda row: f"{row['step']:g}", lambda row: row["step"])
    check(View(columns="step s", sort="step s"), [column])
    with redirect_stdout(io.StringIO()) as stream:
        show([column], [{"step": 0.2}, {"step": 0.1}], View(columns="step s", sort="step s"))
    assert stream.getvalue().split() == ["step", "s", "0.1", "0.2"]


def test_a_text_cannot_move_the_cursor_or_begin_a_line() -> None:
    with redirect_stdout(io.StringIO()) as stream:
        show([attribute("text", at="__str__")], [], View())
        show([Column[str]("text", "text", lambda row: row)], ["red \x1b[31m\nand more\x07"])
    assert stream.getvalue().splitlines()[-1] == "red \\x1b[31m and more\\x07"
