"""Print the summary of runs: one screen with the results, and where to find more."""

import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from rich.cells import cell_len

from bodycheck.console import output

#: The largest number of findings in a summary.
MOST_FINDINGS = 5

#: Lines of a terminal that the summary leaves free: for the path of the report, the message of `make` about a failure, and the
#: prompt.
FREE_LINES = 3

#: The most lines on a terminal.
MOST_LINES = 15

#: The end of a shortened text.
MORE = "…"


@dataclass(frozen=True)
class Summary:
    """The contents of a summary.

    Attributes
    ----------
    headline
        The verdict in one line.
    findings
        Sentences, the most important first. The first five are printed.
    counts
        The numbers of runs by their outcomes, in a sentence.
    unsupported
        The number of runs that were not made and the reasons, in one line, which is the last; empty if all were made.
    where
        Places of further information, one per line.
    steps
        Next steps after the first failure, one per line. They contain commands to be copied, so that only the terminal breaks
        these lines.
    """

    headline: str
    findings: Sequence[str]
    counts: str
    unsupported: str
    where: Sequence[str]
    steps: Sequence[str] = ()


def print_summary(summary: Summary) -> None:
    """Print a summary: on a terminal so short that all of it is visible at once, else with each part on one line."""
    size = shutil.get_terminal_size() if sys.stdout.isatty() else None
    headline, *others = fitted(summary, None if size is None else size.columns, None if size is None else size.lines)
    output.bold(headline)
    for line in others:
        output.say(line)


def fitted(summary: Summary, width: int | None, height: int | None) -> list[str]:
    """Return the lines of a summary for a terminal's width (characters) and height (lines); None for no limit.

    If there are too few lines, findings are shortened, and findings after the first are left out. Steps are left out if they
    leave too few lines for the findings. A shortened text ends in an ellipsis, and no number is cut.
    """
    first = output.lines(summary.headline, width)
    last = output.lines(summary.counts, width)
    last += [line for text in summary.where for line in output.lines(text, width, "  ")]
    last += [_shortened(summary.unsupported, 1, width)[0]] if summary.unsupported else []
    findings = summary.findings[:MOST_FINDINGS]
    most = sys.maxsize if height is None else min(height - FREE_LINES, MOST_LINES)
    room = most - len(first) - len(last) - 2
    steps: list[str] = []
    for text in summary.steps:
        taken = 1 if width is None else -(-cell_len(text) // width)
        taken += 0 if steps else 1  # the empty line before the first
        if taken <= room - len(findings):
            room -= taken
            steps.append(text)
    middle: list[str] = []
    for index, text in enumerate(findings):
        left = room - len(middle) - (len(findings) - 1 - index)  # this reserves a line for each later finding
        if left > 0:
            middle += _shortened(text, left, width)
    indented = [line for part in (middle, steps) if part for line in ("", *part)]
    return [*first, *indented, *([""] if indented else []), *last]


def _shortened(text: str, most: int, width: int | None) -> list[str]:
    """Return a text as at most `most` lines; an ellipsis replaces the rest."""
    lines = output.lines(text, width, "  ")
    if len(lines) <= most:
        return lines
    assert width is not None  # a text on one line is never too long
    end = lines[most - 1]
    while len(end) + 2 > width and " " in end.strip():
        end = end.rpartition(" ")[0]
    return [*lines[: most - 1], f"{end} {MORE}"]
