"""The results of the study in sentences: the cost of the file's own step, the cheapest step, where it breaks, and coverage."""

from collections.abc import Iterator, Mapping, Sequence

from bodycheck.adapters.engine_name import in_words
from bodycheck.reports.quantities import QUANTITIES, listing, milliseconds, number
from bodycheck.studies.estimate.factors import factors
from bodycheck.studies.estimate.quantities import AT_END
from bodycheck.studies.estimate.rows import (
    CHAOTIC,
    DIVERGED,
    ESTIMATE,
    NO_TIME,
    NOT_ASYMPTOTIC,
    RESET,
    UNSUPPORTED,
    Choice,
    EstimateRow,
    Estimates,
    Solver,
    choices,
)

#: Why each verdict of the own step has no number, as a clause.
WITHOUT = {
    NOT_ASYMPTOTIC: "cannot be estimated",
    NO_TIME: "could not be estimated in the time",
    UNSUPPORTED: "is not known",
}


def headline(results: Estimates) -> str:
    """Return the sentence that says what the numbers are: estimates, of the engine's own limit."""
    engines = listing([name.split("@")[0] for name in results.present]) or "no engine"
    return (
        f"{results.file}, {number(results.duration)} s: the errors are estimates, of the own limit of {engines} as h → 0, "
        "which is the motion with ever smaller time steps h; what the model itself is worth is not asked."
    )


def sentences(results: Estimates) -> Iterator[str]:
    """Yield sentences on each engine: its own step, the cheapest one, where it breaks, coverage, and other engines."""
    chosen = choices(results)
    for engine, (integrator, timestep) in results.present.items():
        rows = [row for row in results.rows if row.engine == engine]
        if not integrator:
            yield f"{in_words(engine, rows[0].version)}: {rows[0].reason}."
            continue
        yield own_step(results, rows, integrator, timestep)
        yield from solver(results, rows, results.solvers.get(engine))
        yield cheapest(results, [one for one in chosen if one.engine == engine], rows[0], timestep)
        yield from breaks(rows)
        yield coverage(results.kinds[engine])
        yield from apart(results, engine)
    yield from spread(results)
    if results.causes:
        told = "; ".join(f"{engine} {cause}" for engine, cause in results.causes.items())
        yield f"Compared with the numbers of the file by `bodycheck parity`: {told}."


def own_step(results: Estimates, rows: Sequence[EstimateRow], integrator: str, timestep: float) -> str:
    """Return a sentence on what the present step costs in error."""
    present = [
        row for row in rows if row.integrator == integrator and row.timestep == timestep and not row.quantity.endswith(AT_END)
    ]
    step = f"{in_words(rows[0].engine, rows[0].version)} {integrator} at {milliseconds(timestep, 4)}, the present step"
    if not present:
        return f"{step}, was not run."
    known = [row for row in present if row.verdict == ESTIMATE and row.estimate is not None]
    if known:
        return f"{step}, costs {listing([_error(row) for row in known])} over {number(results.duration)} s.{_rest(present)}"
    row = next((row for row in present if row.quantity in results.compared), present[0])
    if row.verdict.startswith(CHAOTIC):
        until = "" if row.estimate is None else f"; until {number(row.horizon)} s it costs {_error(row)}"
        return f"{step}, is {row.verdict} s{until}."
    if row.verdict in (DIVERGED, RESET):
        return f"{step}, does not complete: {row.reason}."
    until = "" if row.horizon is None else f", but until {number(row.horizon)} s it is asymptotic"
    return f"{step}: its error {WITHOUT.get(row.verdict, 'is not known')}{until}: {row.reason}."


def _rest(present: Sequence[EstimateRow]) -> str:
    """Return a sentence on the quantities of a step without an estimate, with a space before it; empty if all have one."""
    rest = [row for row in present if row.verdict == NOT_ASYMPTOTIC]
    if not rest:
        return ""
    names = listing([QUANTITIES[row.quantity].title.lower() for row in rest])
    return f" It has no estimate of {names}: {rest[0].reason}."


def solver(results: Estimates, rows: Sequence[EstimateRow], cost: Solver | None) -> Iterator[str]:
    """Yield a sentence on what the settings of the solver in the file cost beside the present step."""
    if cost is None or not cost.errors:
        return
    integrator, timestep = results.present[rows[0].engine]
    costs = {row.quantity: row.estimate for row in rows if (row.integrator, row.timestep) == (integrator, timestep)}
    name, error = max(cost.errors.items(), key=lambda entry: entry[1])
    named, of_step = QUANTITIES[name], costs.get(name)
    settings = f"The settings of the solver ({cost.iterations} iterations, tolerance {cost.tolerance:g})"
    if error == 0:
        yield f"{settings} cost nothing: a stricter solver makes no difference."
        return
    size = " ".join(filter(None, (number(error, 2), named.unit, f"of {named.title.lower()}")))
    until = "" if cost.until >= results.duration else f" until {number(cost.until)} s"
    stopped = "; some steps end at this number of iterations" if cost.needed >= cost.iterations else ""
    compared = ""
    if of_step:
        more = error > of_step
        compared = ", more than the step: change them before the step" if more else ", less than the step: they need no change"
    yield f"{settings} cost {size}{until}{compared}{stopped}."


