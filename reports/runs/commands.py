"""The commands that reproduce single runs."""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.judging.judgement import Verdict


@dataclass(frozen=True)
class Command:
    """The command that reproduces a run.

    Parameters
    ----------
    anchor
        The anchor of the command in the page.
    method
        The label of the method in this report.
    text
        The command, quoted for a shell.
    """

    anchor: str
    method: str
    text: str


def curve_anchor(case: str, quantity: str) -> str:
    """Return the anchor of the chart of a quantity over time."""
    return f"curve-{case}-{quantity}"


def command(verdict: Verdict, case: Sequence[str]) -> str:
    """Return the command that reproduces a run, or that compares the log of a recorded motion again.

    case: the path of the case file, or the name of a shipped case, with the options by which it is read.
    """
    run = verdict.run
    if run.is_recorded:
        return shlex.join(["bodycheck", "compare", "LOG.csv", *case, "--name", run.engine, "--version", run.version])
    asked = ("--engine", run.engine, "--integrator", run.method.name, "--timestep", repr(run.method.timestep))
    return shlex.join(["bodycheck", "run", *case, *asked])
