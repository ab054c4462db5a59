"""Print the results of a parity study to the terminal."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bodycheck.console.options import View
from bodycheck.console.output import bold, say, tell
from bodycheck.console.tables import Column, attribute, show
from bodycheck.reports.quantities import count, listing
from bodycheck.robots.elements import printable
from bodycheck.studies.parity.quantities import MODEL
from bodycheck.studies.parity.rows import ParityRow
from bodycheck.studies.parity.study import Parity
from bodycheck.studies.parity.wording import engines_of, headline, of_engine_counted, of_file, unreadable

if TYPE_CHECKING:
    from bodycheck.studies.parity.releases import Meaning

#: The most bodies and joints that the line of a change names.
MOST_SUBJECTS = 4

#: The most faults of a file that are printed.
MOST_FAULTS = 4

#: The columns of the table of rows.
ROWS: tuple[Column[ParityRow], ...] = (
    attribute("model", goes=5),
    attribute("engine", goes=1),
    attribute("version", goes=7),
    attribute("status"),
    attribute("quantity"),
    attribute("subject"),
    attribute("engine_value", "engine has", goes=3, wraps=True),
    attribute("truth_value", "file has", goes=3, wraps=True),
    attribute("difference", goes=4),
    attribute("relative", goes=2),
    attribute("cause"),
    attribute("source", goes=6),
)


def print_models(models: Sequence[Parity]) -> None:
    """Print the verdict on each model and engine in sentences, and at the end the verdict on all."""
    for index, one in enumerate(models):
        if index:
            say("")
        bold(one.name)
        faults = of_file(one)
        for fault in faults[:MOST_FAULTS]:
            tell(f"  the file: {fault}", "    ")
        if len(faults) > MOST_FAULTS:
            tell(f"  the file: {count(len(faults) - MOST_FAULTS, 'more fault')} in the table (--table)", "    ")
        for engine, rows in engines_of(one).items():
            verdict, *more = of_engine_counted(rows)
            tell(f"  {engine} {rows[0].version}: {verdict}", "    ")
            for sentence in more:
                tell(f"    {sentence}", "      ")
            for note in one.notes.get(engine, ()):
                tell(f"    note: {note}", "      ")
    if len(models) > 1:
        say("")
        tell(headline(models))


def tell_unread(models: Sequence[Parity], skipped: Sequence[Path]) -> None:
    """Print to stderr, in one list, which files cannot be read, and how many files of folders were skipped."""
    sys.stdout.flush()
    unread = [one for one in models if unreadable(one)]
    if unread:
        print(f"bodycheck: {len(unread)} of {count(len(models), 'file')} cannot be read:", file=sys.stderr)
    for one in unread:
        for reason in of_file(one):
            print(f"  {reason}", file=sys.stderr)
    if skipped:
        which = listing([printable(str(path)) for path in skipped], MOST_SUBJECTS, "file")
        print(f"bodycheck: skipped, as XML files that are no robots' files: {which}", file=sys.stderr)


def print_changes(changes: "Sequence[Meaning]") -> None:
    """Print the releases that changed the meaning of files, with the changes."""
    say("")
    alike: dict[tuple[str, str], list[str]] = {}
    for change in changes:
        if change.quantity is None or change.subject != MODEL:
            alike.setdefault((change.model, change.text), []).append(change.subject)
    for (model, text), subjects in alike.items():
        tell(f"{model}: {text}: {listing(subjects, MOST_SUBJECTS, 'subject')}", "    ")
    if not changes:
        tell("No release changed what a file means.")


def print_rows(rows: Sequence[ParityRow], view: View) -> None:
    """Print one line for each row of the table."""
    show(ROWS, rows, view)
