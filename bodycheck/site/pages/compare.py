"""The page that compares any two results of an engine: dates, versions or machines."""

from collections.abc import Iterator

from bodycheck.judging.schemes import convergence
from bodycheck.site import changes, links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.render import File, page

#: The numbers of the rule, which the script of the page reads.
NUMBERS = {
    "smallest": changes.SMALLEST,
    "large": changes.LARGE,
    "lost": convergence.LOST_RAD,
    "growth": convergence.LARGEST_GROWTH,
    "chaotic": changes.CHAOTIC,
}


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the page."""
    yield page(links.COMPARE, "compare.html.jinja", catalogue=catalogue, rule=changes.RULE, numbers=NUMBERS)
