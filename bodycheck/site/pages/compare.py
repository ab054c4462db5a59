"""The page that holds any two results of an engine against each other: dates, versions or machines."""

from collections.abc import Iterator

from bodycheck.site import changes, links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.render import File, page


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the page."""
    yield page(links.COMPARE, "compare.html.jinja", catalogue=catalogue, smallest=changes.SMALLEST)
