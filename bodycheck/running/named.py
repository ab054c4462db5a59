"""The engines, methods and releases that a user names, and the decision whether all of them were measured.

Everything that is named is measured, or the command fails. What is known before anything runs is refused by `check` and
`check_planned`. What the rows of results show is decided by `decide`, for all commands, the Python interface and the pytest
plug-in alike.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import product
from types import MappingProxyType
from typing import Any

from bodycheck.adapters import offers
from bodycheck.adapters.contract import Engine
from bodycheck.adapters.method import Method
from bodycheck.adapters.roles import ALIASES, LACKING, alias, aliases, is_of, spelled
from bodycheck.errors import FAILED, OK, BadInput
from bodycheck.results.outcome import Completed, Unsupported
from bodycheck.running.roles import BOTH
from bodycheck.suggestion import did_you_mean

#: The statuses of rows that are measurements, unless a table has others.
MEASURED = frozenset({Completed.status})


@dataclass(frozen=True)
class Named:
    """The names that the user gave, by the column of tables that contains them. An empty tuple stands for the default.

    Attributes
    ----------
    engine
        Names of engines, each `NAME` or `NAME@VERSION`.
    integrator
        Spellings of methods, and aliases.
    version
        Releases of an engine.
    batch
        Numbers of scenes that an engine steps at once.
    """

    engine: tuple[str, ...] = ()
    integrator: tuple[str, ...] = ()
    version: tuple[str, ...] = ()
    batch: tuple[int, ...] = ()


@dataclass(frozen=True)
class Decision:
    """The decision on a command after its work.

    Attributes
    ----------
    failed
        Whether something that was measured failed.
    lost
        A sentence for each name without a measurement, or one sentence if nothing at all was measured.
    unsupported
        A sentence with the number of unsupported rows; empty if there are none.
    """

    failed: bool = False
    lost: tuple[str, ...] = ()
    unsupported: str = ""

    @property
    def code(self) -> int:
        """The exit code of the command."""
        return FAILED if self.failed or self.lost else OK


def check(named: Named, records: Mapping[str, Engine]) -> None:
    """Raise `BadInput` for a named engine that has none of the named methods, or no method of a named alias.

    Methods that no engine has are left to `bodycheck.running.plan.check`. records: the records of the usable engines by their
    requested names.
    """
    for name, role in product(named.engine, aliases(named.integrator)):
        if name in records and not records[name].roles.get(role):
            raise BadInput(f"--integrator {role}: {name} {LACKING[role]}")
    if aliases(named.integrator):
        return
    methods = [Method.parse(spelling, 0.0) for spelling in named.integrator]
    with_method = [name for name, record in records.items() if any(offers.knows(record, method.name) for method in methods)]
    for name in named.engine if with_method else ():
        record = records.get(name)
        if record is None or name in with_method:
            continue
        for method in methods:
            if offers.integrator_of(record, method) is not None:
                offers.check(record, method)  # raises `BadInput` with the fault of the options
        spellings = offers.listed(record)
        near = (did_you_mean(method.integrator, [*spellings, *ALIASES]) for method in methods)
        wanted = " or ".join(method.name for method in methods)
        raise BadInput(f"{name}: no integrator {wanted}; it has {', '.join(spellings)}{next(filter(None, near), '')}")


def check_planned(named: Named, records: Mapping[str, Engine], planned: Iterable[tuple[str, Method]]) -> None:
    """Raise `BadInput` for a named engine or method without any planned run, because no case has a scene for it.

    Parameters
    ----------
    named
        The names.
    records
        The records of the usable engines by their requested names. `decide` reports the named engines that fail.
    planned
        The names of the engines and the methods of all planned runs. A method may have more options than the named one.
    """
    pairs = list(planned)
    engines, methods = {engine for engine, _ in pairs}, {method.over_accuracies for _, method in pairs}
    for role in aliases(named.integrator):
        if not any(is_of(records[engine], method.name, role) for engine, method in pairs):
            raise BadInput(f"--integrator {role}: nothing to run: no engine has such a method for the scenes of these cases")
    asked = f" with {', '.join(named.integrator)}" if named.integrator else ""
    for name in named.engine:
        if name in records and name not in engines:
            raise BadInput(f"{name}: nothing to run{asked}: it has no such method for the scenes of these cases")
    for spelling in spelled(named.integrator):
        wanted = Method.parse(spelling, 0.0).over_accuracies  # a search runs other accuracies than the named one
        if not any(one.integrator == wanted.integrator and {*wanted.options} <= {*one.options} for one in methods):
            raise BadInput(f"{spelling}: nothing to run: no engine has this method for the scenes of these cases")


def of_search(rows: Iterable[Mapping[str, Any]], integrators: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Yield the rows of a search over accuracies for `decide`, under the named spellings of their methods.

    Any accuracy in a named spelling stands for all accuracies.
    """
    names = {method.name: method.over_accuracies for method in (Method.parse(spelling, 0.0) for spelling in integrators)}
    for row in rows:
        family = Method.parse(row["integrator"], 0.0).over_accuracies
        spellings = [name for name, other in names.items() if other == family]
        yield from (dict(row) | {"integrator": name} for name in spellings or [row["integrator"]])


