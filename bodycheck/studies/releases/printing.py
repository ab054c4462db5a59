"""Print the tables of the study of releases to the terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bodycheck.console.options import View
from bodycheck.console.output import tell
from bodycheck.console.tables import Column, attribute, show
from bodycheck.studies.releases import rows as release_rows

if TYPE_CHECKING:  # importing it at run time would be slow
    from bodycheck.studies.releases import bisection


def _orders(change: release_rows.Change) -> str:
    orders = " → ".join("?" if order is None else f"{order:.2f}" for order in (change.order_before, change.order_after))
    return orders.replace("? → ?", "")


def _schemes(change: release_rows.Change) -> str:
    schemes = " → ".join(dict.fromkeys(scheme or "?" for scheme in (change.scheme_before, change.scheme_after)))
    return "" if schemes == "?" else schemes


#: The columns of the table of changes.
CHANGES = (
    attribute("case", goes=1),
    attribute("integrator"),
    attribute("timestep", "step", "g", goes=3),
    attribute("from_version", "from"),
    attribute("to_version", "to"),
    attribute("quantity"),
    attribute("before", form=".4g"),
    attribute("after", form=".4g"),
    attribute("factor", goes=2),
    Column("order", "order", _orders, goes=4),
    Column("scheme", "scheme", _schemes, goes=5, wraps=True),
)


def print_releases(results: release_rows.Found, view: View) -> None:
    """Print one line per change between releases, one line per release that could not be measured, and a summary."""
    if results.changes:
        show(CHANGES, results.changes, view)
    for version, reason in results.header["unmeasured"].items():
        tell(f"{version}: not measured: {reason}")
    run_rows = release_rows.made(results.rows)
    tell(f"changes: {len(results.changes)}; runs: {len(run_rows)}; releases: {len({row['version'] for row in run_rows})}")


def print_removed(engine: str, versions: Sequence[str]) -> None:
    """Print the releases whose environments were removed."""
    tell(f"{engine}: removed {', '.join(versions)}" if versions else f"{engine}: there was no environment")


def print_bisection(result: "bisection.Found", observer: "bisection.Observer") -> None:
    """Print the two releases between which a figure exceeded its limit, and the effort to find them."""
    limit = observer.limit
    where = f"{observer.engine} {limit.integrator} on {limit.case.name} at {limit.timestep:g} s"
    good, bad = observer.looks[result.last_good], observer.looks[result.first_bad]
    tell(f"{where}: {limit.quantity} is at most {limit.most:g} in {good.text}; not in {bad.text}")
    if result.unknown:
        tell(f"these releases between them could not be measured: {', '.join(result.unknown)}")
    tell(f"releases measured: {len(result.probed)}; environments made: {observer.made}")
