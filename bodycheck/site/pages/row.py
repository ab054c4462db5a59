"""The page of a raw row: its columns, where it comes from, the case file, and the command that makes it again."""

from collections.abc import Iterator

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.render import File, page


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the page."""
    yield page(links.ROW, "row.html.jinja", catalogue=catalogue)
