"""Findings of the tradeoff study: sentences about its measurements."""

from collections import Counter, defaultdict
from collections.abc import Collection, Mapping, Sequence

from bodycheck.judging.schemes.convergence import UNITS
from bodycheck.reports.finding import COMPARABLE, COMPARABLE_POSITION_M, MOST_NAMES, Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import bound, count, listing, milliseconds, number, verb
from bodycheck.reports.same_algorithm import NO_CLASSES, Classes, same_algorithm
from bodycheck.results.key import RunKey
from bodycheck.studies.orders import Order
from bodycheck.studies.tradeoff.measurements import CaseMeasurements, Measured

#: An observed order is lower than claimed if even its largest value is lower by more than this.
ORDER_TOLERANCE = 0.25

#: Quantities whose observed orders are compared with the claimed order.
CLAIMED = ("attitude", "position")

#: A scheme explains a discrepancy if it leaves at most this share of it.
EXPLAINED = 0.01

#: Floors (rad, m) are reported only above this value.
LEAST_FLOOR = 1e-6

#: Errors (rad, m) for which the cheapest method is named.
ROUND_ERRORS = (1e-3, 1e-6)

#: The beginning of the finding about cases in which no method is the cheapest.
APART = "Costs of methods that compute efforts between steps and at stages are not compared, on "

#: The two quantities in sentences, with their articles.
ERRORS = {"attitude": "an attitude error", "position": "a position error"}

#: Lines by method.
Lines = Mapping[RunKey, Line]

#: A case, and an order observed in it.
Place = tuple[CaseMeasurements, Order]

#: The name of a case, and the largest attitude differences (rad) of a method in it: from its scheme, and from the truth.
Identified = tuple[str, float, float]

#: A method, its smallest error (rad, m), and its smallest time step (s).
Floor = tuple[RunKey, float, float]

#: The words of a finding about a floor for each of its causes.
CAUSES = {
    "limit": ", because the runs tend to a motion other than the truth",
    "rounding": ", because of rounding in the engine's precision",
    "": "",
}


def findings(cases: Sequence[CaseMeasurements], lines: Lines, classes: Classes = NO_CLASSES) -> tuple[Finding, ...]:
    """Return the findings on orders, equal methods, schemes, floors and the cheapest methods.

    Parameters
    ----------
    cases
        The measurements of each case.
    lines
        The line of each method, by its engine and integrator.
    classes
        The classes of methods that are the same algorithm.
    """
    same = filter(None, (same_algorithm(classes),))
    orders = (*_orders(cases, lines), *_lost(cases, lines))
    return (*orders, *same, *_schemes(cases, lines), *_floors(cases, lines), *_cheapest(cases, lines))


def falls_short(case: CaseMeasurements, order: Order) -> bool:
    """Return whether the observed order of attitude or position is lower than claimed.

    Orders are compared only if the claimed order could have been observed: if the body is not in contact, and the part of the
    error that depends on the time step is far above the truth's own error.
    """
    if order.quantity not in CLAIMED or order.order_high is None or order.claimed is None or case.contact:
        return False
    return order.order_high < order.claimed - ORDER_TOLERANCE and _is_observable(case, order)


def _is_observable(case: CaseMeasurements, order: Order) -> bool:
    """Return whether the part of the error that depends on the time step is far above the truth's own error."""
    least = {"attitude": 0.0, "position": COMPARABLE_POSITION_M}[order.quantity]
    limit = max(least, COMPARABLE * case.truth_error(order.quantity))
    errors = [point.error for point in _own_points(case, order)]
    return bool(errors) and max(errors) - min(errors) > limit


def _own_points(case: CaseMeasurements, order: Order) -> list[Measured]:
    """Return the measurements of a method, one for each time step."""
    return [point for point in case.points(order.quantity) if point.method == order.method]


def _orders(cases: Sequence[CaseMeasurements], lines: Lines) -> list[Finding]:
    """Return a finding for each group of methods with the same orders below the claimed orders.

    If orders were compared and no method has such an order, return a single finding that says so.
    """
    claims = [
        (case, order)
        for case in cases
        for order in case.orders
        if order.quantity in CLAIMED and order.order is not None and order.claimed is not None and not case.contact
    ]
    short: dict[RunKey, list[Place]] = defaultdict(list)
    for case, order in claims:
        if falls_short(case, order):
            short[order.method].append((case, order))
    if claims and not short:
        observed = count(len(claims), "observed order")
        text = f"None of {observed} of attitude and position is lower than claimed by more than {ORDER_TOLERANCE:g}."
        return [Finding("Order", text)]
    groups: dict[object, list[RunKey]] = defaultdict(list)
    for method, places in short.items():
        groups[_likeness(places)].append(method)
    return [_short([lines[method] for method in methods], short[methods[0]]) for methods in groups.values()]


def _likeness(places: Sequence[Place]) -> object:
    """Return a key that is equal for methods with the same claims, cases and orders, to the digits that are printed."""
    return tuple((case.name, order.quantity, order.claimed, f"{order.order:.2f}") for case, order in places)


