"""The vocabulary of verdicts: words, marks and meanings that the terminal, reports, studies and the site share.

The keys are the values in files, or derived from them. A mark stands for a verdict in a cell without a number. Colours are in
the styles of the pages, whose classes have the names of the verdicts.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.results.outcome import Completed, Diverged, Unsupported


@dataclass(frozen=True)
class Word:
    """A verdict for readers.

    Parameters
    ----------
    mark
        The sign that stands for the verdict in a cell without a number; empty if it has none.
    title
        Its name.
    meaning
        Its meaning.
    """

    mark: str
    title: str
    meaning: str


#: The ways in which a run may end: the values of the column "status".
ENDS: Final = tuple(outcome.status for outcome in (Completed, Unsupported, Diverged, Crashed, TimedOut))

#: The sign before a bound that stands for an error within the truth's own; some terminals support only ASCII.
WITHIN, WITHIN_ASCII = "≤", "<="

#: The signs of engines and files that agree, differ, are refused, fail, do something forbidden, lack something, or are unknown.
AGREES, DIFFERS, REFUSED, FAILED, AMISS, MISSING, UNKNOWN = "=", "≠", "⊘", "✗", "!", "–", "·"

#: The signs of readings without an answer, apart from crashes: the time was up, the adapter is at fault, or the file cannot be
#: read.
TIMEOUT, ADAPTER, UNREADABLE = "◷", "†", "?"

#: The signs of a change: a larger error of the shown method, a smaller error, and a change of another method.
WORSE, BETTER, OTHER = "▲", "▼", "◆"

#: The verdicts on an engine in a scene: its error is within the truth's own error, it has an error, which is the number shown,
#: a run breaks an expectation, or there is no number.
Verdict = Literal["exact", "error", "broken", "failed", "refused", "unsupported", "not run"]

SCENES: Mapping[Verdict, Word] = {
    "exact": Word(WITHIN, "exact", "The error is no larger than the bound of the reference's own error."),
    "error": Word("", "error", "The run completed. The number is its largest error."),
    "broken": Word(AMISS, "expectation broken", "The run completed, but it breaks an expectation of the case."),
    "failed": Word(FAILED, "failed", "The run diverged, crashed or took too long."),
    "refused": Word(REFUSED, "refused", "The engine itself refuses the model or the file."),
    "unsupported": Word(MISSING, "unsupported", "The engine, or its adapter, does not model what the scene requires."),
    "not run": Word(UNKNOWN, "not run", "Nothing is known: there is no run of this scene in this engine."),
}

#: The verdicts on the expectations of a run: held, broken, or none. The terminal has another word for each, in ASCII.
EXPECTATIONS: Mapping[bool | None, str] = {True: "held", False: "failed", None: MISSING}
PASSED: Mapping[bool | None, str] = {True: "passed", False: "FAILED", None: "-"}

#: The word for broken expectations that the case lists as known discrepancies.
KNOWN = "known"

#: The verdicts on an engine and a robot model, or on one of its quantities: the statuses of parity, of which the first that
#: holds counts, and the lack of a status.
RobotVerdict = Literal[
    "unreadable",
    "crashed",
    "timeout",
    "adapter-fault",
    "refused",
    "differs",
    "accepted-unphysical",
    "not-modelled",
    "agrees",
    "not compared",
]

ROBOTS: Mapping[RobotVerdict, Word] = {
    "agrees": Word(AGREES, "agrees", "agrees with the file"),
    "differs": Word(DIFFERS, "differs", "differs from the file"),
    "refused": Word(REFUSED, "refused", "the engine refuses the file"),
    "crashed": Word(FAILED, "crashed", "the process of the engine died or ran out of memory"),
    "timeout": Word(TIMEOUT, "too slow", "the time limit of the reading was exceeded"),
    "adapter-fault": Word(ADAPTER, "adapter at fault", "the adapter of the engine is at fault, and not the engine or the file"),
    "unreadable": Word(UNREADABLE, "unreadable", "the file is not there, or is no robot's file"),
    "accepted-unphysical": Word(AMISS, "accepted unphysical", "the engine accepts what no body can have"),
    "not-modelled": Word(MISSING, "not modelled", "the engine, or its adapter, does not model it"),
    "not compared": Word(UNKNOWN, "not compared", "nothing is known"),
}

#: The verdicts of the audit on a method and a property: its statuses.
AuditVerdict = Literal["default", "deviates", "none", "not-probed"]

AUDIT: Mapping[AuditVerdict, Word] = {
    "deviates": Word("", "deviates", "a method has it although everything that can be switched off is off"),
    "default": Word("", "by default", "users get it without asking for it"),
    "none": Word(MISSING, "none", "the method is as mechanics has it"),
    "not-probed": Word("?", "not probed", "the flights cannot tell"),
}
