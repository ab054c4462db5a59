"""Several sets of results in one report: their cases, and a merged header."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from bodycheck.casefile.content import Case
from bodycheck.casefile.identity import identity
from bodycheck.casefile.robots.loading import is_robot, options
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.finding import Finding
from bodycheck.results.header import Header
from bodycheck.results.key import RunKey


@dataclass(frozen=True, eq=False)
class Shown:
    """A case as a report shows it: once if it is the same in several sets.

    Parameters
    ----------
    name
        The name of the case, followed by a number if the sets have different cases of this name.
    title, case
        The title for readers, and the case itself.
    sets
        The sets that contain the case.
    verdicts
        The verdicts on the runs of the case in these sets. Their runs have the name `name`.
    """

    name: str
    title: str
    case: Case
    sets: tuple[ResultSet, ...]
    verdicts: tuple[Verdict, ...]

    def file(self, label: str) -> str:
        """Return the path of the case file as it was given for the set with this label, or the name of a shipped case."""
        name = self.case.name
        return next((one.results.files[name] for one in self.sets if one.label == label and name in one.results.files), name)

    def argument(self, label: str) -> list[str]:
        """Return the file as `file` does, with the options by which a robot's file is read."""
        name, file = self.case.name, self.file(label)
        packages = next((one.results.packages.get(name, ()) for one in self.sets if one.label == label), ())
        ignored = self.case.robot.without if self.case.robot is not None and is_robot(file) else ()
        return [file, *options(packages, ignored)]


@dataclass(frozen=True)
class Comparison:
    """The differences between sets: a headline, notices, findings, and the case and both methods of the largest change."""

    headline: str
    notices: tuple[str, ...]
    findings: tuple[Finding, ...]
    foremost: tuple[tuple[str, RunKey], ...]


def shown(sets: Sequence[ResultSet]) -> tuple[Shown, ...]:
    """Return the cases of all sets as the report shows them.

    Cases of the same name that differ in more than their title or expectations are shown as different cases.
    """
    found = []
    for name in dict.fromkeys(name for one in sets for name in one.results.cases):
        versions: dict[str, list[ResultSet]] = {}
        for one in sets:
            if name in one.results.cases:
                kept = identity(one.results.cases[name]) if len(sets) > 1 else ""
                versions.setdefault(kept, []).append(one)
        several = len(versions) > 1
        for number, own in enumerate(versions.values(), start=1):
            found.append(_shown(name, f"{name}@{number}" if several else name, own, several))
    return tuple(found)


def _shown(name: str, shown_name: str, sets: Sequence[ResultSet], several: bool) -> Shown:
    case = sets[0].results.cases[name]
    title = f"{case.title} ({', '.join(one.label for one in sets)})" if several else case.title
    verdicts = [
        replace(verdict, run=replace(verdict.run, case=shown_name))
        for one in sets
        for verdict in one.verdicts_by_case.get(name, ())
    ]
    places = {key: place for place, key in enumerate(dict.fromkeys(verdict.run.key for verdict in verdicts))}
    ordered = sorted(verdicts, key=lambda verdict: places[verdict.run.key])
    return Shown(shown_name, title, case, tuple(sets), tuple(ordered))


def header(sets: Sequence[ResultSet]) -> Header:
    """Return the header of the results. For several sets, it has every differing value with its label, and the latest start."""
    headers = {one.label: one.results.header for one in sets}
    if len(sets) == 1:
        return sets[0].results.header
    return {
        "bodycheck": _merged({label: own["bodycheck"] for label, own in headers.items()}),
        "command": [_merged({label: " ".join(own["command"]) for label, own in headers.items()})],
        "started": max(own["started"] for own in headers.values()),
        "machine": _merged_group({label: own["machine"] for label, own in headers.items()}),
        "packages": _merged_group({label: own["packages"] for label, own in headers.items()}),
        "engines": _merged_group({label: own["engines"] for label, own in headers.items()}),
        "missing": _merged_group({label: own["missing"] for label, own in headers.items()}),
        "environments": _merged_by_engine([own["environments"] for own in headers.values()]),
        "demonstrations": _merged_by_engine([own["demonstrations"] for own in headers.values()]),
        "precisions": _merged_group({label: own["precisions"] for label, own in headers.items()}),
        "defaults": _merged_by_engine([own["defaults"] for own in headers.values()]),
        "soft": _merged_by_engine([header["soft"] for header in headers.values()]),
        "without_method": _merged_by_engine([own["without_method"] for own in headers.values()]),
        "robots": {name: sentences for one in headers.values() for name, sentences in one["robots"].items()},
        "departures": {name: instant for one in headers.values() for name, instant in one["departures"].items()},
    }


def _merged_by_engine(groups: Sequence[Mapping[str, Mapping[str, str]]]) -> dict[str, dict[str, str]]:
    """Return the entries of all sets for each engine. If sets differ in an entry, the value of the last set is returned."""
    engines = dict.fromkeys(engine for own in groups for engine in own)
    return {engine: {k: v for own in groups for k, v in own.get(engine, {}).items()} for engine in engines}


def _merged_group(groups: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """Return one group of entries of the headers, merged name by name. groups: the entries by the label of the set."""
    names = dict.fromkeys(name for own in groups.values() for name in own)
    return {name: _merged({label: own[name] for label, own in groups.items() if name in own}) for name in names}


def _merged(values: Mapping[str, str]) -> str:
    if len(set(values.values())) == 1:
        return next(iter(values.values()))
    return ", ".join(f"{value} ({label})" for label, value in values.items())
