"""The front page: engines by scenes, and what changed since the last date."""

from collections.abc import Iterator

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.cells import cell
from bodycheck.site.render import File, page


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the front page."""
    rows = [
        (scene, [(engine, cell(catalogue, engine, scene)) for engine in catalogue.engines])
        for scene in catalogue.scenes.values()
    ]
    yield page(links.INDEX, "index.html.jinja", catalogue=catalogue, rows=rows)
