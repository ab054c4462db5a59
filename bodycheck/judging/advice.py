"""What to do next where an expectation does not hold: the commands that find the cause, accept the change or tolerate it."""

import shlex
from collections.abc import Iterator
from dataclasses import dataclass

from bodycheck.casefile.expectation import Limit
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.judgement import Judged, Verdict

#: Stands in a command for a release that bodycheck does not know.
EARLIER = "EARLIER_VERSION"


@dataclass(frozen=True)
class Step:
    """One thing to do. why: a phrase with what it is good for; what: a command, or what to write into the case file."""

    why: str
    what: str


def steps(verdict: Verdict, judged: Judged, file: str, place: str) -> Iterator[Step]:
    """Yield what to do about an expectation that does not hold.

    Parameters
    ----------
    verdict
        The verdict on the run.
    judged
        The judgement on the expectation.
    file
        The path of the case file, or the name of a shipped case.
    place
        Where the expectation is in the file, for the reader.
    """
    broken = [limit for limit in judged.expectation.limits if any(breach.name == limit.name for breach in judged.breaches)]
    figures = [limit for limit in broken if limit.name in FIGURES]
    if figures and judged.expectation.version != verdict.run.version:
        yield Step("which release of the engine changed it", _bisect(verdict, judged, figures[0], file))
    if numbers := [limit.name for limit in figures if limit.at_least is None]:
        asked = [word for name in numbers for word in ("--figure", name)]
        yield Step("if what is measured now is right", shlex.join(["bodycheck", "expect", file, *_method(verdict), *asked]))
    if not judged.expectation.known:
        yield Step(f"to tolerate it until a day, in {place}", 'known = "where it is discussed" and until = "YYYY-MM-DD"')


def lines(verdict: Verdict, file: str) -> list[str]:
    """Return what to do about all expectations of a run that do not hold, a line for each step; file: as `steps` takes it."""
    broken = [judged for judged in verdict.judged if not judged.held]
    found = [step for judged in broken for step in steps(verdict, judged, file, f"its [[expect]] in {file}")]
    return [f"{step.why}: {step.what}" for step in dict.fromkeys(found)]


def _bisect(verdict: Verdict, judged: Judged, limit: Limit, file: str) -> str:
    """Return the command that finds the release in which a figure passed one end of its range.

    A release is good to it that stays below the end, so that of a figure that has become too small the new one is.
    """
    before, now = judged.expectation.version or EARLIER, verdict.run.version
    measured = {} if verdict.discrepancy is None else verdict.discrepancy.maxima()
    too_small = limit.at_most is None or (
        limit.at_least is not None and measured.get(limit.name, limit.at_least) < limit.at_least
    )
    good, bad, end = (now, before, limit.at_least) if too_small else (before, now, limit.at_most)
    method = ("--integrator", verdict.run.method.name, "--timestep", repr(verdict.run.method.timestep))
    asked = ("--case", file, "--quantity", limit.name, "--limit", repr(end), *method)
    return shlex.join(["bodycheck", "bisect", verdict.run.engine, good, bad, *asked])


def _method(verdict: Verdict) -> tuple[str, ...]:
    run = verdict.run
    return ("--engine", run.engine, "--integrator", run.method.name, "--timestep", repr(run.method.timestep))
