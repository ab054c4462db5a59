"""What the commands of the studies print."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from bodycheck.convergence import UNITS
from bodycheck.studies import release_rows
from bodycheck.studies.ablation_rows import Change, ModelRow
from bodycheck.studies.extreme_rows import Limit, Row
from bodycheck.studies.orders import Order
from bodycheck.studies.recommendation import Measured, Recommendation
from bodycheck.terminal import print_table

if TYPE_CHECKING:  # what measures releases is for their commands alone
    from bodycheck.studies import bisection


def print_tradeoff(rows: Sequence[Mapping[str, Any]], orders: Sequence[Order]) -> None:
    """A line a run, then a line a method and quantity."""
    runs = ("case", "engine", "integrator", "step", "status", "position m", "attitude rad", "us/step", "cost s/s", "reason")
    print_table(runs, map(_row, rows))
    print()
    methods = ("case", "engine", "integrator", "quantity", "order", "claimed", "floor", "scheme", "residual rad")
    print_table(methods, map(_order, orders))


def print_recommendations(found: Sequence[Recommendation], front: Sequence[Measured], quantity: str, error: float) -> None:
    """The methods that keep the limit with their measured neighbours, then the Pareto front."""
    limit = f"{quantity} error of at most {error:g} ({UNITS[quantity] or 'relative'})"
    print(f"{limit}, the cheapest first" if found else f"no method that was measured keeps an {limit}")
    if found:
        header = ("engine", "integrator", "step s", "error", "cost s/s", "coarser step", "its error", "finer step", "its error")
        print_table(header, map(_recommendation, found))
    print("\nno other method beats these in both error and cost")
    print_table(("engine", "integrator", "step s", "error", "cost s/s"), map(_method, front))


def print_extremes(rows: Sequence[Row], limits: Sequence[Limit]) -> None:
    """A line a run, those that are healthy to their engine alone first, then a line a method and spin."""
    header = ("case", "engine", "integrator", "step", "axis", "value", "status", "engine said", "seen")
    print_table(header, map(_extreme, sorted(rows, key=lambda row: not row.believed)))
    if limits:
        print("\nthe largest stable step")
        print_table(("case", "engine", "integrator", "spin rad/s", "step s", "spin x step rad"), map(_limit, limits))
    print(f"{len(rows)} runs, {sum(row.believed for row in rows)} of them healthy to their engine and not right")


def print_ablation(rows: Sequence[ModelRow]) -> None:
    """A line a model."""
    header = ("case", "engine", "integrator", "step", "model", "us/step", "cost", "position change m", "attitude change rad")
    print_table((*header, "reason"), map(_model, rows))


def print_releases(found: release_rows.Found) -> None:
    """A line a change, from release to release, then a line for each release that could not be measured."""
    header = ("case", "integrator", "step", "from", "to", "quantity", "before", "after", "factor", "order", "scheme")
    if found.changes:
        print_table(header, map(_release_change, found.changes))
    for version, reason in found.header["unmeasured"].items():
        print(f"{version}: not measured: {reason}")
    made = release_rows.made(found.rows)
    print(f"changes: {len(found.changes)}; runs: {len(made)}; releases: {len({row['version'] for row in made})}")


def print_removed(engine: str, versions: Sequence[str]) -> None:
    """The releases whose environments are gone."""
    print(f"{engine}: removed {', '.join(versions)}" if versions else f"{engine}: there was no environment")


def print_bisection(found: "bisection.Found", observer: "bisection.Observer") -> None:
    """The two releases between which a figure broke its limit, and what it took to find them."""
    limit = observer.limit
    where = f"{observer.engine} {limit.integrator} on {limit.case.name} at {limit.timestep:g} s"
    good, bad = observer.looks[found.last_good], observer.looks[found.first_bad]
    print(f"{where}: {limit.quantity} is at most {limit.most:g} in {good.text}; not in {bad.text}")
    if found.unknown:
        print(f"between them, nothing can be told of {', '.join(found.unknown)}")
    print(f"{len(found.probed)} releases looked at, environments made for it: {observer.made}")


def _release_change(change: release_rows.Change) -> tuple[str, ...]:
    before, after = (value if isinstance(value, str) else f"{value:.4g}" for value in (change.before, change.after))
    orders = " → ".join("?" if order is None else f"{order:.2f}" for order in (change.order_before, change.order_after))
    schemes = " → ".join(dict.fromkeys(scheme or "?" for scheme in (change.scheme_before, change.scheme_after)))
    where = (change.case, change.integrator, f"{change.timestep:g}", change.from_version, change.to_version, change.quantity)
    return (*where, before, after, _figure(change.factor), orders.replace("? → ?", ""), "" if schemes == "?" else schemes)


def _model(row: ModelRow) -> tuple[str, ...]:
    names = (row.case, row.engine, row.integrator, f"{row.timestep:g}", row.model)
    spread = f" ({_figure(row.relative_cost_low)} to {_figure(row.relative_cost_high)})" if row.relative_cost else ""
    changes = [_change(row.changes.get(quantity)) for quantity in ("position", "attitude")]
    return (*names, _figure(_times(1e6, row.time_per_step)), _figure(row.relative_cost) + spread, *changes, row.reason)


def _change(change: Change | None) -> str:
    if change is None:
        return ""
    if change.is_rounding:
        return "none"
    return f"{change.size:.3g}" + ("" if change.agrees else " > time-step errors")


def _row(row: Mapping[str, Any]) -> tuple[str, ...]:
    texts = (row["case"], row["engine"], row["integrator"], f"{row['timestep']:g}", row["status"])
    figures = (row["position_error"], row["attitude_error"], _times(1e6, row["time_per_step"]), row["cost"])
    return (*texts, *map(_figure, figures), row["reason"])


def _order(order: Order) -> tuple[str, ...]:
    interval = "" if order.order is None else f"{order.order:.2f} ({order.order_low:.2f} to {order.order_high:.2f})"
    claimed = "" if order.claimed is None else str(order.claimed)
    names = (order.case, order.engine, order.integrator, order.quantity)
    return (*names, interval, claimed, _figure(order.floor), order.scheme, _figure(order.scheme_residual))


def _recommendation(found: Recommendation) -> tuple[str, ...]:
    neighbours = [
        text
        for method in (found.coarser, found.finer)
        for text in (("-", "-") if method is None else (f"{method.timestep:g}", _figure(method.error)))
    ]
    return (*_method(found.method), *neighbours)


def _method(method: Measured) -> tuple[str, ...]:
    cost = f"{method.cost:.3g} ({method.cost_low:.3g} to {method.cost_high:.3g})"
    return (method.engine, method.integrator, f"{method.timestep:g}", _figure(method.error), cost)


def _times(scale: float, value: float | None) -> float | None:
    return None if value is None else scale * value


def _figure(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _extreme(row: Row) -> tuple[str, ...]:
    place = (row.case, row.engine, row.integrator, f"{row.timestep:g}", row.axis, f"{row.value:.10g}")
    return (*place, row.status, row.engine_said, row.detail)


def _limit(limit: Limit) -> tuple[str, ...]:
    figures = (limit.largest_stable_timestep, limit.spin_times_step)
    return (limit.case, limit.engine, limit.integrator, f"{limit.spin:g}", *map(_figure, figures))
