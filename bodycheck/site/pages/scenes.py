"""The page of each scene, with its physics, its truth, the results of all engines and the motions; and the list of scenes."""

from collections.abc import Iterator, Sequence

from bodycheck.casefile.finding import SUFFIX as CASE_END
from bodycheck.figures.columns import COLUMNS
from bodycheck.reference.requirements import needs
from bodycheck.reports import player
from bodycheck.reports.html import json_text
from bodycheck.reports.runs.kinds import KINDS
from bodycheck.site import links, scene_cards, scene_motion, scene_runs, scene_tables
from bodycheck.site.catalogue import Catalogue, Entry, Scene
from bodycheck.site.cells import verdict
from bodycheck.site.costs import standings
from bodycheck.site.costs.chart import pictures
from bodycheck.site.render import File, page
from bodycheck.site.scene_motion import Found
from bodycheck.site.scene_runs import Line

#: The quantities of attribution.csv for readers, with their units.
PARTED = {
    "stop_time": ("Time of the stop", "s"),
    "stop_distance": ("Distance of the stop", "m"),
    "stop_yaw": ("Yaw at the stop", "rad"),
}


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the pages of all scenes, their case files and motions, their list, and the player."""
    yield File("assets/player.js", player.library().encode())
    yield File("assets/player.css", player.style().encode())
    yield _list(catalogue)
    for scene in catalogue.scenes.values():
        found = scene_motion.moving(catalogue, scene)
        yield _page(catalogue, scene, found)
        yield File(case_file(scene.name), scene.case.text.encode())
        if found:
            yield File(links.motion(scene.name), f"site.motion={json_text(scene_motion.played(scene, found))};\n".encode())


def case_file(name: str) -> str:
    """Return the address of the case file of a scene."""
    return f"scenes/{links.slug(name)}{CASE_END}"


def _list(catalogue: Catalogue) -> File:
    """Return the page with a card for each scene, by kind."""
    cards = [scene_cards.card(catalogue, scene) for scene in catalogue.scenes.values()]
    kinds = [(kind, [one for one in cards if one.scene.kind is kind]) for kind in KINDS]
    return page(
        links.SCENES, "scenes.html.jinja", catalogue, kinds=[(kind, own) for kind, own in kinds if own], amount=len(cards)
    )


def _page(catalogue: Catalogue, scene: Scene, found: Sequence[Found]) -> File:
    lines, without = scene_runs.newest(catalogue, scene)
    drawn = _newest(catalogue, "ensemble.csv", scene)
    newest_first = list(reversed(catalogue.submissions))
    costs = standings.of_scene(catalogue, scene)
    return page(
        links.scene(scene.name),
        "scene.html.jinja",
        catalogue,
        scene=scene,
        effects=needs(scene.case.scene).names(),
        freedom=needs(scene.case.scene).degrees_of_freedom,
        facts=scene_tables.facts(scene, newest_first),
        grids=scene_tables.grids(scene.case.scene),
        bounds=scene_tables.bounds(scene.runs),
        file=f"{links.slug(scene.name)}{CASE_END}",
        lines=lines,
        costs=costs,
        pictures=pictures(costs) if costs is not None else (),
        drifts=any(run.get("energy_drift") is not None for run in scene.runs),
        without=without,
        older=scene_runs.older(catalogue, scene),
        steps=[Line(run, verdict(run, scene), "") for run in _newest(catalogue, "tradeoff.csv", scene)],
        parts=_newest(catalogue, "attribution.csv", scene),
        ensembles=[one for one in drawn if one.get("figure") in (scene.quantity.name, None)],
        further=[one for one in drawn if one.get("figure") not in (scene.quantity.name, None)],
        parted=PARTED,
        figures=COLUMNS,
        motion=links.motion(scene.name) if found else None,
        moving=[one.run.engine for one in found],
    )


def _newest(catalogue: Catalogue, table: str, scene: Scene) -> list[Entry]:
    """Return the rows of a table about a scene; for each engine, the rows of its newest version in the newest submission."""
    found: dict[str, list[Entry]] = {}
    own = [entry for entry in catalogue.entries(table) if entry.get("case") == scene.name]
    for entry in sorted(own, key=lambda entry: entry.order):
        before = found.get(entry.engine)
        if before is None or (before[0].version, before[0].source) != (entry.version, entry.source):
            found[entry.engine] = []
        found[entry.engine].append(entry)
    return [entry for engine in sorted(found) for entry in sorted(found[engine], key=lambda entry: entry.place)]
