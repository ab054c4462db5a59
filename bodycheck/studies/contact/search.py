"""Search for the settings of an engine with which bodies that touch move best: pure functions of the measured errors.

The search begins at a method. Each sweep changes it in every single way that the record of the engine allows: another
integrator, or another value of an option. Then the changes that are improvements are combined, the best of each choice: the two
best ones, the three best ones, and so on. The best of all these methods is where the next sweep begins, until no method is
better. At last the best method is tried with a quarter of the time step.

The score of a method is the geometric mean over scenes of its largest error of the position, relative to that of the method at
which the search began. A method that does not complete one of these scenes has no score, and neither has one whose errors in
the first scenes are so large that it is not measured in the others (`promising`).
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from bodycheck.adapters.contract import Engine, Kind, Method
from bodycheck.adapters.offers import integrator_of, knows, not_offered_for, options_of

#: The most sweeps of a search.
SWEEPS = 2

#: The time step of the last trial, as a multiple of that of the best method.
FINER = 0.25

#: The numbers that are tried for an option, as far as the option accepts them.
NUMBERS = ("0", "0.01", "0.1", "1", "10", "100")

#: Options that are no settings of an engine's contacts: they replace the model of the scene, the dimensions of its friction or
#: the readings of sensors, or are the tolerance of methods with error control, whose steps are not fixed.
LEFT_OUT = frozenset({"model", "pads", "condim", "sensors", "sensordelay", "sensorinterval", "control", "limits", "accuracy"})

#: Errors of the position below this (m) count as this: in scenes at rest, some methods differ by rounding alone.
FLOOR = 1e-5

#: A method is better than another if its score is below this part of the other's.
BETTER = 0.95

#: A method whose score in the scenes so far is above this is not measured in the other ones.
HOPELESS = 1.25

#: The errors (m) of a method, by scene; scenes that it does not complete are left out.
Errors = Mapping[str, float]

#: The choice that a change is of, such as an option, and the changed method.
Change = tuple[str, Method]


def changes(engine: Engine, kind: Kind, start: Method) -> Iterator[Change]:
    """Yield the methods that differ from a method in one choice, with the name of the choice.

    Parameters
    ----------
    engine
        The record of the engine.
    kind
        The kind of the scenes.
    start
        The method.
    """
    present = integrator_of(engine, start)
    for integrator in engine.integrators:
        if integrator != present and kind not in integrator.refuses:
            yield "integrator", Method(integrator.name, start.timestep, start.options)
    for key, option in options_of(engine, present).items() if present is not None else ():
        if key in LEFT_OUT or kind not in option.kinds:
            continue
        if start.option(key) is not None:
            yield key, start.without(key)
        for value in (*option.words, *filter(option.accepts, NUMBERS)):
            if value != start.option(key):
                yield key, start.with_option(key, value)


def variations(engine: Engine, kind: Kind, start: Method) -> tuple[Change, ...]:
    """Return the changes of a method that the engine offers for a kind of scene, and the methods with options that it lists.

    A listed method may differ in several choices; its choice is its spelling.
    """
    single = [(choice, method) for choice, method in changes(engine, kind, start) if _is_offered(engine, kind, method)]
    listed = [Method.parse(spelling, start.timestep) for spelling in engine.variants.get(kind, ())]
    there = {method for _, method in single} | {start}
    new = [method for method in listed if method not in there and not LEFT_OUT & dict(method.options).keys()]
    return *single, *((method.name, method) for method in new)


def _is_offered(engine: Engine, kind: Kind, method: Method) -> bool:
    return knows(engine, method.name) and not_offered_for(engine, kind, method) is None


def combined(engine: Engine, kind: Kind, start: Method, improvements: Sequence[Change]) -> tuple[Method, ...]:
    """Return the methods with the first two, the first three and more changes of a method, as far as the engine offers them.

    improvements: the changes of single choices, each choice once, the best first.
    """
    method, together = start, []
    for number, (choice, changed) in enumerate(improvements):
        method = merged(method, choice, changed)
        if number and _is_offered(engine, kind, method):
            together.append(method)
    return tuple(together)


def merged(method: Method, choice: str, changed: Method) -> Method:
    """Return a method with a choice of another method."""
    if choice == "integrator":
        return Method(changed.integrator, method.timestep, method.options)
    value = changed.option(choice)
    return method.without(choice) if value is None else method.with_option(choice, value)


def score(errors: Errors, start: Errors) -> float:
    """Return the score of a method from its errors and those of the method at which the search began."""
    if not start or not start.keys() <= errors.keys():
        return math.inf
    ratios = [max(errors[scene], FLOOR) / max(first, FLOOR) for scene, first in start.items()]
    return math.exp(math.fsum(map(math.log, ratios)) / len(ratios)) if all(map(math.isfinite, ratios)) else math.inf


def promising(errors: Errors, start: Errors) -> bool:
    """Return whether a method is worth being measured in more scenes.

    Parameters
    ----------
    errors
        The errors of the method in the scenes so far.
    start
        The errors in these scenes of the method at which the search began.
    """
    return not start or score(errors, start) <= HOPELESS


def improvements(scores: Mapping[Change, float], least: float) -> tuple[Change, ...]:
    """Return the best change of each single choice that is better than a score, the best first."""
    best: dict[str, Change] = {}
    for change in sorted(scores, key=lambda one: scores[one]):
        choice, method = change
        if scores[change] < BETTER * least and choice != method.name:
            best.setdefault(choice, change)
    return tuple(best.values())


@dataclass(frozen=True)
class Best:
    """The result of a search.

    Attributes
    ----------
    start, method
        The method to whose errors scores are relative, and the best one.
    scores
        The scores of all methods that were measured; infinite for those that do not complete the scenes of the start.
    """

    start: Method
    method: Method
    scores: Mapping[Method, float]


def search(
    engine: Engine,
    kind: Kind,
    starts: Sequence[Method],
    measure: Callable[[Sequence[Method]], Mapping[Method, Errors]],
) -> Best:
    """Search for the best method of an engine.

    Parameters
    ----------
    engine, kind
        The record of the engine, and the kind of the scenes.
    starts
        Methods of which the best is where the search begins. Scores are relative to the first.
    measure
        Function that measures methods, and returns their errors. It is called several times, with all methods of a stage.
    """
    first = measure(starts[:1])[starts[0]]
    scores = {starts[0]: 1.0}

    def better(best: Method, methods: Sequence[Method]) -> Method:
        """Measure methods, and return the best of all, or the best so far if none is better."""
        new = list(dict.fromkeys(method for method in methods if method not in scores))
        scores.update({method: score(errors, first) for method, errors in measure(new).items()})
        least = min(scores, key=lambda method: scores[method])
        return least if scores[least] < BETTER * scores[best] else best

    best = better(starts[0], starts) if first else starts[0]
    for _ in range(SWEEPS if first else 0):
        around = variations(engine, kind, best)
        changed = better(best, [method for _, method in around])
        good = improvements({change: scores[change[1]] for change in around}, scores[best])
        changed = better(changed, combined(engine, kind, best, good))
        if changed == best:
            break
        best = changed
    if first:
        best = better(best, [best.at(FINER * best.timestep)])
    return Best(starts[0], best, scores)
