"""The changes between two baselines that exceed the effect of rounding, and tolerances for such changes."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any, Literal, get_args

from bodycheck.adapters.method import Method
from bodycheck.casefile.expectation import unit
from bodycheck.casefile.identity import changed_keys
from bodycheck.errors import BadInput
from bodycheck.figures.columns import distance_from_ideal
from bodycheck.figures.revisions import redefined
from bodycheck.judging.baselines.baseline import ALLOWANCE, FIGURES, Baseline, Row
from bodycheck.results.key import RunKey
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.suggestion import did_you_mean

#: The largest number of changed keys of a case in a message, and the longest text of a value in it.
MOST_KEYS, LONGEST_VALUE = 4, 60

#: Below this factor between two figures, their difference is stated as a fraction.
NEARLY_EQUAL_FACTOR = 1.01

#: The reason why two baselines are not compared in any figure.
NOT_COMPARED = "no run of both baselines has a figure that could be compared"

Direction = Literal["worse", "better", "new"]
DIRECTIONS = get_args(Direction)


@dataclass(frozen=True)
class Change:
    """A difference between two baselines in one run.

    Attributes
    ----------
    case, engine, integrator, timestep
        The run; the time step is in s.
    what
        The column of a figure, "status", or "run" for a run that only one file contains.
    base, now
        The old and the new value; None if there is none.
    allowance
        The allowed difference of a figure.
    direction
        Whether the run got worse or better, or is new.
    """

    case: str
    engine: str
    integrator: str
    timestep: float
    what: str
    base: float | str | None
    now: float | str | None
    allowance: float | None
    direction: Direction

    @property
    def key(self) -> RunKey:
        """The key of the run."""
        return RunKey(self.case, self.engine, Method.parse(self.integrator, self.timestep))

    @property
    def factor(self) -> float:
        """The ratio of the larger error to the smaller error; infinite if one is zero or there are no two errors."""
        return self._ratio(0.0)

    @property
    def severity(self) -> tuple[int, float]:
        """The severity for sorting changes: runs are most severe, then statuses, then figures by their factors.

        An error counts at least as its allowance, so that a change from a negligible error to a small error is not the largest.
        """
        kind = ("status", "run").index(self.what) + 1 if self.allowance is None else 0
        return kind, self._ratio(self.allowance or 0.0)

    def _ratio(self, floor: float) -> float:
        if not (isinstance(self.base, float) and isinstance(self.now, float)):
            return math.inf
        least, most = sorted(max(distance_from_ideal(self.what, value), floor) for value in (self.base, self.now))
        return most / least if least > 0 else math.inf

    @property
    def figures(self) -> tuple[str, str, str]:
        """Base, now and allowance as text, with enough digits to show a difference; empty for missing values."""
        for digits in (3, 6, 9, 12, 17):
            base, now = _figure_text(self.base, digits), _figure_text(self.now, digits)
            if base != now:
                break
        return base, now, _figure_text(self.allowance, 3)

    @property
    def amount(self) -> str:
        """The direction of the change, and its factor, or its fraction if the two values are nearly equal."""
        if not math.isfinite(self.factor):
            return self.direction
        if self.factor < NEARLY_EQUAL_FACTOR:
            return f"{self.direction} by {self.factor - 1:.1g} of it"
        return f"{self.factor:.3g} times {self.direction}"

    @property
    def text(self) -> str:
        """The change in one sentence."""
        where = f"{self.engine} {self.integrator} on {self.case}, {self.timestep:g} s"
        if self.what == "run":
            return f"{where}, {'is not run any more' if self.now is None else 'is new'}"
        base, now, _ = self.figures
        return f"{where}: {self.what} {base} → {now}{unit(self.what)}, {self.amount}"


@dataclass(frozen=True)
class Difference:
    """The differences between two baselines, the worst first.

    Attributes
    ----------
    changes
        The changes of runs.
    versions
        The programs whose version changed, with the old and the new version.
    redefined
        The names of the figures in both baselines that are not compared, because their definition changed in between.
    runs
        The number of runs in both baselines.
    compared
        The names of the figures that were compared in any run.
    """

    changes: tuple[Change, ...]
    versions: tuple[tuple[str, str, str], ...]
    redefined: tuple[str, ...]
    runs: int
    compared: tuple[str, ...]

    @property
    def worse(self) -> tuple[Change, ...]:
        """The changes for the worse."""
        return tuple(change for change in self.changes if change.direction == "worse")

    @property
    def text(self) -> str:
        """One sentence: the number of changes with the worst change, or that there are none."""
        versions = "".join(f"; {name} {base} → {now}" for name, base, now in self.versions)
        if not self.changes and not self.compared:
            return f"nothing was compared: {NOT_COMPARED}{versions}"
        if not self.changes:
            runs = "1 run" if self.runs == 1 else f"{self.runs} runs"
            return f"no change in {runs} beyond rounding and the truth's own error{versions}"
        counts = {
            direction: len({change.key for change in self.changes if change.direction == direction}) for direction in DIRECTIONS
        }
        tally = ", ".join(f"{count} {direction}" for direction, count in counts.items() if count)
        return f"runs: {tally}; {self.changes[0].text}{versions}"


@dataclass(frozen=True)
class Tolerance:
    """The tolerated growth of a figure. figure: its column; fraction: the growth of its error relative to the old error."""

    figure: str
    fraction: float


def diff(base: Baseline, now: Baseline) -> Difference:
    """Return the changes that exceed the effect of rounding and the errors of the truths.

    Figures whose definition changed between the two baselines are not compared.

    Raises `BadInput` if the physics of a case has changed, because its runs cannot be compared then.
    """
    if others := sorted(name for name, case in base.cases.items() if now.cases.get(name, case) != case):
        edited = (_edited(name, base.keys.get(name, {}), now.keys.get(name, {})) for name in others)
        raise BadInput(f"the case itself has changed, save a new baseline: {'; '.join(edited)}")
    apart = redefined(base.revisions, now.revisions)
    changed = [
        change
        for key in {**base.rows, **now.rows}
        for change in changes(key, base.rows.get(key), now.rows.get(key))
        if change.what not in apart
    ]
    shared = [(base.rows[key], now.rows[key]) for key in base.rows.keys() & now.rows.keys()]
    lost = tuple(name for name in apart if any(_entries_of_both(*rows, name) for rows in shared))
    compared = tuple(name for name in FIGURES if name not in lost and any(_entries_of_both(*rows, name) for rows in shared))
    changed.sort(key=lambda change: change.severity, reverse=True)
    changed.sort(key=lambda change: DIRECTIONS.index(change.direction))
    return Difference(tuple(changed), tuple(_versions(base, now)), lost, len(shared), compared)


def comparisons(difference: Difference) -> list[dict[str, str]]:
    """Return a row for each figure that was compared, with the status "ok"; if there is none, one row with the reason."""
    rows = [{"status": Completed.status, "figure": name} for name in difference.compared]
    return rows or [{"status": "not compared", "reason": NOT_COMPARED}]


def as_json(difference: Difference) -> dict[str, Any]:
    """Return the JSON object of `bodycheck diff --json`."""
    changes = [{**asdict(change), "text": change.text} for change in difference.changes]
    versions = {name: {"base": base, "now": now} for name, base, now in difference.versions}
    return {
        "worse": len(difference.worse),
        "changes": changes,
        "versions": versions,
        "redefined": list(difference.redefined),
        "runs": difference.runs,
        "compared": list(difference.compared),
        "text": difference.text,
    }


def changes(key: RunKey, base: Row | None, now: Row | None) -> Iterator[Change]:
    """Yield the changes of one run: its existence, its status, or figures that differ by more than both allowances.

    Parameters
    ----------
    key
        The key of the run.
    base, now
        The old and the new row; None if the run does not exist there.
    """
    change = partial(Change, key.case, key.engine, key.method.name, key.method.timestep)
    if base is None or now is None:
        there = [None if row is None else str(row["status"]) for row in (base, now)]
        direction: Direction = "new" if base is None else "worse"
        yield change(what="run", base=there[0], now=there[1], allowance=None, direction=direction)
        return
    if (was := base["status"]) != (is_now := now["status"]):
        direction = "better" if _rank(is_now) < _rank(was) else "worse"
        yield change(what="status", base=was, now=is_now, allowance=None, direction=direction)
        return
    for name in FIGURES:
        figures, allowances = _entries_of_both(base, now, name), _entries_of_both(base, now, name + ALLOWANCE)
        if figures is None or allowances is None or abs(figures[1] - figures[0]) <= sum(allowances):
            continue
        direction = "better" if distance_from_ideal(name, figures[1]) < distance_from_ideal(name, figures[0]) else "worse"
        yield change(what=name, base=figures[0], now=figures[1], allowance=sum(allowances), direction=direction)


def tolerances_of(texts: Sequence[str]) -> tuple[Tolerance, ...]:
    """Return the tolerances in texts such as `attitude_error:10%`. Raises `BadInput` for any other text, or a figure twice."""
    tolerances = tuple(map(_parsed, texts))
    names = [one.figure for one in tolerances]
    if repeated := [name for name in names if names.count(name) > 1]:
        raise BadInput(f"--fail-on {repeated[0]}: is given twice")
    return tolerances


def failing(difference: Difference, tolerances: Sequence[Tolerance]) -> tuple[Change, ...]:
    """Return the changes for the worse that are not tolerated, the worst first.

    Without tolerances, all changes for the worse are returned. With tolerances, a change of a figure is returned if the figure
    is named and its error has grown by more than the fraction. A worse status and a missing run are never tolerated.

    Raises `BadInput` if nothing fails and a named figure could not be compared in any run, because it was not checked then.
    """
    if not tolerances:
        return difference.worse
    allowed = {one.figure: one.fraction for one in tolerances}
    broken = tuple(
        change
        for change in difference.worse
        if change.allowance is None or change.factor - 1 > allowed.get(change.what, float("inf"))
    )
    for name in () if broken else allowed:
        if name in difference.redefined:
            raise BadInput(f"--fail-on {name}: its definition has changed since the older baseline; save a new one")
        if name not in difference.compared:
            raise BadInput(
                f"--fail-on {name}: no run of both baselines has it; allowed: {', '.join(difference.compared) or 'none'}"
            )
    return broken


def summary(broken: Sequence[Change], tolerances: Sequence[Tolerance]) -> str:
    """Return one line: the number of changes that exceed the tolerances, and the worst change."""
    allowed = ", ".join(f"{one.figure}:{100 * one.fraction:g}%" for one in tolerances)
    if not broken:
        return f"nothing is worse by more than {allowed}"
    changes = "1 change is" if len(broken) == 1 else f"{len(broken)} changes are"
    return f"{changes} not within {allowed}; {broken[0].text}"


def _entries_of_both(base: Row, now: Row, name: str) -> tuple[float, float] | None:
    """Return the values of an entry in two rows; None unless both rows have it."""
    one, other = base.get(name), now.get(name)
    return None if one is None or other is None else (float(one), float(other))


def _edited(name: str, base: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Return the name of a case with the keys that have changed, if they are known."""
    apart = changed_keys(base, now) if base and now else []
    named = [f"{key} {_shortened(one)} → {_shortened(other)}" for key, one, other in apart[:MOST_KEYS]]
    more = [f"{len(apart) - MOST_KEYS} more"] if len(apart) > MOST_KEYS else []
    return f"{name} ({', '.join(named + more)})" if apart else name


