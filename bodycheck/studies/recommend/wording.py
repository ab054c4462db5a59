"""The result of the study in sentences: on the cheapest method, the second cheapest, and methods that never keep the limit."""

import math
from collections.abc import Sequence

from bodycheck.adapters.method import Method
from bodycheck.reports.quantities import QUANTITIES, bound, count, exactly, listing, number, verb
from bodycheck.studies.recommend import search
from bodycheck.studies.recommend.rows import Answer, Asked, Recommendation
from bodycheck.studies.timesteps import FINE_ACCURACIES


def headline(recommendation: Recommendation) -> str:
    """Return a sentence with the best method, its time step, its error over the duration, and its cost."""
    best, duration = recommendation.best, f"{number(recommendation.asked.duration)} s"
    if best is None:
        return f"No method keeps the {name_of(recommendation)} to {limit(recommendation)} over {duration}."
    cost = "; its cost could not be measured" if best.cost is None else f", {number(best.cost, 2)} s of computing per second"
    steps = ""
    if best.timestep is not None and not best.is_controlled:
        steps = f" ({of_number(recommendation.asked, best, number_of(recommendation, best))})"
    return f"{method(best)} {at_step(best)}{steps}: {error(recommendation, best.error)} over {duration}{cost}."


def margin(recommendation: Recommendation) -> str:
    """Return sentences about the limit and the best method's margin to it; empty if no method keeps the limit."""
    best = recommendation.best
    if best is None or best.timestep is None:
        return ""
    figure, asked = name_of(recommendation), limit(recommendation)
    larger_step = larger(recommendation, best)
    if best.margin is None or best.worst is None:
        return f"The {figure} asked for is {asked}. {larger_step}"
    fewest, *_, most = search.neighbours(number_of(recommendation, best))
    worst = bounded_error(recommendation, best.worst, 3)
    between = f"{fewest * recommendation.asked.periods} to {most * recommendation.asked.periods} steps"
    if best.is_controlled:
        between = f"accuracies from {accuracy_of(fewest)} to {accuracy_of(most)}"
    near = f"with {between}, the {figure} is at most {worst}"
    return f"The margin is {number(best.margin, 3)}: {near}, and {asked} is asked for. {larger_step}"


def larger(recommendation: Recommendation, answer: Answer) -> str:
    """Return a sentence about the smallest measured time step or accuracy at which the method of an answer breaks the limit.

    If there is none, the sentence says that larger ones were not tried.
    """
    asked = recommendation.asked
    probes = {asked.number(probe.engine_method): probe for probe in recommendation.of(answer)}
    errors = asked.errors(probes.values())
    broken = max((number for number, measured in errors.items() if measured > asked.error), default=None)
    if broken is None:
        if answer.is_controlled:
            return "Larger accuracies are not tried, larger than 0.1."
        in_period = asked.periods > 1 and 1 in errors
        why = (
            "since they would be longer than a period of the controllers"
            if in_period
            else "since a run would have fewer than ten"
        )
        return f"Larger steps are not tried, {why}."
    probe, numbered = probes[broken], of_number(asked, answer, broken)
    if probe.error is None:
        return f"With {numbered}, the run ends with the status {probe.status}."
    return f"With {numbered}, it is {error(recommendation, probe.error, 4)}."


def jumps(recommendation: Recommendation) -> tuple[str, ...]:
    """Return sentences about the methods whose error is not monotone: with two time steps of the first, and with the others."""
    asked = recommendation.asked
    errors = {answer: asked.errors(recommendation.of(answer)) for answer in recommendation.answers}
    pairs = [(answer, pair) for answer in errors if (pair := search.reversal(errors[answer], asked.error)) is not None]
    if not pairs:
        return ()
    (first, (more, fewer)), *others = pairs
    least, largest = errors[first][fewer], errors[first][more]
    kind = "accuracy" if first.is_controlled else "time step"
    shown = "the run fails" if math.isinf(largest) else f"it is {error(recommendation, largest)}"
    sentence = (
        f"The {name_of(recommendation)} of {method(first)} is not monotone in the {kind}: with "
        f"{of_number(asked, first, fewer)} it is {error(recommendation, least)}, and with "
        f"{of_number(asked, first, more)} {shown}."
    )
    if not others:
        return (sentence,)
    that_is = verb(len(others), "That", "Those"), verb(len(others), "is", "are")
    return (sentence, f"{that_is[0]} of {listing([method(answer) for answer, _ in others])} {that_is[1]} not monotone either.")


