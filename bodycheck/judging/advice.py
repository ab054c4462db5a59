"""Next steps for a broken expectation: the commands that find the cause, accept the change or tolerate it."""

import shlex
from collections.abc import Iterator
from dataclasses import dataclass

from bodycheck.adapters.engine_name import EngineName
from bodycheck.casefile.case import is_shipped
from bodycheck.casefile.expectation import Limit
from bodycheck.figures.columns import FIGURES
from bodycheck.judging.judgement import Judged, Verdict

#: A placeholder in a command for a release that bodycheck does not know.
EARLIER = "EARLIER_VERSION"


@dataclass(frozen=True)
class Step:
    """One next step. why: its purpose, as a phrase; what: a command, or text for the case file."""

    why: str
    what: str


def steps(verdict: Verdict, judged: Judged, file: str, where: str) -> Iterator[Step]:
    """Yield the next steps for an expectation that does not hold.

    Parameters
    ----------
    verdict
        The verdict on the run.
    judged
        The judgement on the expectation.
    file
        The path of the case file, or the name of a shipped case.
    where
        The position of the expectation in the file, in words.
    """
    limits = [limit for limit in judged.expectation.limits if limit.name in FIGURES]
    broken = {breach.name for breach in judged.breaches}
    measured = {} if verdict.discrepancy is None else verdict.discrepancy.maxima()
    figures = [limit for limit in limits if limit.name in broken and limit.name in measured]
    # A run that fails exceeds every limit, so any limit finds the release in which the run began to fail.
    bisectable = figures or [limit for limit in limits if limit.at_most is not None and "status" in broken]
    if bisectable and not verdict.run.is_recorded and judged.expectation.version != verdict.run.version:
        yield Step("to find the release of the engine that changed it", _bisect(verdict, judged, bisectable[0], file))
    numbers = [limit.name for limit in figures if limit.at_least is None]
    if numbers and not verdict.run.is_recorded and not is_shipped(file):
        named = [word for name in numbers for word in ("--figure", name)]
        yield Step(
            "to accept what is measured now, if it is right",
            shlex.join(["bodycheck", "expect", file, *_method(verdict), *named]),
        )
    if judged.expectation.known:
        yield Step(f"to tolerate it longer, in {where}", 'until = "YYYY-MM-DD"')
    else:
        yield Step(f"to tolerate it until a day, in {where}", 'known = "where it is discussed" and until = "YYYY-MM-DD"')


def of_run(verdict: Verdict, file: str) -> tuple[Step, ...]:
    """Return the next steps for all expectations of a run that do not hold. file: as for `steps`."""
    broken = [judged for judged in verdict.judged if not judged.held]
    advised = [step for judged in broken for step in steps(verdict, judged, file, f"its [[expect]] in {file}")]
    return tuple(dict.fromkeys(advised))


def lines(verdict: Verdict, file: str) -> list[str]:
    """Return the result of `of_run` as text, one line per step."""
    return [f"{step.why}: {step.what}" for step in of_run(verdict, file)]


def _bisect(verdict: Verdict, judged: Judged, limit: Limit, file: str) -> str:
    """Return the command that finds the release in which a figure passed one end of its range.

    The command calls a release good if the figure is at most the limit. If the figure has become too small, the limit is the
    lower end of the range; the new release is then the good one, and the earlier release the bad one.
    """
    before, now = judged.expectation.version or EARLIER, verdict.run.version
    measured = {} if verdict.discrepancy is None else verdict.discrepancy.maxima()
    too_small = limit.at_most is None or (
        limit.at_least is not None and measured.get(limit.name, limit.at_least) < limit.at_least
    )
    good, bad, end = (now, before, limit.at_least) if too_small else (before, now, limit.at_most)
    method = ("--integrator", verdict.run.method.name, "--timestep", repr(verdict.run.method.timestep))
    options = ("--case", file, "--quantity", limit.name, "--limit", repr(end), *method)
    return shlex.join(["bodycheck", "bisect", EngineName.parse(verdict.run.engine).adapter, good, bad, *options])


def _method(verdict: Verdict) -> tuple[str, ...]:
    run = verdict.run
    return ("--engine", run.engine, "--integrator", run.method.name, "--timestep", repr(run.method.timestep))
