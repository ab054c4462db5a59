"""The summary of runs fits the screen, whatever it has to say."""

import random

import pytest

from bodycheck.console.summary import FREE_LINES, MOST_LINES, Summary, fitted, print_summary
from tests.support.terminals import terminal

LONG = "Position: " + " ".join(f"word{place} {place}e-{place % 9 + 1}" for place in range(200)) + "."

SUMMARY = Summary(
    "3 of 387 runs failed",
    [LONG, LONG, LONG, LONG, LONG, "Alike: a sixth"],
    "387 runs: 384 passed, 3 failed",
    f"unsupported: {LONG}",
    [],
)


@pytest.mark.parametrize(("columns", "lines"), [(80, 24), (80, 20), (40, 24), (132, 43), (200, 24)])
def test_it_fits_the_screen_and_cuts_no_number(columns: int, lines: int) -> None:
    with terminal(columns, lines) as screen:
        print_summary(SUMMARY)
    assert len(screen.lines) <= min(lines - FREE_LINES, MOST_LINES)
    assert max(map(len, screen.lines)) <= columns
    assert screen.lines[0] == SUMMARY.headline
    assert SUMMARY.counts in screen.lines
    assert sum(line.startswith("Position: ") for line in screen.lines) == 5
    known = {*LONG.split(), *SUMMARY.counts.split(), *SUMMARY.headline.split(), "unsupported:", "…"}
    assert {word for line in screen.lines for word in line.split()} <= known


def test_short_findings_are_whole_and_at_most_five() -> None:
    names = ["One.", "Two.", "Three.", "Four.", "Five."]
    summary = Summary("None failed", [*names, "Six."], "5 runs: 5 passed", "", ["--out FOLDER"])
    assert fitted(summary, 80, 24) == ["None failed", "", *names, "", "5 runs: 5 passed", "--out FOLDER"]
    assert fitted(Summary("None failed", [], "0 runs", "", []), 80, 24) == ["None failed", "0 runs"]


def test_in_a_pipe_every_sentence_is_one_whole_line() -> None:
    assert fitted(SUMMARY, None, None) == [
        *(SUMMARY.headline, "", LONG, LONG, LONG, LONG, LONG, ""),
        *(SUMMARY.counts, SUMMARY.unsupported),
    ]


def test_any_text_fits_any_screen() -> None:
    draw = random.Random(11)
    for _ in range(300):
        findings = [" ".join("x" * draw.randint(1, 12) for _ in range(draw.randint(1, 150))) for _ in range(draw.randint(0, 5))]
        found = fitted(
            Summary("Headline", findings, "counts", "why " * draw.randint(1, 90), ["where"]), 60, draw.randint(14, 40)
        )
        assert all(len(line) <= 60 for line in found)
        assert found[0] == "Headline"
        assert found[-2] == "where"
        assert sum(any(line.startswith(text[:40]) for line in found) for text in findings) == len(findings)


def test_steps_are_whole_lines_to_be_copied_and_give_way_to_findings() -> None:
    steps = ["which release: bodycheck bisect " + "x" * 150, "if it is right: bodycheck expect"]
    summary = Summary("1 run failed", ["One.", "Two."], "1 run: 1 failed", "", ["--out FOLDER"], steps)
    assert fitted(summary, 80, 24) == [
        *("1 run failed", "", "One.", "Two.", "", *steps, "", "1 run: 1 failed", "--out FOLDER"),
    ]
    # 3 lines of the terminal for the first step, 5 for the rest, 4 that are empty, and `FREE_LINES`.
    least = 3 + 5 + 4 + FREE_LINES
    assert fitted(summary, 80, least - 1)[:5] == ["1 run failed", "", "One.", "Two.", ""]
    assert [steps[0] in fitted(summary, 80, lines) for lines in (least - 2, least + 1)] == [False, True]