def _error(row: EstimateRow) -> str:
    """Return the estimate of a row with its interval, unit and quantity."""
    quantity = QUANTITIES[row.quantity]
    interval = f"({number(row.low, 3)} to {number(row.high, 3)})"
    return " ".join(filter(None, (number(row.estimate, 3), interval, quantity.unit, f"of {quantity.title.lower()}")))


def cheapest(results: Estimates, chosen: Sequence[Choice], row: EstimateRow, present: float) -> str:
    """Return a sentence on the cheapest method and step of an engine that keep the allowed error."""
    allowed = number(results.error)
    if not chosen:
        return f"No step of {row.engine} that was tried is known to keep {allowed} in {_compared(results)}."
    best, *others = chosen
    speed = f"{number(1 / best.cost, 2)} times as fast as real time" if best.cost < 1 else "slower than real time"
    ratio = best.timestep / present
    steps = f"{number(ratio, 3)} times the present step" if ratio >= 1 else f"{number(1 / ratio, 3)} times as many steps"
    second = f" The next is {_method(others[0])} at {number(others[0].cost / best.cost, 2)} times the cost." if others else ""
    return (
        f"To keep {allowed}, the cheapest is {_method(best)}, {steps}: at most {number(best.high, 3)}, at "
        f"{number(best.cost, 2)} s of computing per second, {speed}.{second}"
    )


def _compared(results: Estimates) -> str:
    """Return the quantities that are compared with the allowed error and that the scene has, in words."""
    names = dict.fromkeys(row.quantity for row in results.rows if row.quantity in results.compared)
    return listing([QUANTITIES[name].title.lower() for name in names]) or "any quantity"


def _method(choice: Choice) -> str:
    return f"{choice.integrator} at {milliseconds(choice.timestep, 6)}"


def breaks(rows: Sequence[EstimateRow]) -> Iterator[str]:
    """Yield a sentence for each method on the smallest step with which it fails, and the largest with which it completes."""
    for integrator in dict.fromkeys(row.integrator for row in rows):
        of_method = [row for row in rows if row.integrator == integrator]
        failed = [row for row in of_method if row.verdict in (DIVERGED, RESET)]
        stable = [row.timestep for row in of_method if row.verdict not in (DIVERGED, RESET, NO_TIME, UNSUPPORTED)]
        if failed:
            first = min(failed, key=lambda row: row.timestep)
            below = max((step for step in stable if step < first.timestep), default=None)
            largest = "" if below is None else f"; with {milliseconds(below, 4)} it completes"
            yield f"{integrator} breaks at {milliseconds(first.timestep, 4)}: {first.reason}{largest}."
        elif stable:
            yield f"{integrator} completes with every step that was tried, up to {milliseconds(max(stable), 4)}."


def coverage(kind: str) -> str:
    """Return a sentence on how often intervals of a class of scenes are right."""
    known = next((one for name, one in factors().items() if name == kind), None)
    if known is None:
        return ""
    if not known.sample:
        return f"How often the intervals of this class ({kind}) are right is not measured yet."
    return f"Such an interval (class of scenes: {kind}) {known.told}, measured in {known.engine}."


def apart(results: Estimates, engine: str) -> Iterator[str]:
    """Yield a sentence on the distance of the finest run from the truth of a case: that of the engine's model."""
    for quantity, (distance, bound) in results.apart.get(engine, {}).items():
        named = QUANTITIES[quantity]
        unit = f" {named.unit}" if named.unit else ""
        yield (
            f"The finest run of {engine} is {number(distance, 3)}{unit} from rigid mechanics in {named.title.lower()} (the "
            f"truth is known to {number(bound, 2)}{unit}): the distance of the model, apart from the estimates."
        )


def spread(results: Estimates) -> Iterator[str]:
    """Yield sentences on the limits of pairs of engines: whether they differ by more than the errors of the finest runs."""
    for (one, other), differences in results.spread.items():
        apart = {name: value for name, value in differences.items() if value[0] > value[1]}
        if apart:
            yield (
                f"The limits of {one} and {other} differ by {listing(_sizes(apart))}: a difference of models, not of time "
                "steps."
            )
        elif differences:
            yield (
                f"The limits of {one} and {other} are the same within the errors of their finest runs: they differ by at most "
                f"{listing(_sizes(differences))}."
            )
        else:
            yield f"The limits of {one} and {other} are not compared: there is no quantity in which both have an estimate."


def _sizes(differences: Mapping[str, tuple[float, float]]) -> list[str]:
    """Return differences and their uncertainties with their units and quantities."""
    texts = []
    for name, (value, uncertain) in differences.items():
        unit = f" {QUANTITIES[name].unit}" if QUANTITIES[name].unit else ""
        texts.append(f"{number(value, 3)} ± {number(uncertain, 1)}{unit} of {QUANTITIES[name].title.lower()}")
    return texts
