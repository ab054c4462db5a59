"""Names in messages: the known name closest to a misspelled one, and the first few of the allowed names."""

from collections.abc import Collection, Sequence
from difflib import get_close_matches

#: Longer words get no suggestion, because the comparison would take too long.
MAX_WORD_LENGTH = 100

#: The most names that a message lists.
MAX_LISTED = 20


def did_you_mean(word: str, known: Collection[str]) -> str:
    """Return the end of a message about an unknown word, which suggests the closest known word; empty if none is close.

    Upper and lower case count only where known words differ in nothing else.
    """
    if len(word) > MAX_WORD_LENGTH:
        return ""
    near = get_close_matches(word.casefold(), [name.casefold() for name in known], n=1)
    alike = [name for name in known if name.casefold() in near]
    nearest = get_close_matches(word, alike, n=1, cutoff=0)
    return f"; did you mean {nearest[0]!r}?" if nearest else ""


def first_names(names: Sequence[str]) -> list[str]:
    """Return the names that a message lists: the first few, and an ellipsis for all others.

    The names may be those of a stranger: long ones are cut, and characters that are not printable are escaped.
    """
    cut = [name if len(name) <= MAX_WORD_LENGTH else f"{name[:MAX_WORD_LENGTH]}…" for name in names[:MAX_LISTED]]
    short = [name if name.isprintable() else repr(name)[1:-1] for name in cut]
    return [*short, *(["…"] if len(names) > MAX_LISTED else [])]
