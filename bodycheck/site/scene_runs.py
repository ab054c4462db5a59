"""The runs of a scene as its page lists them: runs with numbers, and runs without numbers grouped by reason."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from bodycheck.results.outcome import Unsupported
from bodycheck.results.verdicts import Verdict
from bodycheck.running.roles import BOTH
from bodycheck.site import changes
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.cells import default_run, verdict
from bodycheck.site.submissions import own_methods


@dataclass(frozen=True, eq=False)
class Line:
    """A run that has a number, or that failed.

    Parameters
    ----------
    run
        The row of the run.
    verdict
        The verdict on the run.
    own
        The roles of its method. If these are not known, or the engine has no default method, why the method represents the
        engine: it is the "own choice" of the engine, or "listed first" by the adapter. Empty for all other methods.
    source
        The submission in words, if others say something else of the same method in the same version; otherwise empty.
    """

    run: Entry
    verdict: Verdict
    own: str
    source: str = ""


@dataclass(frozen=True)
class Without:
    """The methods of an engine that have no run of a scene for the same reason.

    Parameters
    ----------
    engine, version
        The engine and its version; the version is empty if it is not known.
    verdict
        The verdict on the methods: "unsupported", "refused" or "not run".
    methods
        The names of the methods; empty for all methods.
    reason
        The reason; empty if it is not known.
    run
        The first row that gives the reason; None if no row does.
    """

    engine: str
    version: str
    verdict: Verdict
    methods: tuple[str, ...]
    reason: str
    run: Entry | None = None


def newest(catalogue: Catalogue, scene: Scene) -> tuple[list[Line], list[Without]]:
    """Return the runs of the newest version of each engine, and the methods or engines without a run."""
    lines: list[Line] = []
    without: list[Without] = []
    for engine in catalogue.engines:
        groups = _versions(catalogue.runs.get((engine, scene.name), ()))
        if not groups:
            why = catalogue.without_method.get((engine, scene.name), "")
            without.append(Without(engine, "", "unsupported" if why else "not run", (), why))
            continue
        lines += _side_by_side(catalogue, scene, list(_lines(groups[-1], scene)))
        without += _without(groups[-1], scene)
    return lines, without


def older(catalogue: Catalogue, scene: Scene) -> list[Line]:
    """Return the runs of all older versions of engines, the newest first."""
    return [
        line
        for engine in catalogue.engines
        for group in reversed(_versions(catalogue.runs.get((engine, scene.name), ()))[:-1])
        for line in _lines(group, scene)
    ]


def _versions(runs: Sequence[Entry]) -> list[list[Entry]]:
    """Return the runs of each version, the oldest version first: each from the newest submission with runs of the version."""
    found: dict[str, list[Entry]] = {}
    for run in runs:
        if run.version not in found or found[run.version][0].source is not run.source:
            found[run.version] = []
        found[run.version].append(run)
    return [sorted(group, key=lambda run: run.place) for group in found.values()]


def _lines(group: list[Entry], scene: Scene) -> Iterator[Line]:
    own = default_run(group)
    for run in group:
        if run.get("status") != Unsupported.status:
            yield Line(run, verdict(run, scene), BOTH.join(own_methods.roles_of(run.row)) or (_why(run) if run is own else ""))


def _side_by_side(catalogue: Catalogue, scene: Scene, lines: Sequence[Line]) -> Iterator[Line]:
    """Yield lines, each followed by the lines of other submissions that say something else."""
    for line in lines:
        others = changes.contradictions(catalogue, scene, line.run)
        yield replace(line, source=line.run.source.named) if others else line
        for run in others:
            yield Line(run, verdict(run, scene), line.own, run.source.named)


def _why(run: Entry) -> str:
    """Return why the method of a run represents its engine; see `Line.own`."""
    chosen = own_methods.chosen(run.get("engine"), run.source.header.defaults)
    return "own choice" if run.get("integrator") in chosen else "listed first"


def _without(group: list[Entry], scene: Scene) -> Iterator[Without]:
    reasons: dict[str, list[Entry]] = {}
    for run in group:
        if run.get("status") == Unsupported.status:
            reasons.setdefault(str(run.get("reason") or ""), []).append(run)
    for reason, runs in reasons.items():
        methods = () if len(runs) == len(group) else tuple(dict.fromkeys(str(run.get("integrator")) for run in runs))
        yield Without(runs[0].engine, runs[0].version, verdict(runs[0], scene), methods, reason, runs[0])
