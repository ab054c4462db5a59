"""The result of the study in sentences: the cheapest method first, then the second, then those that never keep the limit."""

from bodycheck.reports.quantities import QUANTITIES, bound, count, listing, number, verb
from bodycheck.studies.recommend.rows import Answer, Recommendation


def headline(found: Recommendation) -> str:
    """Return the answer in one sentence: method, time step, error over the duration, and cost."""
    best = found.best
    if best is None:
        return f"No method keeps the {name_of(found)} to {limit(found)} over {number(found.asked.duration)} s."
    cost = "; its cost could not be measured" if best.cost is None else f", {number(best.cost, 2)} s of computing per second"
    return f"{method(best)} at {step(best)}: {error(found, best.error)} over {number(found.asked.duration)} s{cost}."


def margin(found: Recommendation) -> str:
    """Return a sentence about the error asked for and the margin of the best method to it; empty if there is none."""
    best = found.best
    if best is None:
        return ""
    size = "" if best.margin is None else f"The margin is {number(best.margin, 3)}: "
    asked = f"{'the' if size else 'The'} {name_of(found)} asked for is {limit(found)}"
    return f"{size}{asked}. {larger(found, best)}"


def larger(found: Recommendation, own: Answer) -> str:
    """Return what the next larger measured time step leads to, in a sentence."""
    if own.broken is None:
        return "Larger steps are not tried, since a run would have fewer than ten."
    errors = {probe.timestep: probe for probe in found.probes if probe.method == own.method}
    probe = errors[own.broken]
    what = f"it is {error(found, probe.error, 3)}" if probe.error is not None else f"the run ends as {probe.status}"
    return f"At {number(own.broken)} s {what}."


def second(found: Recommendation) -> str:
    """Return a sentence about the second method; empty if there is none."""
    first, *others = found.reached or (None,)
    if first is None or not others:
        return ""
    own = others[0]
    if first.cost is None or own.cost is None:
        return f"Second is {method(own)} at {step(own)}: {error(found, own.error)}."
    times = f"at {number(own.cost / first.cost, 2)} times the cost"
    near = own.cost_low is not None and first.cost_high is not None and own.cost_low <= first.cost_high
    overlap = ", and their timings overlap" if near else ""
    return f"Second is {method(own)} at {step(own)}: {error(found, own.error)} {times}{overlap}."


def never(found: Recommendation) -> tuple[str, ...]:
    """Return a sentence for each group of methods that do not keep the limit with any time step."""
    tried = [own for own in found.unreached if own.error is not None]
    failed = [own for own in found.unreached if own.error is None]
    sentences = []
    if tried:
        smallest = max(own.smallest for own in tried if own.smallest is not None)
        by_error: dict[str, list[str]] = {}
        for own in tried:
            by_error.setdefault(error(found, own.error), []).append(method(own))
        groups = "; ".join(f"{listing(names)} ({least} at best)" for least, names in by_error.items())
        these = verb(len(tried), "This one never gets", "These never get")
        sentences.append(f"{these} there with steps down to {number(smallest)} s: {groups}.")
    reasons: dict[str, list[str]] = {}
    for own in failed:
        reasons.setdefault(own.reason, []).append(method(own))
    sentences += [
        f"{listing(names)} {verb(len(names), 'has', 'have')} no result: {reason}." for reason, names in reasons.items()
    ]
    return tuple(sentences)


def effort(found: Recommendation) -> str:
    """Return how much was measured, in a sentence."""
    return f"{count(len(found.probes), 'run')} of {count(len(found.answers), 'method')}; nothing is extrapolated."


def method(own: Answer) -> str:
    """Return the engine and the method of an answer."""
    return f"{own.engine} {own.integrator}"


def step(own: Answer) -> str:
    """Return the time step of an answer with its unit."""
    return f"{number(own.timestep)} s"


def error(found: Recommendation, value: float | None, digits: int = 2) -> str:
    """Return an error with its unit, to so many significant digits."""
    return f"{number(value, digits)} {found.asked.unit}".rstrip()


def limit(found: Recommendation) -> str:
    """Return the limit with its unit, as the end of a phrase."""
    return f"at most {number(found.asked.error)} {found.asked.unit}".rstrip()


def name_of(found: Recommendation) -> str:
    """Return the name of the figure in a sentence."""
    title = QUANTITIES[found.asked.figure].title
    return f"{title[0].lower()}{title[1:]}"


def truth_error(found: Recommendation) -> str:
    """Return a sentence about the truth's own error in the figure; empty if it is not known."""
    own = max((probe.truth_error for probe in found.probes if probe.truth_error is not None), default=None)
    return "" if own is None else f"The truth's own error is at most {bound(own, 2)} {found.asked.unit}".rstrip() + "."