def _short(methods: Sequence[Line], places: Sequence[Place]) -> Finding:
    """Return a finding about methods that all have the cases and orders of `places`."""
    quantities: dict[str, list[str]] = defaultdict(list)
    for quantity in CLAIMED:
        observed_orders = sorted(order.order or 0.0 for _, order in places if order.quantity == quantity)
        if observed_orders:
            quantities[_range([f"{order:.2f}" for order in observed_orders])].append(quantity)
    observed = listing([f"{orders} in {listing(names)}" for orders, names in quantities.items()])
    worst, order = max(places, key=lambda item: (item[1].claimed or 0) - (item[1].order or 0.0))
    return Finding(
        "Order",
        f"{_names(methods)} {verb(len(methods), 'has', 'have')} an observed order of {observed} "
        f"instead of the claimed {order.claimed}, on ",
        worst.name,
        f"{_others({case.name for case, _ in places})}.",
    )


def _schemes(cases: Sequence[CaseMeasurements], lines: Lines) -> list[Finding]:
    """Return a finding for each textbook scheme and set of cases.

    It names the methods that agree with the scheme or are near it, and says which discrepancy the scheme explains.
    """
    named: dict[tuple[str, RunKey], list[Identified]] = defaultdict(list)
    for case in cases:
        for order in {order.method: order for order in case.orders if order.nearest_scheme}.values():
            row = case.coarsest(order.method)
            if row is not None and "attitude_error" in row and order.scheme_residual is not None:
                named[order.scheme_in_words, order.method].append((case.name, order.scheme_residual, row["attitude_error"]))
    groups: dict[tuple[str, tuple[str, ...]], list[RunKey]] = defaultdict(list)
    for (scheme, method), runs in named.items():
        groups[scheme, tuple(name for name, _, _ in runs)].append(method)
    return [
        _scheme(scheme, [lines[method] for method in methods], [run for method in methods for run in named[scheme, method]])
        for (scheme, _), methods in groups.items()
    ]


def _scheme(scheme: str, methods: Sequence[Line], runs: Sequence[Identified]) -> Finding:
    residual = max(left for _, left, _ in runs)
    where, _, most = max(runs, key=lambda run: run[2])
    discrepancy = f"{'up to ' if len(runs) > 1 else ''}{number(most, 2)} rad"
    explained = all(left <= EXPLAINED * error for _, left, error in runs)
    explains = "The scheme explains the discrepancy from the truth, which" if explained else "The discrepancy from the truth"
    meaning = f"{explains} is {discrepancy}."
    near = f"{verb(len(methods), 'stays', 'stay')} {scheme}, within"
    agrees = f"{verb(len(methods), 'agrees', 'agree')} with {scheme} to within"
    return Finding(
        "Scheme",
        f"{_names(methods)} {near if scheme.startswith('near ') else agrees} {bound(residual, 2)} rad over the whole run, on ",
        where,
        f"{_others({name for name, _, _ in runs})}. {meaning}",
    )


def _lost(cases: Sequence[CaseMeasurements], lines: Lines) -> list[Finding]:
    """Return a finding for each case and each time after which methods lose the attitude with every time step."""
    lost: dict[tuple[str, float], list[Line]] = defaultdict(list)
    for case in cases:
        for order in case.orders:
            if order.horizon is not None:
                lost[case.name, order.horizon].append(lines[order.method])
    return [
        Finding(
            "Order",
            f"With {_names(methods)}, the attitude is lost by the end at any time step; "
            f"the order is that of the first {number(horizon, 3)} s of the same runs, on ",
            name,
            ".",
        )
        for (name, horizon), methods in lost.items()
    ]


def _floors(cases: Sequence[CaseMeasurements], lines: Lines) -> list[Finding]:
    """Return a finding about the largest floor above `LEAST_FLOOR` for each engine, quantity and cause of the floor."""
    floors: dict[tuple[str, str, str], dict[str, list[Floor]]] = defaultdict(lambda: defaultdict(list))
    for case in cases:
        for order in case.orders:
            has_floor = order.quantity in CLAIMED and order.floor is not None and order.horizon is None
            points = _own_points(case, order) if has_floor else []
            if points and (least := min(point.error for point in points)) > LEAST_FLOOR:
                finest = min(point.step for point in points)
                floors[order.engine, order.quantity, order.floor_cause][case.name].append((order.method, least, finest))
    return [_floor(quantity, cause, by_case, lines) for (_, quantity, cause), by_case in floors.items()]


def _floor(quantity: str, cause: str, by_case: Mapping[str, Sequence[Floor]], lines: Lines) -> Finding:
    where = max(by_case, key=lambda name: max(error for _, error, _ in by_case[name]))
    methods, errors, finest = zip(*by_case[where], strict=True)
    return Finding(
        "Floor",
        f"With {_names([lines[method] for method in methods])}, the {quantity} error does not fall below "
        f"{_range([number(error, 2) for error in sorted(errors)])} {UNITS[quantity]} "
        f"at any time step down to {milliseconds(max(finest), 4)} on ",
        where,
        f"{CAUSES[cause]}.{_more_floors(len(by_case) - 1)}",
    )


