"""What a text from a stranger may have, so that it can stand on a page without changing what stands around it."""

import re
import unicodedata

from bodycheck.site.submissions import personal

#: Most characters of a text.
LONGEST = 4000

#: What a text must not have, since a browser would load or run it. Pages escape texts; this is the second wall. Each part has
#: bounded length, so that the time is linear in that of the text.
LOADING = re.compile(
    r"<[\s/]{0,9}(?:script|img|iframe|object|embed|style|svg|math|form|input|video|audio|meta\s+http)\b"
    r"|<[^<>]{0,300}\bon[a-z]{3,30}\s{0,9}=|javascript\s{0,9}:",
    re.IGNORECASE,
)

#: Classes of characters that change the direction of the text around them, and categories of those that are drawn over others.
TURNING = frozenset({"R", "AL", "AN", "RLE", "LRE", "RLO", "LRO", "PDF", "RLI", "LRI", "FSI", "PDI"})
OVER = frozenset({"Mn", "Me", "Mc"})


def text(value: str, longest: int = LONGEST) -> str:
    """Return a text if it may stand on a page.

    Raises
    ------
    ValueError
        It is too long, has characters that cannot be printed or change those around them, markup that a browser would load or
        run, or something personal: a path, or an e-mail address.
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
    """Return a text of one's own machine as `text` allows it: "?" stands for other characters, and what is too long is cut."""
    allowed = "".join(letter if _allowed(letter) else " " if letter.isspace() else "?" for letter in value)
    return allowed if len(allowed) <= longest else f"{allowed[: longest - 1]}…"


def _allowed(letter: str) -> bool:
    if letter.isascii():
        return letter.isprintable() or letter == "\n"
    return (
        letter.isprintable() and unicodedata.category(letter) not in OVER and unicodedata.bidirectional(letter) not in TURNING
    )
