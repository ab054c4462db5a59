"""The result of the study in sentences: on the cheapest method, the second cheapest, and methods that never keep the limit."""

from bodycheck.reports.quantities import QUANTITIES, bound, count, listing, number, verb
from bodycheck.studies.recommend.rows import Answer, Recommendation


def headline(recommendation: Recommendation) -> str:
    """Return a sentence with the best method, its time step, its error over the duration, and its cost."""
    best, duration = recommendation.best, f"{number(recommendation.asked.duration)} s"
    if best is None:
        return f"No method keeps the {name_of(recommendation)} to {limit(recommendation)} over {duration}."
    cost = "; its cost could not be measured" if best.cost is None else f", {number(best.cost, 2)} s of computing per second"
    return f"{method(best)} at {step(best)}: {error(recommendation, best.error)} over {duration}{cost}."


def margin(recommendation: Recommendation) -> str:
    """Return sentences about the limit and the best method's margin to it; empty if no method keeps the limit."""
    best = recommendation.best
    if best is None:
        return ""
    size = "" if best.margin is None else f"The margin is {number(best.margin, 3)}: "
    asked = f"{'the' if size else 'The'} {name_of(recommendation)} asked for is {limit(recommendation)}"
    return f"{size}{asked}. {larger(recommendation, best)}"


def larger(recommendation: Recommendation, answer: Answer) -> str:
    """Return a sentence about the smallest measured time step at which the method of an answer breaks the limit.

    If there is no such time step, the sentence says that larger time steps were not tried.
    """
    if answer.broken is None:
        return "Larger steps are not tried, since a run would have fewer than ten."
    errors = {probe.timestep: probe for probe in recommendation.probes if probe.method == answer.method}
    probe = errors[answer.broken]
    if probe.error is None:
        return f"At {number(answer.broken)} s, the run ends with the status {probe.status}."
    return f"At {number(answer.broken)} s, the {name_of(recommendation)} is {error(recommendation, probe.error, 3)}."


def second(recommendation: Recommendation) -> str:
    """Return a sentence about the second method; empty if there is none."""
    first, *others = recommendation.reached or (None,)
    if first is None or not others:
        return ""
    answer = others[0]
    if first.cost is None or answer.cost is None:
        return f"The next best is {method(answer)} at {step(answer)}: {error(recommendation, answer.error)}."
    times = f"at {number(answer.cost / first.cost, 2)} times the cost"
    near = answer.cost_low is not None and first.cost_high is not None and answer.cost_low <= first.cost_high
    overlap = "; the timings of both overlap" if near else ""
    return f"The next best is {method(answer)} at {step(answer)}: {error(recommendation, answer.error)} {times}{overlap}."


def never(recommendation: Recommendation) -> tuple[str, ...]:
    """Return a sentence for each group of methods that do not keep the limit with any time step."""
    tried = [answer for answer in recommendation.unreached if answer.error is not None]
    failed = [answer for answer in recommendation.unreached if answer.error is None]
    sentences = []
    if tried:
        smallest = max(answer.smallest for answer in tried if answer.smallest is not None)
        by_error: dict[str, list[str]] = {}
        for answer in tried:
            by_error.setdefault(error(recommendation, answer.error), []).append(method(answer))
        limit_with = f"the limit with steps down to {number(smallest)} s"
        figure = name_of(recommendation)
        if len(by_error) == 1:
            ((least, names),) = by_error.items()
            never_keeps, their = verb(len(names), "never keeps", "never keep"), verb(len(names), "its", "their")
            sentences.append(f"{listing(names)} {never_keeps} {limit_with}; {their} {figure} is {least} at best.")
        else:
            at_best = "; it is ".join(f"{least} with {listing(names)}" for least, names in by_error.items())
            sentences.append(f"{len(tried)} methods never keep {limit_with}. At best, the {figure} is {at_best}.")
    reasons: dict[str, list[str]] = {}
    for answer in failed:
        reasons.setdefault(answer.reason, []).append(method(answer))
    sentences += [
        f"{listing(names)} {verb(len(names), 'has', 'have')} no result: {reason}." for reason, names in reasons.items()
    ]
    return tuple(sentences)


def effort(recommendation: Recommendation) -> str:
    """Return a sentence with the numbers of runs and methods."""
    runs, methods = len(recommendation.probes), len(recommendation.answers)
    return f"{count(runs, 'run')} of {count(methods, 'method')}; nothing is extrapolated."


def method(answer: Answer) -> str:
    """Return the names of the engine and the method of an answer."""
    return f"{answer.engine} {answer.integrator}"


def step(answer: Answer) -> str:
    """Return the time step of an answer with its unit."""
    return f"{number(answer.timestep)} s"


def error(recommendation: Recommendation, value: float | None, digits: int = 2) -> str:
    """Return an error with its unit, as text with a number of significant digits."""
    return f"{number(value, digits)} {recommendation.asked.unit}".rstrip()


def limit(recommendation: Recommendation) -> str:
    """Return the limit with its unit, as a phrase that begins with "at most"."""
    return f"at most {number(recommendation.asked.error)} {recommendation.asked.unit}".rstrip()


def name_of(recommendation: Recommendation) -> str:
    """Return the title of the figure, as it is written inside a sentence."""
    title = QUANTITIES[recommendation.asked.figure].title
    return f"{title[0].lower()}{title[1:]}"


def truth_error(recommendation: Recommendation) -> str:
    """Return a sentence about the truth's own error in the figure; empty if it is not known."""
    largest = max((probe.truth_error for probe in recommendation.probes if probe.truth_error is not None), default=None)
    return (
        ""
        if largest is None
        else f"The truth's own error is at most {bound(largest, 2)} {recommendation.asked.unit}".rstrip() + "."
    )
