"""The page of each release of an engine: its changes from the previous release, and its runs."""

from collections.abc import Iterator

from bodycheck.site import changes, links, telling
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.releases import Release, measured_changes, releases, upgrades
from bodycheck.site.render import File, page


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the pages of all releases of all engines."""
    for engine in catalogue.engines:
        known = releases(catalogue, engine)
        found = upgrades(known)
        for place, release in enumerate(known):
            upgrade = found.get(release.version)
            measured = measured_changes(catalogue, engine, release.version)
            yield page(
                links.release(engine, release.version),
                "release.html.jinja",
                catalogue,
                release=release,
                upgrade=upgrade,
                before=known[place - 1] if place else None,
                after=known[place + 1] if place + 1 < len(known) else None,
                orders=list(telling.orders(catalogue, measured)),
                told=list(telling.of_upgrade(upgrade)) if upgrade is not None else [],
                measured=measured,
                failed_study=_unmeasured(catalogue, release),
                rule=changes.RULE,
            )


def _unmeasured(catalogue: Catalogue, release: Release) -> tuple[str, ...]:
    """Return the reasons why studies of releases could not measure a release, each reason once."""
    found = {
        str(entry.get("reason") or entry.row["status"]): None
        for entry in catalogue.entries("releases.csv")
        if (entry.engine, entry.version, entry.row["status"]) == (release.engine, release.version, "unobtainable")
    }
    return tuple(found)
