"""Numbers, words and lines of reports."""

import math

import numpy as np

from bodycheck.reports import markdown
from bodycheck.reports.lines import assign
from bodycheck.reports.quantities import bound, count, listing, number
from bodycheck.results.key import RunKey


def test_bounds_are_rounded_up() -> None:
    assert bound(2.034e-9, 2) == "2.1e-9"
    assert bound(1.384685e-15) == "1.385e-15"
    assert bound(0.0981) == "0.0981"
    assert bound(0.0) == "0"
    for value in np.random.default_rng(1).lognormal(0, 20, 500):
        assert float(bound(float(value), 3)) >= value * (1 - 1e-6)


def test_words() -> None:
    assert number(None) == number(math.nan) == "–"
    assert number(1.5e-7) == "1.5e-7"
    assert (number(110, 2), number(12345), number(9996, 3)) == ("110", "1.234e4", "1e4")
    assert count(1, "run") == "1 run"
    assert listing(["a"]) == "a"
    assert listing(["a", "b", "c"]) == "a, b and c"
    assert listing(list("abcdef"), 3, "method") == "a, b, c and 3 more methods"


def test_lines_tell_methods_apart() -> None:
    keys = [
        RunKey.of_method(engine, f"i{k}", step)
        for engine in ("zeta", "pinocchio", "mujoco")
        for k in range(5)
        for step in (0.002, 0.001)
    ]
    lines = assign(keys)
    assert len({(line.colour, line.dash, line.width) for line in lines.values()}) == len(keys)
    first = RunKey.of_method("mujoco", "i0", 0.002)
    assert lines[first].label == "mujoco i0 2 ms"
    alone = assign([first])
    assert alone[first].colour == lines[first].colour
    assert alone[first].label == "mujoco i0"


def test_a_long_line_is_cut_at_the_end_of_a_word() -> None:
    told = "wrong by at most 3.6e-15 rad"
    assert markdown.cut(told, len(told)) == told
    cuts = {markdown.cut(told, longest) for longest in range(20, len(told))}
    assert cuts == {"wrong by at most…", "wrong by at most 3.6e-15…"}
    assert markdown.cut("in /a/path/without/an/end", 20) == "in /a/path/without/…"
    assert markdown.escape(f"{told} or more", len(told)) == "wrong by at most 3.6e-15…"