def _shortened(value: str | None) -> str:
    """Return a value as text of limited length. None stands for a missing key."""
    return "none" if value is None else value if len(value) <= LONGEST_VALUE else f"{value[:LONGEST_VALUE]}…"


def _rank(status: str) -> int:
    return (Completed.status, Unsupported.status).index(status) if status in (Completed.status, Unsupported.status) else 2


def _figure_text(value: float | str | None, digits: int) -> str:
    return f"{value:.{digits}g}" if isinstance(value, float) else value or ""


def _versions(base: Baseline, now: Baseline) -> Iterator[tuple[str, str, str]]:
    before, after = ({"bodycheck": one.header["bodycheck"], **one.header["engines"]} for one in (base, now))
    for name in before.keys() & after.keys():
        if before[name] != after[name]:
            yield name, before[name], after[name]


def _parsed(text: str) -> Tolerance:
    name, _, percent = text.partition(":")
    if name not in FIGURES:
        raise BadInput(f"--fail-on {text}: no figure {name!r}{did_you_mean(name, FIGURES)}; allowed: {', '.join(FIGURES)}")
    try:
        fraction = float(percent.removesuffix("%")) / 100 if percent.endswith("%") else -1.0
    except ValueError:
        fraction = -1.0
    if not 0 <= fraction < float("inf"):
        raise BadInput(f"--fail-on {text}: allowed: the figure and a percentage of at least 0, for example {name}:10%")
    return Tolerance(name, fraction)
