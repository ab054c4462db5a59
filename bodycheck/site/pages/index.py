"""The front page, the page of a raw row, and the page of the paths that the site leaves out.

No other page mentions the paths that are left out.
"""

from collections.abc import Iterator, Sequence

from bodycheck.site import links
from bodycheck.site.answers import answers
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.costs.chart import pictures
from bodycheck.site.costs.standings import shown
from bodycheck.site.front import Front, Line
from bodycheck.site.front import Shown as ShownCell
from bodycheck.site.render import File, page


def pages(catalogue: Catalogue) -> Iterator[File]:
    """Yield the three pages."""
    front = Front(catalogue)
    lines = [line for group in front.groups for line in group.lines]
    others = {
        "recommended": [_others(line, line.recommended) for line in lines],
        "best": [_others(line, line.best) for line in lines],
    }
    costs = shown(catalogue)
    yield page(
        links.INDEX,
        "index.html.jinja",
        catalogue,
        front=front,
        others=others,
        answers=list(answers(catalogue, costs[0] if costs else None, front.news)),
        costs=costs[0] if costs else None,
        pictures=pictures(costs[0]) if costs else (),
        further=[one.scene for one in costs[1:] if any(standing.repeated for standing in one.standings)],
    )
    yield page(links.ROW, "row.html.jinja", catalogue)
    yield page(
        links.ERRORS,
        "errors.html.jinja",
        catalogue,
        left_out=sorted(catalogue.left_out, key=lambda one: (one.name, one.reason)),
    )


def _others(line: Line, others: Sequence[ShownCell]) -> dict[int, list[str]]:
    """Return the cells of a line for other methods that differ from the cells for the own methods, by column."""
    pairs = enumerate(zip(line.own, others, strict=True))
    return {column: _fields(other) for column, (usual, other) in pairs if usual != other}


def _fields(shown: ShownCell) -> list[str]:
    return [shown.text, shown.word, shown.mark, shown.style, shown.told, shown.address]
