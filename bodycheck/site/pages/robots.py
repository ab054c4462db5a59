"""The page of each robot, with the readings of its model by engines, and the table of all robots and engines."""

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePosixPath

from bodycheck.site import links, robot_tables
from bodycheck.site.catalogue import Catalogue, Entry
from bodycheck.site.render import File, page
from bodycheck.site.robot_tables import MOST_LISTED, Reading
from bodycheck.studies.parity.quantities import FILE
from bodycheck.studies.parity.wording import SAYS, name_of


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the pages of all robots, and the page with the table of all robots."""
    read = {model: robot_tables.readings(entries) for model, entries in catalogue.robots.items()}
    yield _list(catalogue, {model: (newest, len(faults)) for model, (newest, _, faults) in read.items()})
    for model, (newest, older, faults) in read.items():
        yield page(
            links.robot(model),
            "robot.html.jinja",
            catalogue,
            model=model,
            newest=newest,
            older=older,
            faults=faults,
            quantities=robot_tables.quantities(newest),
            before=robot_tables.quantities(older),
            most=MOST_LISTED,
            says=SAYS,
            name_of=name_of,
            shown=robot_tables.shown,
            commands=_commands(model, catalogue.robots[model]),
        )


def _list(catalogue: Catalogue, read: Mapping[str, tuple[Sequence[Reading], int]]) -> File:
    """Return the page with all robots. read: the newest readings of each robot, and the number of faults in its file."""
    engines = sorted({one.engine for own, _ in read.values() for one in own})
    rows = []
    for model, (own, faults) in sorted(read.items()):
        by_engine: dict[str, list[Reading]] = {}
        for one in own:
            by_engine.setdefault(one.engine, []).append(one)
        rows.append((model, by_engine, faults))
    return page(links.ROBOTS, "robots.html.jinja", catalogue, engines=engines, rows=rows)


def _commands(model: str, entries: Sequence[Entry]) -> list[str]:
    """Return the commands that compare a model, with its file name if the command of a submission contains it."""
    sources = dict.fromkeys(entry.source for entry in entries if entry.get("engine") != FILE)
    files = [word for source in sources for word in source.header.command if PurePosixPath(word).stem == model]
    name = next(iter(files), model)
    return [shlex.join(["bodycheck", "parity", name])]
