"""What verdicts are called, and how numbers are written in cells."""

from dataclasses import dataclass

from bodycheck.reports.quantities import QUANTITIES, bound, number
from bodycheck.site.cells import Cell, Verdict


@dataclass(frozen=True)
class Word:
    """How a verdict is shown.

    Parameters
    ----------
    mark
        A sign that stands for it where there is no number.
    title
        Its name.
    meaning
        What it means, as a sentence.
    """

    mark: str
    title: str
    meaning: str


WORDS: dict[Verdict, Word] = {
    "exact": Word("=", "exact", "The error is no larger than the bound of the reference's own error."),
    "error": Word("", "error", "The run completed. The number is its largest error."),
    "broken": Word("!", "expectation broken", "The run completed, but it breaks an expectation of the case."),
    "failed": Word("✗", "failed", "The run diverged, crashed or took too long."),
    "refused": Word("⊘", "refused", "The engine itself refuses the model or the file."),
    "unsupported": Word("–", "unsupported", "The engine, or its adapter, does not model what the scene requires."),
    "not run": Word("·", "not run", "Nothing is known: there is no run of this scene in this engine."),
}

#: The names for readers of figures, by their columns.
TITLES = {name: quantity.title for name, quantity in QUANTITIES.items()}


def text(cell: Cell) -> str:
    """Return what stands in a cell: the error to two digits, the bound of an exact one, or the mark of the verdict.

    A completed run in which the scene's quantity was not measured is "ok".
    """
    if cell.verdict == "exact" and cell.bound is not None:
        return f"≤ {bound(cell.bound, 2)}"
    if cell.value is not None and cell.verdict in ("error", "broken"):
        return f"{WORDS[cell.verdict].mark}{number(cell.value, 2)}"
    return WORDS[cell.verdict].mark or "ok"
