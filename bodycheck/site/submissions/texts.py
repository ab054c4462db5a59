"""Rules for texts from strangers, so that they can be shown on a page without effect on the rest of the page."""

import re
import unicodedata
from collections.abc import Sequence

from bodycheck.site.submissions import personal

#: The most characters of a text.
LONGEST = 4000

#: Markup that a text must not contain, since a browser would load or run it. Pages also escape all texts. Each part of the
#: pattern has a bounded length, so the time of a search is linear in the length of the text.
LOADING = re.compile(
    r"<[\s/]{0,9}(?:script|img|iframe|object|embed|style|svg|math|form|input|video|audio|meta\s+http)\b"
    r"|<[^<>]{0,300}\bon[a-z]{3,30}\s{0,9}=|javascript\s{0,9}:",
    re.IGNORECASE,
)

#: Bidirectional classes of characters that change the direction of text, and categories of characters drawn over others.
TURNING = frozenset({"R", "AL", "AN", "RLE", "LRE", "RLO", "LRO", "PDF", "RLI", "LRI", "FSI", "PDI"})
OVER = frozenset({"Mn", "Me", "Mc"})


def text(value: str, longest: int = LONGEST) -> str:
    """Return a text unchanged if it may be shown on a page.

    Raises
    ------
    ValueError
        The text is too long, or contains characters that cannot be printed or that affect the text around them, markup that a
        browser would load or run, the path of a home folder, or an e-mail address.
    """
    if len(value) > longest:
        raise ValueError(f"has {len(value)} characters; at most {longest} are allowed")
    if value.isascii() and value.isprintable():
        pass
    elif fault := next((letter for letter in value if not _allowed(letter)), ""):
        raise ValueError(f"has the character U+{ord(fault):04X}; allowed are those that can be printed, from left to right")
    if LOADING.search(value):
        raise ValueError("has markup that a browser would load or run")
    if (found := personal.first(value)) is not None:
        raise ValueError(f"has {found}, which may be personal; `bodycheck submit` removes it")
    return value


def shown(value: str, longest: int = LONGEST) -> str:
    """Return a text from this machine for readers: with "?" for characters that are not allowed, and cut to length."""
    return _cut("".join(letter if _allowed(letter) else " " if letter.isspace() else "?" for letter in value), longest)


def published(value: str) -> str:
    """Return a text from this machine as `text` allows it, apart from personal data.

    Characters that are not allowed, and those of markup that a browser would load, become "?". The text is cut to length.
    """
    return _cut(_harmless(shown(value, len(value)), "??"), LONGEST)


def escaped(value: str, longest: int = LONGEST) -> str:
    """Return a name from a stranger's file as `text` allows it, apart from personal data.

    Characters that are not allowed, and those that make markup which a browser would load, become escapes, so that different
    names stay different. The name is cut to length.
    """
    allowed = "".join(letter if _allowed(letter) and letter != "\n" else _escape(letter) for letter in value)
    return _cut(_harmless(allowed, (_escape("<"), _escape(":"))), longest)


def _escape(letter: str) -> str:
    return rf"\x{ord(letter):02x}" if letter.isascii() else letter.encode("unicode_escape").decode("ascii")


def _harmless(value: str, instead: Sequence[str]) -> str:
    """Return a text in which nothing matches `LOADING`; `instead` replaces the signs < and : of what matches."""
    while LOADING.search(value):  # each round leaves fewer of the signs
        value = LOADING.sub(lambda match: match[0].replace("<", instead[0]).replace(":", instead[1]), value)
    return value


def _cut(value: str, longest: int) -> str:
    return value if len(value) <= longest else f"{value[: longest - 1]}…"


def _allowed(letter: str) -> bool:
    if letter.isascii():
        return letter.isprintable() or letter == "\n"
    return (
        letter.isprintable() and unicodedata.category(letter) not in OVER and unicodedata.bidirectional(letter) not in TURNING
    )