def second(recommendation: Recommendation) -> str:
    """Return a sentence about the second method; empty if there is none."""
    first, *others = recommendation.reached or (None,)
    if first is None or not others:
        return ""
    answer = others[0]
    if first.cost is None or answer.cost is None:
        return f"The next best is {method(answer)} {at_step(answer)}: {error(recommendation, answer.error)}."
    if first.efforts != answer.efforts:
        apart = f"; its efforts are computed {answer.efforts}, and its cost is not compared"
        return f"The next best is {method(answer)} {at_step(answer)}: {error(recommendation, answer.error)}{apart}."
    times = f"at {number(answer.cost / first.cost, 2)} times the cost"
    near = answer.cost_low is not None and first.cost_high is not None and answer.cost_low <= first.cost_high
    overlap = "; the timings of both overlap" if near else ""
    return f"The next best is {method(answer)} {at_step(answer)}: {error(recommendation, answer.error)} {times}{overlap}."


def never(recommendation: Recommendation) -> tuple[str, ...]:
    """Return a sentence for each group of methods that do not keep the limit with any time step."""
    asked = recommendation.asked
    tried = [answer for answer in recommendation.unreached if answer.error is not None and answer.error > asked.error]
    single = [answer for answer in recommendation.unreached if answer.error is not None and answer.error <= asked.error]
    failed = [answer for answer in recommendation.unreached if answer.error is None]
    sentences = []
    if tried:
        by_error: dict[str, list[str]] = {}
        for answer in tried:
            by_error.setdefault(error(recommendation, answer.error), []).append(method(answer))
        limit_with = f"the limit with {_down_to(recommendation, tried)}"
        figure = name_of(recommendation)
        if len(by_error) == 1:
            ((least, names),) = by_error.items()
            never_keeps, their = verb(len(names), "never keeps", "never keep"), verb(len(names), "its", "their")
            sentences.append(f"{listing(names)} {never_keeps} {limit_with}; {their} {figure} is {least} at best.")
        else:
            at_best = "; it is ".join(f"{least} with {listing(names)}" for least, names in by_error.items())
            sentences.append(f"{len(tried)} methods never keep {limit_with}. At best, the {figure} is {at_best}.")
    if single:
        methods, keeps = listing(list(map(method, single))), verb(len(single), "keeps", "keep")
        sentences.append(f"{methods} {keeps} the limit only with single steps, whose neighbours break it or were not measured.")
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
    """Return the time step of an answer with its unit, such that a run with the printed number is the same run."""
    return "–" if answer.timestep is None else f"{exactly(answer.timestep)} s"


def at_step(answer: Answer) -> str:
    """Return a phrase with the time step of an answer, or with its largest step."""
    return f"with steps of at most {step(answer)}" if answer.is_controlled else f"at {step(answer)}"


def number_of(recommendation: Recommendation, answer: Answer) -> int:
    """Return the number of the time step or the accuracy of an answer in its search."""
    assert answer.timestep is not None  # a run completed
    number = recommendation.asked.number(Method.parse(answer.integrator, answer.timestep))
    assert number is not None  # the search made the run
    return number


def of_number(asked: Asked, answer: Answer, number: int) -> str:
    """Return the number of steps, or the accuracy, that has a number in the search of an answer's method, in words."""
    return f"an accuracy of {accuracy_of(number)}" if answer.is_controlled else count(number * asked.periods, "step")


def accuracy_of(number: int) -> str:
    """Return the accuracy that has a number in searches, as it is spelled."""
    return f"{FINE_ACCURACIES[number - 1]:g}"


def _down_to(recommendation: Recommendation, answers: Sequence[Answer]) -> str:
    """Return the ranges of time steps and of accuracies in which all of these answers were searched for, in words."""
    steps = [answer.smallest for answer in answers if answer.smallest is not None]
    errors = [recommendation.asked.errors(recommendation.of(answer)) for answer in answers if answer.is_controlled]
    ranges = [f"steps down to {number(max(steps))} s"] if steps else []
    ranges += [f"accuracies down to {accuracy_of(min(max(numbers) for numbers in errors if numbers))}"] if any(errors) else []
    return " and ".join(ranges)


def error(recommendation: Recommendation, value: float | None, digits: int = 2) -> str:
    """Return an error with its unit, as text with a number of significant digits."""
    return f"{number(value, digits)} {recommendation.asked.unit}".rstrip()


def bounded_error(recommendation: Recommendation, value: float, digits: int) -> str:
    """Return an error with its unit, rounded up to a number of significant digits."""
    return f"{bound(value, digits)} {recommendation.asked.unit}".rstrip()


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
