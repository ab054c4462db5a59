"""The page of each engine, with all its results."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from bodycheck.reports.quantities import milliseconds
from bodycheck.reports.runs.kinds import KINDS, Kind
from bodycheck.results.verdicts import Verdict
from bodycheck.site import changes, engine_facts, links, trend
from bodycheck.site.advice import advice
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.cells import Cell, cell
from bodycheck.site.costs.standings import shown
from bodycheck.site.releases import Release, Upgrade, releases, upgrades
from bodycheck.site.render import File, page
from bodycheck.studies.audit.rows import PROPERTIES
from bodycheck.studies.parity.quantities import Status
from bodycheck.studies.parity.wording import NO_ANSWER

#: The statuses of rows about robots, and the heads of their columns. Those of `NO_ANSWER` have a column only if a row has them.
STATUSES: tuple[tuple[Status, str], ...] = (
    ("agrees", "Agree"),
    ("differs", "Differ"),
    ("refused", "Refused"),
    ("crashed", "Crashed"),
    ("timeout", "Too slow"),
    ("adapter-fault", "Adapter at fault"),
    ("accepted-unphysical", "Accepted although unphysical"),
    ("not-modelled", "Not modelled"),
)

#: Verdicts whose scenes are listed by name.
LISTED: tuple[Verdict, ...] = ("broken", "failed", "refused", "unsupported", "not run")


@dataclass(frozen=True, eq=False)
class Trend:
    """The errors of the methods of an engine in a scene, by release.

    Parameters
    ----------
    scene
        The scene.
    rows
        The runs of each integrator and time step with runs in several releases, by release; None for a release without a run.
    chart
        A chart of the errors of some rows; empty if no row has a number.
    drawn
        The number of lines in the chart.
    """

    scene: Scene
    rows: Mapping[tuple[str, float | None], tuple[Entry | None, ...]]
    chart: Markup
    drawn: int


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the pages of all engines."""
    costs = shown(catalogue)
    for engine in catalogue.engines:
        known = releases(catalogue, engine)
        found = upgrades(known)
        ran = tuple(one for one in known if one.runs)
        cells = [(scene, cell(catalogue, engine, scene)) for scene in catalogue.scenes.values()]
        audit = engine_facts.newest(catalogue, "audit.csv", engine)
        told, told_by = engine_facts.defaults(catalogue, engine)
        yield page(
            links.engine(engine),
            "engine.html.jinja",
            catalogue,
            engine=engine,
            releases=known,
            upgrades=found,
            newest=ran[-1] if ran else None,
            kinds=_by_kind(cells),
            listed=[(verdict, [(scene, one) for scene, one in cells if one.verdict == verdict]) for verdict in LISTED],
            counts=_counts(cells),
            methods=(methods := engine_facts.methods(ran[-1]) if ran else ()),
            advice=list(advice(catalogue, engine, cells, methods, costs)),
            contact=(sheet := engine_facts.contact_sheet(catalogue, engine)),
            contact_settings=engine_facts.contact_settings(sheet),
            defaults=told,
            defaults_source=told_by,
            audited=audit,
            findings=sorted(engine_facts.findings(audit), key=_by_property),
            audit_counts=Counter(str(entry.get("status")) for entry in audit),
            trends=list(trends(ran, found)),
            ensembles=engine_facts.newest(catalogue, "ensemble.csv", engine),
            robots=(robots := list(engine_facts.robots(catalogue, engine))),
            statuses=[one for one in STATUSES if one[0] not in NO_ANSWER or any(robot.counts.get(one[0]) for robot in robots)],
            issues=list(engine_facts.issues(catalogue, engine)),
            rule=changes.RULE,
        )


def trends(ran: Sequence[Release], found: Mapping[str, Upgrade]) -> Iterator[Trend]:
    """Yield the errors by release in one scene of each kind: the scene with the most severe change of an error, if any.

    ran: the releases of an engine that have runs, the oldest first. found: the upgrades between them.
    """
    worst: dict[str, tuple[float, Scene]] = {}
    for upgrade in found.values():
        for scene, change in upgrade.changes:
            if change.quantity != changes.STATUS and change.severity > worst.get(scene.kind.name, (0.0, scene))[0]:
                worst[scene.kind.name] = change.severity, scene
    for kind in KINDS:
        if kind.name in worst:
            yield _trend(ran, worst[kind.name][1])


def _trend(ran: Sequence[Release], scene: Scene) -> Trend:
    """Return the errors in a scene of the methods that have runs in at least two releases."""
    of_release = [{run.method: run for run in one.runs.get(scene.name, ())} for one in ran]
    methods = Counter(method for runs in of_release for method in runs)
    rows = {method: tuple(runs.get(method) for runs in of_release) for method, times in methods.items() if times > 1}
    several = len({timestep for _, timestep in rows}) > 1
    values = [
        trend.Line(
            f"{name} {milliseconds(timestep)}" if several and timestep else name,
            tuple(run.get(scene.quantity.name) if run is not None else None for run in runs),
        )
        for (name, timestep), runs in rows.items()
    ]
    # If there are too many lines, only the lines whose errors change most are drawn.
    lines = sorted((line for line in values if any(line.values)), key=_spread, reverse=True)[: trend.MOST_LINES]
    title = f"{scene.quantity.title} in {scene.name} by release; the table has the numbers"
    made = trend.chart(title, scene.quantity.label, [one.version for one in ran], lines) if lines else Markup()
    return Trend(scene, rows, made, len(lines))


def _spread(line: trend.Line) -> float:
    there = [value for value in line.values if value]
    return max(there) / min(there)


def _by_kind(cells: Sequence[tuple[Scene, Cell]]) -> Mapping[Kind, list[tuple[Scene, Cell]]]:
    found = {kind: [(scene, one) for scene, one in cells if scene.kind == kind] for kind in KINDS}
    return {kind: own for kind, own in found.items() if own}


def _counts(cells: Sequence[tuple[Scene, Cell]]) -> Mapping[Verdict, int]:
    found = Counter(one.verdict for _, one in cells)
    return {verdict: found[verdict] for verdict in ("exact", "error", *LISTED)}


def _by_property(entry: Entry) -> tuple[int, str]:
    return PROPERTIES.index(entry.row["property"]), str(entry.get("integrator"))
