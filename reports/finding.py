"""A finding: a sentence made of measurements, with a link to the case or the part of the report that it names."""

from dataclasses import dataclass

#: Methods that one sentence names; it says how many more there are.
MOST_NAMES = 3

#: Errors are compared between methods only above this multiple of the truth's own error.
COMPARABLE = 100.0

#: Position errors (m) are compared between methods only above this, which is far above rounding in scenes of human size.
COMPARABLE_POSITION_M = 1e-6


@dataclass(frozen=True)
class Finding:
    """A sentence about a subject. The text is `before`, then the name `where`, which becomes a link, then `after`.

    Parameters
    ----------
    subject
        The heading of the sentence, a word or two.
    before, after
        The sentence before and after the name.
    where
        The case or, in a study, the part of the report that the name links to; empty if the sentence names none.
    title
        The words of the link, if they are other than the name.
    """

    subject: str
    before: str
    where: str = ""
    after: str = ""
    title: str = ""

    @property
    def text(self) -> str:
        """The whole sentence."""
        return f"{self.before}{self.title or self.where}{self.after}"
