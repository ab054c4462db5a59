"""The removal of personal data from results: paths, e-mail addresses, and the names of a machine and its user."""

import getpass
import re
import socket
from collections import Counter
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path

#: An e-mail address. ENGINE@VERSION does not match, because a version begins with a digit.
MAIL = re.compile(r"[\w.+-]{1,64}@(?=[A-Za-z])[\w-]{1,63}(?:\.[\w-]{1,63}){0,5}?\.[A-Za-z]{2,24}(?![\w@])")

#: A home folder, with the name of its owner.
HOME = re.compile(
    r"(?<![\w.])(?:file:/{1,3})?(?:(?:/home|/Users|/export/home)/[^\s/\\:;,'\"<>|()]{1,64}"
    r"|[A-Za-z]:[\\/]{1,2}Users[\\/]{1,2}(?:[^\\/:*?\"<>|\n]{1,64}(?=[\\/])|[^\s\\/:*?\"<>|]{1,64}))"
    r"|(?<![\w./\\])~[\w.-]{1,64}(?=[/\\])"
)

#: The folders of an absolute path, without its last part. The scheme of a URL and units such as m/s do not match.
PATH = re.compile(r"(?<![\w.:/])(?:file:/{1,3}|[A-Za-z]:[/\\]{1,2}|[/\\]{1,2}|~[/\\])(?:[^\s/\\:;,'\"<>|]{1,255}[/\\]{1,2})+")

#: The replacements of an e-mail address and of a name.
NO_MAIL, NO_NAME = "(e-mail address)", "(name)"

#: Names of users and machines that are not personal.
COMMON = frozenset({"root", "user", "admin", "runner", "ubuntu", "debian", "guest", "home", "localhost", "build", "nobody"})

#: Options of commands whose value is a path or concerns only the machine.
LEFT_OUT = ("--out", "--junit", "--save", "--jobs", "--package-path")


class Cleaning:
    """The removal of personal data, with a count of the removed items.

    Parameters
    ----------
    names
        The names of the machine and its user, which are also removed from texts.

    Attributes
    ----------
    removed
        The number of removed items of each kind, by the name of the kind.
    """

    def __init__(self, names: Collection[str] = ()) -> None:
        self.removed: Counter[str] = Counter()
        listed = "|".join(re.escape(name) for name in sorted(names, key=len, reverse=True))
        self._names = re.compile(rf"(?<![\w-])(?:{listed})(?![\w-])", re.IGNORECASE) if listed else None

    def text(self, value: str) -> str:
        """Return a text without the folders of paths, e-mail addresses, and the names."""
        before, cleaned = "", value
        while before != cleaned:  # a removal may join parts of another path or address; each leaves fewer separators
            before = cleaned
            if "@" in cleaned:
                cleaned = self._without(MAIL, NO_MAIL, "e-mail addresses", cleaned)
            if "/" in cleaned or "\\" in cleaned:
                cleaned = self._without(PATH, "", "paths", self._without(HOME, "~", "paths", cleaned))
        if self._names is not None:
            cleaned = self._without(self._names, NO_NAME, "names of the machine or its user", cleaned)
        return cleaned

    def command(self, words: Sequence[str]) -> list[str]:
        """Return the words of a command without the folders of paths, and without the options `LEFT_OUT`."""
        kept: list[str] = []
        left = iter(words[1:])
        for word in left:
            option, equals, value = word.partition("=")
            if option in LEFT_OUT:
                self.removed["options of the command"] += 1
                if not equals:
                    next(left, None)
            elif word.startswith("-"):
                kept.append(option + equals + self.text(_last(value)))
            else:
                kept.append(self.text(_last(word)))
        return ["bodycheck", *kept]

    def _without(self, pattern: re.Pattern[str], put: str, kind: str, value: str) -> str:
        cleaned, count = pattern.subn(put, value)
        if count:
            self.removed[kind] += count
        return cleaned


def first(value: str) -> str | None:
    """Return a description of the first e-mail address in a text, or else of the first home folder; None if it has neither."""
    for pattern, kind in ((MAIL, "an e-mail address"), (HOME, "the path of a home folder")):
        found = pattern.search(value) if "@" in value or "/" in value or "\\" in value else None
        if found is not None:
            return f"{kind}, {found[0][:60]!r}"
    return None


def own_names() -> tuple[str, ...]:
    """Return the names of this machine and of its user, without short and common names."""
    host = socket.gethostname()
    found = {host, host.partition(".")[0], Path.home().name}
    with suppress(OSError, KeyError):  # a user without a name, as in some containers
        found.add(getpass.getuser())
    return tuple(sorted(name for name in found if len(name) > 2 and name.lower() not in COMMON))


def _last(word: str) -> str:
    """Return the last part of a path, or a word that is no path as it is."""
    return re.split(r"[/\\]", word.rstrip("/\\"))[-1]