def _more_floors(cases: int) -> str:
    return f" Such a floor is also found on {count(cases, 'other case')}." if cases else ""


def _cheapest(cases: Sequence[CaseMeasurements], lines: Lines) -> list[Finding]:
    apart = [case.name for case in cases if not case.comparable]
    sentences = [Finding("Cheapest", APART, apart[0], f"{_others(apart)}.")] if apart else []
    for quantity in CLAIMED:
        of_quantity = [case for case in cases if case.primary == quantity and case.comparable]
        # Limits with the same cheapest runs share a finding, which names the lowest of these limits; limits that no run keeps
        # share a finding that names the highest of them.
        by_winners: dict[object, Finding] = {}
        for error in ROUND_ERRORS if of_quantity else ():
            ranked = {case.name: _ranking(case.points(quantity), error) for case in of_quantity}
            kept = {name: ranking for name, ranking in ranked.items() if ranking}
            winners = tuple((name, ranking[0]) for name, ranking in kept.items())
            if not kept:
                by_winners.setdefault(winners, _none_keeps(quantity, error, len(of_quantity)))
            elif len(of_quantity) == 1:
                by_winners[winners] = _cheapest_of_one(quantity, error, of_quantity[0].name, kept[of_quantity[0].name], lines)
            else:
                by_winners[winners] = _cheapest_of_many(quantity, error, len(of_quantity), kept, lines)
        sentences += by_winners.values()
    return sentences


def _ranking(points: Sequence[Measured], error: float) -> list[Measured]:
    """Return the cheapest run of each method with an error of at most `error`, the cheapest first."""
    best: dict[RunKey, Measured] = {}
    for point in sorted(points, key=lambda point: point.cost):
        if point.error <= error:
            best.setdefault(point.method, point)
    return list(best.values())


def _none_keeps(quantity: str, error: float, cases: int) -> Finding:
    anywhere = f" in any of {cases} cases" if cases > 1 else ""
    return Finding("Cheapest", f"No method has {ERRORS[quantity]} of at most {number(error)} {UNITS[quantity]}{anywhere}.")


def _cheapest_of_one(quantity: str, error: float, where: str, ranking: Sequence[Measured], lines: Lines) -> Finding:
    first, unit = ranking[0], UNITS[quantity]
    spread = f"{number(first.cost_low, 2)} to {number(first.cost_high, 2)} s"
    after = (
        f". Its error is {number(first.error, 2)} {unit}, and a simulated second takes {number(first.cost, 2)} s "
        f"({spread} in repeated timings)."
    )
    if len(ranking) > 1:
        second = ranking[1]
        overlap = ", although their timings overlap" if second.cost_low <= first.cost_high else ""
        after += f" The next is {_at(second, lines)}, at {number(second.cost / first.cost, 2)} times the cost{overlap}."
    return Finding("Cheapest", f"The cheapest {_condition(quantity, error)} is {_at(first, lines)} on ", where, after)


def _cheapest_of_many(quantity: str, error: float, cases: int, kept: Mapping[str, Sequence[Measured]], lines: Lines) -> Finding:
    wins = Counter(ranking[0].method for ranking in kept.values())
    bests = [ranking[0] for ranking in kept.values()]
    steps = {method: {best.step: best.setting for best in bests if best.method == method} for method in wins}
    winners = [
        f"{lines[method].label} (at {_range([steps[method][step] for step in sorted(steps[method])])}) in {amount}"
        for method, amount in wins.most_common()
    ]
    rest = f" In {count(cases - len(kept), 'case')}, no method has so small an error." if len(kept) < cases else ""
    best = listing([f"{winners[0]} of {cases} cases", *winners[1:]], MOST_NAMES, "method")
    return Finding("Cheapest", f"The cheapest {_condition(quantity, error)} is {best}.{rest}")


def _condition(quantity: str, error: float) -> str:
    return f"method with {ERRORS[quantity]} of at most {number(error)} {UNITS[quantity]}"


def _at(point: Measured, lines: Lines) -> str:
    return f"{lines[point.method].label} at {point.setting}"


def _others(cases: Collection[str]) -> str:
    """Return the words about the other cases, which follow the name of one case; empty if there is only one."""
    return f" and {count(len(cases) - 1, 'other case')}" if len(cases) > 1 else ""


def _names(lines: Sequence[Line]) -> str:
    return listing([line.label for line in lines], MOST_NAMES, "method")


def _range(texts: Sequence[str]) -> str:
    """Return the range of sorted numbers, given as texts: the first and the last number, or one number if both are equal."""
    return texts[0] if texts[0] == texts[-1] else f"{texts[0]} to {texts[-1]}"
