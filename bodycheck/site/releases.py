"""The releases of an engine: their runs, their verdicts, and the differences from the previous release."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from bodycheck.adapters.engine_name import adapter_of
from bodycheck.results.verdicts import SCENES, Verdict
from bodycheck.site import cells, changes
from bodycheck.site.catalogue import Catalogue, Entry, Scene, version_key
from bodycheck.site.changes import Change
from bodycheck.site.submissions.submission import Submission
from bodycheck.studies.releases.findings import OTHER


@dataclass(frozen=True, eq=False)
class Release:
    """A release of an engine.

    Parameters
    ----------
    catalogue
        The catalogue with all submissions.
    engine, version
        The engine and the version of the release.
    """

    catalogue: Catalogue
    engine: str
    version: str

    @cached_property
    def runs(self) -> Mapping[str, tuple[Entry, ...]]:
        """Return the runs by scene, each from the newest submission that has runs of the scene in this release."""
        found = {}
        for name in self.catalogue.scenes:
            own = [run for run in self.catalogue.runs.get((self.engine, name), ()) if run.version == self.version]
            if own:
                found[name] = tuple(run for run in own if run.source is own[-1].source)
        return found

    @cached_property
    def verdicts(self) -> Mapping[str, Verdict]:
        """Return the verdict on the engine's own method, by scene."""
        return {name: self.verdict(scene) for name, scene in self.catalogue.scenes.items()}

    def verdict(self, scene: Scene) -> Verdict:
        """Return the verdict on the engine's own method in a scene."""
        if scene.name in self.runs:
            return cells.verdict(cells.default_run(list(self.runs[scene.name])), scene)
        return "unsupported" if scene.name in self.without_method else "not run"

    @cached_property
    def counts(self) -> Mapping[Verdict, int]:
        """Return the number of scenes with each verdict."""
        found = list(self.verdicts.values())
        return {verdict: found.count(verdict) for verdict in SCENES}

    @property
    def ran(self) -> int:
        """Return the number of scenes in which the engine's own method completed."""
        return self.counts["exact"] + self.counts["error"] + self.counts["broken"]

    @cached_property
    def sources(self) -> tuple[Submission, ...]:
        """Return the submissions with any row about this release, the oldest first."""
        return tuple(
            source
            for source in self.catalogue.submissions
            if any(self._is(row.get("engine"), row.get("version")) for table in source.tables.values() for row in table)
        )

    @cached_property
    def without_method(self) -> Mapping[str, str]:
        """Return the scenes for which the release has no method, with the reason."""
        return {
            case: why
            for source in self.sources
            for engine, cases in source.header.without_method.items()
            if self._is(engine, source.header.engines.get(engine))
            for case, why in cases.items()
        }

    @cached_property
    def environment(self) -> Mapping[str, str]:
        """Return the packages in the environment of this release, from the newest submission that lists them."""
        found: Mapping[str, str] = {}
        for source in self.sources:
            for engine, version in source.header.engines.items():
                if self._is(engine, version):
                    found = source.header.environments.get(engine) or found
        return found

    def _is(self, engine: str | None, version: str | None) -> bool:
        return engine is not None and adapter_of(engine) == self.engine and version == self.version


@dataclass(frozen=True, eq=False)
class VerdictChange:
    """A scene in which the verdict on the engine's own method changed."""

    scene: Scene
    before: Verdict
    after: Verdict


