"""Several sets of results in one report: the cases that they have, and what is told of where they are from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bodycheck.casefile.case import Case
from bodycheck.casefile.identity import identity
from bodycheck.judging.judgement import Verdict
from bodycheck.judging.result_set import ResultSet
from bodycheck.reports.finding import Finding


@dataclass(frozen=True, eq=False)
class Shown:
    """A case as a report shows it: what is the same case in several sets, once.

    name: the case's own, with a number behind it where sets have different cases of that name, and so have its verdicts.
    sets: those that have it.
    """

    name: str
    title: str
    case: Case
    sets: tuple[ResultSet, ...]
    verdicts: tuple[Verdict, ...]


@dataclass(frozen=True)
class Comparison:
    """What differs between sets."""

    headline: str
    notices: tuple[str, ...]
    findings: tuple[Finding, ...]


def shown(sets: Sequence[ResultSet]) -> tuple[Shown, ...]:
    """The cases of all sets. What differs in more than its title or expectations is not the same case."""
    found = []
    for name in dict.fromkeys(name for one in sets for name in one.results.cases):
        versions: dict[str, list[ResultSet]] = {}
        for one in sets:
            if name in one.results.cases:
                versions.setdefault(identity(one.results.cases[name]), []).append(one)
        several = len(versions) > 1
        for number, own in enumerate(versions.values(), start=1):
            found.append(_shown(name, f"{name}@{number}" if several else name, own, several))
    return tuple(found)


def _shown(name: str, called: str, sets: Sequence[ResultSet], several: bool) -> Shown:
    case = sets[0].results.cases[name]
    title = f"{case.title} ({', '.join(one.label for one in sets)})" if several else case.title
    verdicts = [
        replace(verdict, run=replace(verdict.run, case=called))
        for one in sets
        for verdict in one.verdicts
        if verdict.run.case == name
    ]
    methods = list(dict.fromkeys(map(method, verdicts)))
    return Shown(called, title, case, tuple(sets), tuple(sorted(verdicts, key=lambda verdict: methods.index(method(verdict)))))


def header(sets: Sequence[ResultSet]) -> Mapping[str, Any]:
    """The header of results; of several sets with all the values in which they differ, started when the last one was."""
    headers = {one.label: one.results.header for one in sets}
    if len(sets) == 1:
        return sets[0].results.header
    merged: dict[str, Any] = {
        "bodycheck": _merged({label: own["bodycheck"] for label, own in headers.items()}),
        "started": max(own["started"] for own in headers.values()),
    }
    for group in ("machine", "packages", "engines", "missing"):
        names = dict.fromkeys(name for own in headers.values() for name in own[group])
        merged[group] = {
            name: _merged({label: own[group][name] for label, own in headers.items() if name in own[group]}) for name in names
        }
    return merged | {"command": [_merged({label: " ".join(own["command"]) for label, own in headers.items()})]}


def _merged(values: Mapping[str, str]) -> str:
    if len(set(values.values())) == 1:
        return next(iter(values.values()))
    return ", ".join(f"{value} ({label})" for label, value in values.items())


def method(verdict: Verdict) -> tuple[str, str, float]:
    """Engine, integrator and time step (s) of a run."""
    run = verdict.run
    return run.engine, run.method.name, run.method.timestep
