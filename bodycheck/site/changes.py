"""What changed between two runs of the same method on the same scene by more than rounding explains."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bodycheck.reports.quantities import Quantity
from bodycheck.site.catalogue import Entry

#: The relative change of an error below which nothing is said: rounding alone changes errors of chaotic motions by less.
SMALLEST = 0.01


@dataclass(frozen=True, eq=False)
class Change:
    """A difference between two runs.

    Parameters
    ----------
    before, after
        The two runs.
    quantity
        The name of the column that differs: "status" or an error.
    worse
        Whether the later run is worse; None where neither is, as between two ways to fail.
    """

    before: Entry
    after: Entry
    quantity: str
    worse: bool | None


def since(runs: Sequence[Entry], newest: Sequence[Entry], quantity: Quantity) -> Iterator[Change]:
    """Yield what changed between some runs and those of the same methods before them.

    runs: those of one scene in one engine, the oldest versions first. newest: those that are asked about.
    """
    for run in newest:
        earlier = before(runs, run)
        found = change(run, earlier, quantity) if earlier is not None else None
        if found is not None:
            yield found


def before(runs: Sequence[Entry], run: Entry) -> Entry | None:
    """Return the run of the same method in the last older version, or the last older results of the version, or None.

    runs: those of one scene in one engine, the oldest versions first.
    """
    same = [
        entry for entry in runs if entry.method == run.method and entry.source is not run.source and entry.order < run.order
    ]
    return same[-1] if same else None


def change(after: Entry, earlier: Entry, quantity: Quantity) -> Change | None:
    """Return what changed of a quantity, or of the status, beyond rounding and the truth's own error; None if nothing did."""
    if after.get("status") != earlier.get("status"):
        worse = None if "ok" not in (after.get("status"), earlier.get("status")) else after.get("status") != "ok"
        return Change(earlier, after, "status", worse)
    now, then = after.get(quantity.name), earlier.get(quantity.name)
    if now is None or then is None:
        return None
    bound = max(after.get(quantity.bound_name) or 0.0, earlier.get(quantity.bound_name) or 0.0)
    if abs(now - then) <= max(bound, SMALLEST * max(abs(now), abs(then))):
        return None
    return Change(earlier, after, quantity.name, abs(now) > abs(then))
