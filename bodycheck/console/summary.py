"""Print the summary of runs: a screen that says what came out and where to look."""

import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from rich.cells import cell_len

from bodycheck.console import output

#: The most findings that a summary has.
MOST_FINDINGS = 3

#: Lines of a terminal that the summary leaves free: for the place of the report, what `make` says of a failure, and the prompt.
FREE_LINES = 3

#: The end of a text that is longer than its place.
MORE = "…"


@dataclass(frozen=True)
class Summary:
    """The contents of a summary.

    Attributes
    ----------
    headline
        The verdict in one line.
    findings
        Sentences, the most important first. The first three are printed.
    counts
        How many runs ended in each way.
    unsupported
        Why runs were not made, in one line; empty if all were made.
    where
        Where to find more, a line each.
    steps
        What to do about the first failure, a line each. They have commands to be copied, so that the terminal breaks them.
    """

    headline: str
    findings: Sequence[str]
    counts: str
    unsupported: str
    where: Sequence[str]
    steps: Sequence[str] = ()


def print_summary(summary: Summary) -> None:
    """Print a summary, on a terminal on so few lines that all are seen at once, and elsewhere each part on one line."""
    size = shutil.get_terminal_size() if sys.stdout.isatty() else None
    headline, *others = fitted(summary, None if size is None else size.columns, None if size is None else size.lines)
    output.bold(headline)
    for line in others:
        output.say(line)


def fitted(summary: Summary, width: int | None, height: int | None) -> list[str]:
    """Return the lines of a summary for a terminal of so many characters and lines; None stands for any number.

    Findings are shortened where the lines are not enough, and those after the first left out; so are steps that leave no line
    for each finding. A shortened text ends in an ellipsis, and no number is cut.
    """
    first = output.lines(summary.headline, width)
    last = output.lines(summary.counts, width)
    last += [_shortened(summary.unsupported, 1, width)[0]] if summary.unsupported else []
    last += [line for text in summary.where for line in output.lines(text, width, "  ")]
    findings = summary.findings[:MOST_FINDINGS]
    room = sys.maxsize if height is None else height - FREE_LINES - len(first) - len(last) - 2
    steps: list[str] = []
    for text in summary.steps:
        taken = 1 if width is None else -(-cell_len(text) // width)
        taken += 0 if steps else 1  # the empty line before the first
        if taken <= room - len(findings):
            room -= taken
            steps.append(text)
    middle: list[str] = []
    for index, text in enumerate(findings):
        left = room - len(middle) - (len(findings) - 1 - index)  # a line for each of the others
        if left > 0:
            middle += _shortened(text, left, width)
    indented = [line for part in (middle, steps) if part for line in ("", *part)]
    return [*first, *indented, *([""] if indented else []), *last]


def _shortened(text: str, most: int, width: int | None) -> list[str]:
    """Return a text as at most so many lines; an ellipsis stands for the rest."""
    lines = output.lines(text, width, "  ")
    if len(lines) <= most:
        return lines
    assert width is not None  # a text on one line is never too long
    end = lines[most - 1]
    while len(end) + 2 > width and " " in end.strip():
        end = end.rpartition(" ")[0]
    return [*lines[: most - 1], f"{end} {MORE}"]
