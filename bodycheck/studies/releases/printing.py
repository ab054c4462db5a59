"""Print the tables of the study of releases to the terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bodycheck.console.figures import figure_text
from bodycheck.console.terminal import print_table
from bodycheck.studies.releases import rows as release_rows

if TYPE_CHECKING:  # importing it at run time would be slow
    from bodycheck.studies.releases import bisection


def print_releases(found: release_rows.Found) -> None:
    """Print one line per change from release to release, then one line per release that could not be measured."""
    header = ("case", "integrator", "step", "from", "to", "quantity", "before", "after", "factor", "order", "scheme")
    if found.changes:
        print_table(header, map(_release_change, found.changes))
    for version, reason in found.header["unmeasured"].items():
        print(f"{version}: not measured: {reason}")
    made = release_rows.made(found.rows)
    print(f"changes: {len(found.changes)}; runs: {len(made)}; releases: {len({row['version'] for row in made})}")


def print_removed(engine: str, versions: Sequence[str]) -> None:
    """Print the releases whose environments were removed."""
    print(f"{engine}: removed {', '.join(versions)}" if versions else f"{engine}: there was no environment")


def print_bisection(found: "bisection.Found", observer: "bisection.Observer") -> None:
    """Print the two releases between which a figure exceeded its limit, and the effort to find them."""
    limit = observer.limit
    where = f"{observer.engine} {limit.integrator} on {limit.case.name} at {limit.timestep:g} s"
    good, bad = observer.looks[found.last_good], observer.looks[found.first_bad]
    print(f"{where}: {limit.quantity} is at most {limit.most:g} in {good.text}; not in {bad.text}")
    if found.unknown:
        print(f"these releases between them could not be measured: {', '.join(found.unknown)}")
    print(f"releases measured: {len(found.probed)}; environments made: {observer.made}")


def _release_change(change: release_rows.Change) -> tuple[str, ...]:
    before, after = (value if isinstance(value, str) else f"{value:.4g}" for value in (change.before, change.after))
    orders = " → ".join("?" if order is None else f"{order:.2f}" for order in (change.order_before, change.order_after))
    schemes = " → ".join(dict.fromkeys(scheme or "?" for scheme in (change.scheme_before, change.scheme_after)))
    where = (change.case, change.integrator, f"{change.timestep:g}", change.from_version, change.to_version, change.quantity)
    return (*where, before, after, figure_text(change.factor), orders.replace("? → ?", ""), "" if schemes == "?" else schemes)
