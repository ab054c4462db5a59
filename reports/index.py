"""The index of a page: links to its sections, in their order."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Link:
    """A link of the index.

    Parameters
    ----------
    target
        The anchor of the section.
    text
        What the link is called.
    under
        Whether the section is one of the group whose link comes before.
    failed
        Whether a run of the section failed.
    """

    target: str
    text: str
    under: bool = False
    failed: bool = False


#: The link to the end of every page.
MADE = Link("made", "How this report was made")