def decide(
    named: Named,
    rows: Iterable[Mapping[str, Any]],
    failed: bool = False,
    missing: Mapping[str, str] | None = None,
    measured: Collection[str] = MEASURED,
    records: Mapping[str, Engine] = MappingProxyType({}),
) -> Decision:
    """Return the decision on a command from the rows of its results.

    A name needs one row that is a measurement: a row with one of the statuses `measured`, or whose expectations hold. Without
    any names, there must be one such row at all. A row without a status is a measurement.

    Parameters
    ----------
    named
        The names.
    rows
        The rows of the main table, with the columns `status`, and `reason` or `detail`, the columns of the names, and perhaps
        `passed`.
    failed
        Whether something that was measured failed.
    missing
        The reasons why engines could not be used, by name.
    measured
        The statuses of rows that are measurements.
    records
        The records of the engines by name, which say what the methods of aliases are.
    """
    table = list(rows)
    there = [row for row in table if row.get("status", Completed.status) in measured or row.get("passed") is True]
    lost = []
    for column, names in asdict(named).items():
        for name in dict.fromkeys(names):
            if not any(_concerns(row, column, name, records) for row in there):
                why = _why([row for row in table if _concerns(row, column, name, records)], (missing or {}).get(name, ""))
                lost.append(f"there is no result of the {column} {name}, which is named: {why}")
    if not there and not lost:
        lost.append(f"there is no result: {_why(table, '')}")
    return Decision(failed, tuple(lost), _unsupported(table))


def _concerns(row: Mapping[str, Any], column: str, name: Any, records: Mapping[str, Engine]) -> bool:
    """Return whether a row is about a name that the user gave for a column."""
    if column != "integrator":
        return bool(row.get(column) == name)
    if (role := alias(name)) is not None:
        record = records.get(str(row.get("engine")))
        is_spelled = record is not None and is_of(record, str(row.get(column)), role)
        return is_spelled or role in str(row.get("role") or "").split(BOTH)
    return bool(row.get(column) == Method.parse(name, 0.0).name)


def _why(rows: Sequence[Mapping[str, Any]], reason: str) -> str:
    """Return the most frequent status and reason of rows without a measurement; if there are no rows, the given reason."""
    ends = Counter((str(row.get("status", "")), _reason(row)) for row in rows)
    if not ends:
        return reason or "nothing was run"
    (status, why), amount = ends.most_common(1)[0]
    others = f" ({amount} of {len(rows)} rows; the others for other reasons)" if len(rows) > amount else ""
    return f"{': '.join(filter(None, (status, why)))}{others}"


def _reason(row: Mapping[str, Any]) -> str:
    return str(row.get("reason") or row.get("detail") or "")


def _unsupported(rows: Sequence[Mapping[str, Any]]) -> str:
    reasons = [_reason(row) for row in rows if row.get("status") == Unsupported.status]
    if not reasons:
        return ""
    example = next(filter(None, reasons), "")
    verb = "is" if len(reasons) == 1 else "are"
    return f"{len(reasons)} of {len(rows)} rows {verb} unsupported{f', for example: {example}' if example else ''}"
