"""The content of all submissions, arranged as pages need it: by engine, release, scene and robot."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

from packaging.version import InvalidVersion, Version

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.casefile.content import Case
from bodycheck.reports.quantities import QUANTITIES, Quantity
from bodycheck.reports.runs.kinds import Kind, kind_of
from bodycheck.site.submissions import cases
from bodycheck.site.submissions.submission import LeftOut, Row, Submission
from bodycheck.studies.releases.rows import ALLOWANCE_SUFFIX

#: The words in a reason from which it follows that the engine itself refused the model or the file.
REFUSES = " refuses the "

#: The tables whose rows are runs, with the columns of results.
RUNS = ("results.csv", "releases.csv")


@dataclass(frozen=True, eq=False)
class Entry:
    """A row of a table of a submission.

    Parameters
    ----------
    source
        The submission.
    table
        The file name of the table.
    place
        The index of the row in the table, from 0.
    """

    source: Submission
    table: str
    place: int

    @property
    def row(self) -> Row:
        """Return the values by column."""
        return self.source.tables[self.table][self.place]

    def get(self, column: str) -> Any:
        """Return the value of a column; None if the row has none."""
        return self.row.get(column)

    @property
    def engine(self) -> str:
        """Return the name of the engine without a version."""
        return adapter_of(self.row["engine"])

    @property
    def version(self) -> str:
        """Return the version of the engine."""
        return str(self.row["version"])

    @property
    def method(self) -> tuple[str, float | None]:
        """Return the integrator with its options, and the time step (s)."""
        return self.row["integrator"], self.row["timestep"]

    @property
    def order(self) -> tuple[Version, str, str]:
        """Return the key that sorts entries by version, and entries of one version by the start of their command."""
        return version_key(self.version), self.source.header.started, self.source.key


@dataclass(frozen=True, eq=False)
class Results:
    """The runs of one version of an engine in one table of a submission, in the order of the table."""

    source: Submission
    engine: str
    version: str
    table: str
    runs: Sequence[Entry]


@dataclass(frozen=True, eq=False)
class Scene:
    """A case of a submission, with its runs.

    Parameters
    ----------
    name
        The name of the case, which ends with a part of the digest of its text if files share a name; see `submissions.cases`.
    case
        The content of the case file.
    shipped
        Whether the case comes with bodycheck.
    runs
        The rows about the case in all tables results.csv, the oldest versions first.
    """

    name: str
    case: Case
    shipped: bool
    runs: tuple[Entry, ...]

    @cached_property
    def kind(self) -> Kind:
        """Return the kind of the scene, which determines the quantity that shows discrepancies best."""
        return kind_of(self.case.scene)

    @property
    def quantity(self) -> Quantity:
        """Return the quantity that shows discrepancies best."""
        return QUANTITIES[self.kind.quantity]


@dataclass(frozen=True, eq=False)
class Catalogue:
    """All submissions of a site.

    Parameters
    ----------
    submissions
        The submissions, the oldest first.
    left_out
        The paths that the site does not show, with the reasons.
    scenes
        The cases by name.
    """

    submissions: tuple[Submission, ...]
    left_out: tuple[LeftOut, ...]
    scenes: Mapping[str, Scene]

    def entries(self, table: str) -> Iterator[Entry]:
        """Yield the rows of a table in all submissions, the oldest first."""
        for source in self.submissions:
            yield from entries_of(source, table)

    @cached_property
    def engines(self) -> tuple[str, ...]:
        """Return the names, without versions, of all engines in headers and tables, in alphabetical order."""
        told = {adapter_of(name) for source in self.submissions for name in source.header.engines}
        rows = {
            adapter_of(row["engine"])
            for source in self.submissions
            for table in source.tables.values()
            for row in table
            if row.get("engine")
        }
        return tuple(sorted((told | rows) - {"file"}))

    @cached_property
    def versions(self) -> Mapping[str, tuple[str, ...]]:
        """Return the versions of each engine with runs, the oldest first."""
        found: dict[str, set[str]] = {name: set() for name in self.engines}
        for table in RUNS:
            for entry in self.entries(table):
                found[entry.engine].add(entry.version)
        return {name: tuple(sorted(versions, key=version_key)) for name, versions in found.items()}

    @cached_property
    def runs(self) -> Mapping[tuple[str, str], tuple[Entry, ...]]:
        """Return the runs of each engine and scene, by the names of both, the oldest versions first."""
        found: dict[tuple[str, str], list[Entry]] = defaultdict(list)
        for name, scene in self.scenes.items():
            for entry in scene.runs:
                found[entry.engine, name].append(entry)
        return {key: tuple(entries) for key, entries in found.items()}

    @cached_property
    def allowances(self) -> Mapping[tuple[str, str, str, str, float | None], Row]:
        """Return the effect of rounding on each figure, by engine, version, case and method, from rows of releases.csv.

        If several submissions have measured the same effect, the smallest counts, so that no submission hides a change.
        """
        smallest: dict[tuple[str, str, str, str, float | None], dict[str, Any]] = defaultdict(dict)
        for entry in self.entries("releases.csv"):
            allowances = smallest[entry.engine, entry.version, entry.row["case"], *entry.method]
            for column, value in entry.row.items():
                if column.endswith(ALLOWANCE_SUFFIX) and value is not None:
                    allowances[column] = min(value, allowances.get(column, value))
        return smallest

    @cached_property
    def without_method(self) -> Mapping[tuple[str, str], str]:
        """Return why an engine has no run of a scene, by engine and case.

        If submissions give different reasons, all are there, each with the newest submission that gives it.
        """
        reasons: dict[tuple[str, str], dict[str, Submission]] = defaultdict(dict)
        for source in self.submissions:
            for engine, by_case in source.header.without_method.items():
                for case, why in by_case.items():
                    reasons[adapter_of(engine), case][why] = source
        return {
            key: "; ".join(f"{why} ({source.named})" if len(given) > 1 else why for why, source in given.items())
            for key, given in reasons.items()
        }

    @cached_property
    def robots(self) -> Mapping[str, tuple[Entry, ...]]:
        """Return the rows of parity.csv by robot model, for each version of an engine.

        Of submissions that say the same of it, the newest counts. Submissions that say different things are all there.
        """
        readings: dict[tuple[str, str, str], dict[Submission, list[Entry]]] = defaultdict(lambda: defaultdict(list))
        for entry in self.entries("parity.csv"):
            readings[entry.row["model"], entry.engine, entry.version][entry.source].append(entry)
        found: dict[str, list[Entry]] = defaultdict(list)
        for (model, _, _), by_source in sorted(readings.items(), key=lambda item: item[0]):
            for rows in {_statement(rows): rows for rows in by_source.values()}.values():
                found[model] += rows
        return {model: tuple(entries) for model, entries in found.items()}


def _statement(rows: Iterable[Entry]) -> frozenset[tuple[str | None, ...]]:
    """Return what rows of parity.csv say: the quantities that agree, and all else with its part, its status and its cause."""
    columns = ("quantity", "status", "cause", "subject")
    return frozenset(
        tuple(entry.get(column) for column in (columns[:2] if entry.get("status") == "agrees" else columns)) for entry in rows
    )


@lru_cache(maxsize=4096)
def version_key(version: str) -> Version:
    """Return the key that sorts versions; a version that does not follow PEP 440 is the oldest."""
    try:
        return Version(version)
    except InvalidVersion:
        return Version("0.dev0")


def entries_of(source: Submission, table: str) -> Iterator[Entry]:
    """Yield the rows of a table of a submission."""
    for index in range(len(source.tables.get(table, ()))):
        yield Entry(source, table, index)


def results_of(source: Submission) -> list[Results]:
    """Return the results of all engines and versions in a submission, in the order of their first rows."""
    runs: dict[tuple[str, str, str], list[Entry]] = defaultdict(list)
    for table in RUNS:
        for run in entries_of(source, table):
            runs[run.engine, run.version, table].append(run)
    return [Results(source, *key, entries) for key, entries in runs.items()]


def catalogued(submissions: Sequence[Submission], left_out: Iterable[LeftOut]) -> Catalogue:
    """Return the catalogue of submissions. submissions: the oldest first. left_out: the paths that the site does not show."""
    found: dict[str, Case] = {}
    runs: dict[str, list[Entry]] = defaultdict(list)
    kept = cases.apart(submissions)
    for source in kept:
        for name, text in source.cases.items():
            if name not in found:
                found[name] = cases.shipped(name) or cases.read(name.partition(".")[0], text)
        for entry in entries_of(source, "results.csv"):
            runs[entry.row["case"]].append(entry)
    scenes = {
        name: Scene(name, case, cases.shipped(name) is not None, tuple(sorted(runs[name], key=lambda entry: entry.order)))
        for name, case in sorted(found.items())
    }
    return Catalogue(kept, tuple(left_out), scenes)
