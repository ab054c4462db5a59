"""Figures whose definition has changed, and notices about numbers stored with another definition."""

from collections.abc import Collection, Mapping

from bodycheck.figures.columns import FIGURES

#: The revisions of the figures whose definition has ever changed; any other figure has revision 1.
REVISIONS: dict[str, int] = {name: figure.revision for name, figure in FIGURES.items() if figure.revision > 1}


def redefined(one: Mapping[str, int], other: Mapping[str, int] = REVISIONS) -> list[str]:
    """Return the figures whose definitions differ between two sets of revisions; a missing revision is 1."""
    return [name for name in FIGURES if one.get(name, 1) != other.get(name, 1)]


def notices(stored: Mapping[str, int], names: Collection[str]) -> list[str]:
    """Return a sentence, without its full stop, for each figure that was stored with a definition other than the present.

    stored: the revisions of the stored figures. names: the names of the stored figures.
    """
    return [_notice(name, stored.get(name, 1)) for name in redefined(stored) if name in names]


def _notice(name: str, revision: int) -> str:
    figure = FIGURES[name]
    then = f" ({figure.formerly})" if revision == figure.revision - 1 else ""
    return f"The numbers of {name} have another definition{then} than those of this version of bodycheck ({figure.told})"