@dataclass(frozen=True, eq=False)
class Upgrade:
    """The differences between a release and the previous release that has runs.

    Parameters
    ----------
    before, after
        The two releases.
    """

    before: Release
    after: Release

    @cached_property
    def pairs(self) -> tuple[tuple[Scene, Entry, Entry], ...]:
        """Return the pairs of runs of the same method in both releases, as scene, earlier run and later run."""
        return tuple(
            (self.after.catalogue.scenes[name], earlier, run)
            for name, runs in self.after.runs.items()
            for run in runs
            for earlier in self.before.runs.get(name, ())
            if earlier.method == run.method
        )

    @cached_property
    def changes(self) -> tuple[tuple[Scene, Change], ...]:
        """Return the changes beyond rounding, each with its scene."""
        found = ((scene, changes.change(self.after.catalogue, scene, run, earlier)) for scene, earlier, run in self.pairs)
        return tuple((scene, change) for scene, change in found if change is not None)

    def errors(self, worse: bool) -> tuple[tuple[Scene, Change], ...]:
        """Return the changes to a larger error (`worse`) or to a smaller error (not `worse`), the most severe changes first."""
        found = [one for one in self.changes if one[1].quantity != changes.STATUS and one[1].worse is worse]
        return tuple(sorted(found, key=lambda one: -one[1].severity))

    @property
    def statuses(self) -> tuple[tuple[Scene, Change], ...]:
        """Return the changes of status, each with its scene."""
        return tuple(one for one in self.changes if one[1].quantity == changes.STATUS)

    @cached_property
    def verdicts(self) -> tuple[VerdictChange, ...]:
        """Return the scenes in which the verdict changed.

        A change between "exact" and "error" counts only if a number in the scene changed beyond rounding.
        """
        numbers = {scene.name for scene, _ in self.changes}
        found = []
        for name, scene in self.after.catalogue.scenes.items():
            then, now = self.before.verdicts[name], self.after.verdicts[name]
            if then != now and ({then, now} != {"exact", "error"} or name in numbers):
                found.append(VerdictChange(scene, then, now))
        return tuple(found)

    @cached_property
    def new_methods(self) -> tuple[str, ...]:
        """Return the integrators with which only the later release has runs."""
        return tuple(sorted(_integrators(self.after) - _integrators(self.before)))

    @cached_property
    def gone_methods(self) -> tuple[str, ...]:
        """Return the integrators with which only the earlier release has runs."""
        return tuple(sorted(_integrators(self.before) - _integrators(self.after)))


def _integrators(release: Release) -> set[str]:
    return {run.row["integrator"] for runs in release.runs.values() for run in runs}


def releases(catalogue: Catalogue, engine: str) -> tuple[Release, ...]:
    """Return the releases of an engine, the oldest first."""
    return tuple(Release(catalogue, engine, version) for version in catalogue.versions[engine])


def upgrades(known: tuple[Release, ...]) -> Mapping[str, Upgrade]:
    """Return the upgrades by the versions of the later releases; the first release with runs has no upgrade.

    known: the releases of an engine, the oldest first.
    """
    ran = [one for one in known if one.runs]
    return {after.version: Upgrade(before, after) for before, after in pairwise(ran)}


def measured_changes(catalogue: Catalogue, engine: str, version: str) -> tuple[Entry, ...]:
    """Return the rows of changes.csv about a release. If rows are about the same change, only the newest is returned."""
    found = {}
    for entry in catalogue.entries("changes.csv"):
        if entry.engine == engine and entry.get("to_version") == version:
            key = (entry.get("from_version"), entry.row["case"], *entry.method, entry.row["quantity"])
            found[key] = entry
    return tuple(found.values())


def order_changed(change: Entry) -> bool:
    """Return whether a row of changes.csv says that the observed order has changed."""
    before, after = change.get("order_before"), change.get("order_after")
    return before is not None and after is not None and abs(before - after) > OTHER


def lasts(catalogue: Catalogue, change: Entry) -> bool:
    """Return whether the order of a row of changes.csv is not known to have changed again in a later release."""
    return not any(
        order_changed(other)
        for other in _same(catalogue, change)
        if version_key(other.row["to_version"]) > version_key(change.row["to_version"])
    )


def _same(catalogue: Catalogue, change: Entry) -> Iterator[Entry]:
    for other in catalogue.entries("changes.csv"):
        if (other.engine, *other.method, other.row["quantity"]) == (change.engine, *change.method, change.row["quantity"]):
            yield other
