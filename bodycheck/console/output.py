"""Print lines, broken between words, to stdout, with characters that any terminal can show."""

import functools
import os
import shutil
import sys
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bodycheck.running.named import Decision

#: Characters for terminals and logs whose encoding lacks those that they replace.
SUBSTITUTES = {"→": "->", "…": "...", "\u202f": " ", "\xa0": " ", "–": "-", "−": "-", "×": "x", "·": "-", "≤": "<=", "≥": ">="}


def width() -> int | None:
    """Return the width of the terminal in characters; None for a pipe or a file, whose lines may be of any length."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else None


def say(line: str) -> None:
    """Print a line as it is; characters that the encoding of stdout lacks become `SUBSTITUTES` or question marks."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    print("".join(character if _has(encoding, character) else SUBSTITUTES.get(character, "?") for character in line))


@functools.cache
def _has(encoding: str, character: str) -> bool:
    """Return whether an encoding has a character."""
    try:
        character.encode(encoding)
    except UnicodeEncodeError:
        return False
    return True


def tell(text: str, indent: str = "") -> None:
    """Print sentences. On a terminal, they are broken into lines, and all lines after the first get an indent."""
    for line in lines(text, width(), indent):
        say(line)


def lines(text: str, most: int | None, indent: str = "") -> list[str]:
    """Return sentences as lines of at most `most` characters, broken only between words, so that no number is cut."""
    if most is None:
        return [text]
    return wrap(text, most, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


def bold(line: str) -> None:
    """Print a line, in bold letters if stdout is a terminal that supports them and the user does not disable them."""
    has = sys.stdout.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
    say(f"\033[1m{line}\033[0m" if has else line)


def end(decision: "Decision", out: Path | None, *, json: bool = False, quiet: bool = False) -> int:
    """Print what was named and has no result, the number of unsupported rows, and the path of the report; return the exit code.

    out: the folder of the report; None if there is none. json: whether stdout has JSON, so that all lines go to stderr.
    """
    if decision.unsupported and not quiet:
        print(f"{decision.unsupported}.", file=sys.stderr) if json else tell(f"{decision.unsupported}.")
    sys.stdout.flush()
    if out is not None:
        print(f"report: {out / 'report.html'}", file=sys.stderr)
    for sentence in decision.lost:
        print(f"bodycheck: {sentence}", file=sys.stderr)
    return decision.code
