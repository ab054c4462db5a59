"""Changes between two runs of the same method on the same scene that are larger than rounding explains.

`RULE` is the rule in words for readers, and `change` is its implementation.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bodycheck.judging.schemes.convergence import LARGEST_GROWTH, LOST_RAD, STEP_ROUNDINGS
from bodycheck.results.outcome import Completed
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.studies.releases.rows import ALLOWANCE_SUFFIX

#: The relative change of an error that always counts as no change, where the effect of rounding is estimated.
SMALLEST = 0.01

#: The factor by which an error must change if rounding may decide on its digits.
LARGE = 10.0

#: The tag of cases whose motion is chaotic.
CHAOTIC = "chaotic"

#: The `quantity` of a `Change` that is a change of the status.
STATUS = "status"

#: The relative rounding error by the precision of an engine.
ROUNDOFF = {"float64": 2.0**-53, "float32": 2.0**-24}

#: The rule in words for readers, as paragraphs.
RULE = (
    "Two runs of the same method, time step and scene are compared in the quantity of the scene. A different status, such as "
    "diverged instead of ok, is always a change.",
    "Where a study of releases has measured by how much rounding and the error of the truth move the two errors, they have "
    "changed if they differ by more than the sum of both allowances.",
    "Elsewhere the effect of rounding is not known, and is estimated. An error has changed if it differs by more than 1 % of "
    "the larger one, by more than the bound of the truth's own error, and by more than "
    f"{STEP_ROUNDINGS:g} roundings of 1 rad or 1 m in each step of the run.",
    f"It must differ by a factor of {LARGE:g} where rounding may decide on its digits: in cases that are tagged as chaotic, "
    f"where an attitude is lost (an error above {LOST_RAD:g} rad is of the order of the motion itself), and where it is so "
    f"small that those roundings, grown by {LARGEST_GROWTH:,.0f} along the motion, may be all of it. In single precision "
    "the last holds for most errors.".replace(",000", " 000"),
)


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
        Whether the later run is worse; None if neither run is worse, as with two different failures.
    """

    before: Entry
    after: Entry
    quantity: str
    worse: bool | None

    @property
    def factor(self) -> float | None:
        """Return the ratio of the larger error to the smaller one; None for a change of the status or if an error is zero."""
        if self.quantity == STATUS:
            return None
        small, large = sorted((abs(self.before.get(self.quantity)), abs(self.after.get(self.quantity))))
        return float(large / small) if small else None

    @property
    def severity(self) -> float:
        """Return the factor after errors below the rounding of the runs are raised to it; infinity for a change of the status.

        A change between two errors near rounding therefore has a small severity.
        """
        if self.quantity == STATUS:
            return math.inf
        floor = max(rounding(run) for run in (self.before, self.after))
        small, large = sorted(max(abs(run.get(self.quantity)), floor) for run in (self.before, self.after))
        return float(large / small)


def since(catalogue: Catalogue, scene: Scene, newest: Sequence[Entry]) -> Iterator[Change]:
    """Yield the changes of runs of one scene in one engine from the previous runs of the same methods; see `before`."""
    for run in newest:
        earlier = before(catalogue.runs[run.engine, scene.name], run)
        found = change(catalogue, scene, run, earlier) if earlier is not None else None
        if found is not None:
            yield found


def before(runs: Sequence[Entry], run: Entry) -> Entry | None:
    """Return the last earlier run of the same method, from another submission; None if there is no such run.

    A run is earlier if its version is older, or if the same version was run before. runs: the runs of one scene in one engine,
    the oldest versions first.
    """
    same = [
        entry for entry in runs if entry.method == run.method and entry.source is not run.source and entry.order < run.order
    ]
    return same[-1] if same else None


def contradictions(catalogue: Catalogue, scene: Scene, run: Entry) -> tuple[Entry, ...]:
    """Return the runs of the same method in the same version of an engine, from other submissions, that say something else.

    They differ from the run by `RULE`. Of several that agree with one another, the newest is returned. The newest come first.
    """
    others: list[Entry] = []
    for entry in reversed(catalogue.runs[run.engine, scene.name]):
        same = (entry.version, entry.method) == (run.version, run.method) and entry.source is not run.source
        if same and all(change(catalogue, scene, one, entry) is not None for one in (run, *others)):
            others.append(entry)
    return tuple(others)


def change(catalogue: Catalogue, scene: Scene, after: Entry, earlier: Entry) -> Change | None:
    """Return the change of the status, or of the error in the quantity of a scene, by `RULE`; None if nothing changed."""
    if after.get("status") != earlier.get("status"):
        completes, completed = (run.get("status") == Completed.status for run in (after, earlier))
        worse = not completes if completes or completed else None
        return Change(earlier, after, STATUS, worse)
    quantity = scene.quantity
    now, then = after.get(quantity.name), earlier.get(quantity.name)
    if now is None or then is None:
        return None
    allowed = [allowance(catalogue, run, quantity.name) for run in (earlier, after)]
    if None not in allowed:
        changed = abs(now - then) > math.fsum(one for one in allowed if one is not None)
    else:
        changed = _beyond_estimate(scene, earlier, after, then, now)
    return Change(earlier, after, quantity.name, abs(now) > abs(then)) if changed else None


def allowance(catalogue: Catalogue, run: Entry, quantity: str) -> float | None:
    """Return by how much rounding and the error of the truth change a figure of a run; None if no study has measured this."""
    measured = catalogue.allowances.get((run.engine, run.version, run.row["case"], *run.method))
    return None if measured is None else measured.get(f"{quantity}{ALLOWANCE_SUFFIX}")


def _beyond_estimate(scene: Scene, earlier: Entry, after: Entry, then: float, now: float) -> bool:
    """Return whether two errors differ by more than the estimated effect of rounding."""
    bound = max(run.get(scene.quantity.bound_name) or 0.0 for run in (earlier, after))
    rounded = max(rounding(run) for run in (earlier, after))
    small, large = sorted((abs(then), abs(now)))
    if abs(now - then) <= max(bound, rounded, SMALLEST * large):
        return False
    lost = scene.quantity.name == "attitude_error" and large > LOST_RAD
    if CHAOTIC in scene.case.tags or lost or large <= rounded * LARGEST_GROWTH:
        return large >= LARGE * small
    return True


def rounding(run: Entry) -> float:
    """Return the rounding error of numbers of the size 1 after all steps of a run, if nothing amplifies it."""
    precisions = run.source.header.precisions
    precision = precisions.get(run.row["engine"]) or precisions.get(run.engine) or "float64"
    return STEP_ROUNDINGS * float(run.get("steps") or 1) * ROUNDOFF[precision]
