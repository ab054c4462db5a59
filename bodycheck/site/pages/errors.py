"""The page of what the site leaves out, and why. It is the only page on which what is left out appears."""

from collections.abc import Iterator

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.render import File, page


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the page."""
    yield page(links.ERRORS, "errors.html.jinja", left_out=sorted(catalogue.left_out, key=lambda one: (one.name, one.reason)))
