"""Suggest the closest known name for a misspelled one."""

from collections.abc import Collection
from difflib import get_close_matches

#: Longer words get no suggestion, because the comparison would take too long.
MAX_WORD_LENGTH = 100


def did_you_mean(word: str, known: Collection[str]) -> str:
    """Return the end of a message about an unknown word, which suggests the closest known one; empty if none is close.

    Upper and lower case matter only between known names that differ in nothing else.
    """
    if len(word) > MAX_WORD_LENGTH:
        return ""
    near = get_close_matches(word.casefold(), [name.casefold() for name in known], n=1)
    alike = [name for name in known if name.casefold() in near]
    nearest = get_close_matches(word, alike, n=1, cutoff=0)
    return f"; did you mean {nearest[0]!r}?" if nearest else ""
