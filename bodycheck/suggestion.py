"""What somebody may have meant who wrote a name that nobody knows."""

from collections.abc import Collection
from difflib import get_close_matches

#: A word beyond so many characters is like no name.
LONGEST_WORD = 100


def did_you_mean(word: str, known: Collection[str]) -> str:
    """The end of a message on an unknown word: a question for the nearest known one; empty where none is near.

    Capitals count only between names that differ in nothing else.
    """
    if len(word) > LONGEST_WORD:
        return ""
    near = get_close_matches(word.casefold(), [name.casefold() for name in known], n=1)
    alike = [name for name in known if name.casefold() in near]
    nearest = get_close_matches(word, alike, n=1, cutoff=0)
    return f"; did you mean {nearest[0]!r}?" if nearest else ""
