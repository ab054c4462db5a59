"""Findings about the changes at upgrades: sentences about the measured changes."""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence

from packaging.version import Version

from bodycheck.reports.finding import Finding
from bodycheck.reports.lines import Line
from bodycheck.reports.quantities import QUANTITIES, count, listing, milliseconds, number
from bodycheck.results.outcome import Completed
from bodycheck.studies.releases.rows import STATUS, Change, Row

#: Whole orders in words.
ORDINALS = {1: "first", 2: "second", 3: "third", 4: "fourth", 5: "fifth", 6: "sixth"}

#: Largest relative distance of an observed order from a whole number for it to be called by this number.
WHOLE = 0.1

#: Difference above which two observed orders count as different.
OTHER = 0.25

#: Quantities that findings prefer, the best first.
PREFERRED = ("attitude_error", "position_error")

#: A change with the line of its method.
LabelledChange = tuple[Line, Change]


def findings(changes: Sequence[LabelledChange], rows: Sequence[Row]) -> tuple[Finding, ...]:
    """Return findings about the changes at each upgrade, with the most important change of each method.

    If nothing changed between several releases, return one finding that the completed runs agree.
    """
    measured = [row for row in rows if row["status"] == Completed.status]
    releases = len({row["version"] for row in measured})
    if not changes and releases > 1:
        return (
            Finding("No change", f"{count(len(measured), 'run')} of {count(releases, 'release')} agree to within rounding."),
        )
    upgrades: dict[tuple[str, str], list[LabelledChange]] = defaultdict(list)
    for line, change in changes:
        upgrades[change.from_version, change.to_version].append((line, change))
    ordered = sorted(upgrades.values(), key=lambda upgrade: Version(upgrade[0][1].to_version))
    return tuple(finding for upgrade in ordered for finding in (*_figures(upgrade), *_statuses(upgrade)))


def named(line: Line) -> str:
    """Return the integrator of a line, with the label of its set of results if it has a label."""
    return f"{line.integrator} ({line.results})" if line.results else line.integrator


def orders(change: Change) -> str:
    """Return the observed orders before and after a change, as text for tables."""
    texts = ["–" if order is None else f"{order:.2f}" for order in (change.order_before, change.order_after)]
    return " → ".join(dict.fromkeys(texts))


def _figures(upgrade: Sequence[LabelledChange]) -> Iterator[Finding]:
    """Yield a finding for each group of methods whose most important change of a figure is the same."""
    methods: dict[tuple[str, str], list[LabelledChange]] = defaultdict(list)
    for line, change in upgrade:
        if change.quantity != STATUS:
            methods[change.integrator, line.results].append((line, change))
    alike: dict[tuple[str, str, str, str], list[LabelledChange]] = defaultdict(list)
    for labelled_changes in methods.values():
        line, change = max(labelled_changes, key=lambda labelled: _importance(labelled[1]))
        others = len({other.case for _, other in labelled_changes}) - 1
        further = f" Results of {count(others, 'other case')} changed too." if others else ""
        after = f" at {milliseconds(change.timestep)}.{further}"
        alike[_what(change, ""), _values(change), change.case, after].append((line, change))
    for (_, values, case, after), labelled_changes in alike.items():
        _, change = labelled_changes[0]
        did = _what(change, listing([named(line) for line, _ in labelled_changes]))
        between = f"Between {change.from_version} and {change.to_version}, {did} {values} on "
        yield Finding(f"{change.engine} {change.to_version}", between, case, after)


def _values(change: Change) -> str:
    """Return the numbers of a change in words, with enough digits to show that they differ."""
    quantity = QUANTITIES[change.quantity]
    assert isinstance(change.before, float)  # because it is not a status
    assert isinstance(change.after, float)
    before, after = _apart(change.before, change.after)
    return f"from {before} to {after} {quantity.unit}".rstrip()


def _what(change: Change, methods: str) -> str:
    """Return the beginning of a sentence about a change of methods. It ends with "changed", and the numbers follow it."""
    title = QUANTITIES[change.quantity].title.lower()
    went = []
    if _other_order(change):
        subject = change.quantity.rpartition("_")[0].replace("_", " ")
        went.append(f"from {_order(change.order_before)} to {_order(change.order_after)} order in {subject}")
    if change.scheme_before and change.scheme_after and change.scheme_before != change.scheme_after:
        went.append(f"from {change.scheme_before} to {change.scheme_after}")
    if went:
        return f"{methods} went {listing(went)}: the {title} changed"
    return f"the {title} of {methods} changed"


def _statuses(upgrade: Sequence[LabelledChange]) -> Iterator[Finding]:
    """Yield a finding for each pair of statuses before and after an upgrade, with all methods that changed so."""
    statuses: dict[tuple[str, str], list[Change]] = defaultdict(list)
    for _, change in upgrade:
        if change.quantity == STATUS:
            statuses[str(change.before), str(change.after)].append(change)
    for (before, after), same_status in statuses.items():
        change, methods = same_status[0], listing(list(dict.fromkeys(change.integrator for change in same_status)), 6, "method")
        others = len({other.case for other in same_status}) - 1
        went = f"the status of runs with {methods} changed from {before} to {after}"
        between = f"Between {change.from_version} and {change.to_version}, {went} on "
        further = f" and {count(others, 'other case')}." if others else "."
        yield Finding(f"{change.engine} {change.to_version}", between, change.case, further)


def _importance(change: Change) -> tuple[bool, bool, int, float]:
    """Return a key that is larger for more important changes of a method.

    A change of the order comes first, then a change of the scheme, a preferred quantity, and a large factor.
    """
    preferred = len(PREFERRED) - PREFERRED.index(change.quantity) if change.quantity in PREFERRED else 0
    other_scheme = change.scheme_before != change.scheme_after
    return _other_order(change), other_scheme, preferred, change.factor or math.inf


def _other_order(change: Change) -> bool:
    before, after = change.order_before, change.order_after
    return before is not None and after is not None and abs(before - after) > OTHER


def _order(order: float | None) -> str:
    assert order is not None  # because orders that differ are both known
    whole = round(order)
    return ORDINALS[whole] if whole in ORDINALS and abs(order - whole) <= WHOLE * whole else f"{order:.2f}-th"


def _apart(before: float, after: float) -> tuple[str, str]:
    """Return two numbers as texts, with enough digits to show that they differ, up to 12."""
    for digits in (3, 4, 6, 9, 12):
        if number(before, digits) != number(after, digits):
            break
    return number(before, digits), number(after, digits)
