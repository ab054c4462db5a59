"""What upgrades changed, as sentences made of measurements."""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence

from packaging.version import Version

from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number
from bodycheck.running.outcome import Completed
from bodycheck.studies.releases.rows import STATUS, Change, Row

ORDINALS = {1: "first", 2: "second", 3: "third", 4: "fourth", 5: "fifth", 6: "sixth"}

#: An observed order so near to a whole number is called by it.
WHOLE = 0.1

#: Two observed orders that are so far apart are two.
OTHER = 0.25

#: Of the figures of which the same can be said, those that are told, the first best.
PREFERRED = ("attitude_error", "position_error")

Told = Sequence[tuple[Line, Change]]


def findings(changes: Told, rows: Sequence[Row]) -> tuple[Finding, ...]:
    """A sentence an upgrade and what it did to methods, with the change that says most; or that the rows that are ok agree."""
    measured = [row for row in rows if row["status"] == Completed.status]
    releases = len({row["version"] for row in measured})
    if not changes and releases > 1:
        return (Finding("No change", f"{count(len(measured), 'run')} of {count(releases, 'release')} agree to rounding."),)
    upgrades: dict[tuple[str, str], list[tuple[Line, Change]]] = defaultdict(list)
    for line, change in changes:
        upgrades[change.from_version, change.to_version].append((line, change))
    ordered = sorted(upgrades.values(), key=lambda own: Version(own[0][1].to_version))
    return tuple(finding for own in ordered for finding in (*_figures(own), *_statuses(own)))


def named(line: Line) -> str:
    """The integrator, with the results that the line is of where there are several."""
    return f"{line.integrator} ({line.results})" if line.results else line.integrator


def orders(change: Change) -> str:
    """The observed orders before and after, as tables have them."""
    texts = ["–" if order is None else f"{order:.2f}" for order in (change.order_before, change.order_after)]
    return " → ".join(dict.fromkeys(texts))


def _figures(upgrade: Told) -> Iterator[Finding]:
    """Methods of which the same is to be said together."""
    methods: dict[tuple[str, str], list[tuple[Line, Change]]] = defaultdict(list)
    for line, change in upgrade:
        if change.quantity != STATUS:
            methods[change.integrator, line.results].append((line, change))
    alike: dict[tuple[str, str, str], list[tuple[Line, Change]]] = defaultdict(list)
    for own in methods.values():
        line, change = max(own, key=lambda told: _telling(told[1]))
        others = len({other.case for _, other in own}) - 1
        further = f"; changed on {count(others, 'other case')} too" if others else ""
        alike[_did(change), change.case, f" at {milliseconds(change.timestep)}{further}."].append((line, change))
    for (did, case, where), told in alike.items():
        names = [named(line) for line, _ in told]
        _, change = told[0]
        between = f"Between {change.from_version} and {change.to_version} {listing(names)} {did} on "
        yield Finding(f"{change.engine} {change.to_version}", between, case, where)


def _did(change: Change) -> str:
    """What happened to a method, with the figures."""
    quantity = QUANTITIES[change.quantity]
    assert isinstance(change.before, float)  # it is no status
    assert isinstance(change.after, float)
    before, after = _apart(change.before, change.after)
    return f"{_what(change)}: {before} → {after} {quantity.unit}".rstrip()


def _what(change: Change) -> str:
    """What happened to a method, for what follows a colon: the figures."""
    subject = change.quantity.rpartition("_")[0].replace("_", " ")
    scheme = ""
    if change.scheme_before and change.scheme_after and change.scheme_before != change.scheme_after:
        scheme = f"from {change.scheme_before} to {change.scheme_after}"
    if _other_order(change):
        went = f"went from {_order(change.order_before)} to {_order(change.order_after)} order in {subject}"
        return f"{went}, {scheme}" if scheme else went
    title = QUANTITIES[change.quantity].title.lower()
    return f"went {scheme}, {title}" if scheme else f"changed its {title}"


def _statuses(upgrade: Told) -> Iterator[Finding]:
    """Methods that went from one status to another one together."""
    statuses: dict[tuple[str, str], list[Change]] = defaultdict(list)
    for _, change in upgrade:
        if change.quantity == STATUS:
            statuses[str(change.before), str(change.after)].append(change)
    for (before, after), own in statuses.items():
        change, methods = own[0], listing(list(dict.fromkeys(change.integrator for change in own)), 6, "method")
        others = len({other.case for other in own}) - 1
        went = f"runs of {methods} went from {before} to {after}"
        between = f"Between {change.from_version} and {change.to_version} {went} on "
        further = f" and {count(others, 'other case')}." if others else "."
        yield Finding(f"{change.engine} {change.to_version}", between, change.case, further)


def _telling(change: Change) -> tuple[bool, bool, int, float]:
    """The larger, the more a change says of a method."""
    preferred = len(PREFERRED) - PREFERRED.index(change.quantity) if change.quantity in PREFERRED else 0
    other_scheme = change.scheme_before != change.scheme_after
    return _other_order(change), other_scheme, preferred, change.factor or math.inf


def _other_order(change: Change) -> bool:
    before, after = change.order_before, change.order_after
    return before is not None and after is not None and abs(before - after) > OTHER


def _order(order: float | None) -> str:
    assert order is not None  # both are known where they differ
    whole = round(order)
    return ORDINALS[whole] if whole in ORDINALS and abs(order - whole) <= WHOLE * whole else f"{order:.2f}-th"


def _apart(before: float, after: float) -> tuple[str, str]:
    """Two figures with as many digits as it takes to see a difference."""
    for digits in (3, 4, 6, 9, 12):
        if number(before, digits) != number(after, digits):
            break
    return number(before, digits), number(after, digits)
