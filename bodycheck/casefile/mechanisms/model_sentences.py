"""Sentences on the parts of a robot's file that are no mechanics of a case: notices, and reasons to refuse the file."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from bodycheck.casefile.mechanisms.grammar import WORLD
from bodycheck.casefile.robots.reading import Choice, Feature, Ignored, Read

#: Verbs of clauses in the plural, and words for the singular, for a clause about one part.
SINGULAR = {
    "are": "is", "have": "has", "do": "does", "exert": "exerts", "act": "acts", "move": "moves", "hold": "holds",
    "need": "needs", "state": "states", "follow": "follows", "carry": "carries", "share": "shares", "give": "gives",
    "push": "pushes", "their": "its", "them": "it", "they": "it",
}  # fmt: skip

#: Most lines, or ranges of lines, that a sentence lists; more are given as one range from the first to the last.
MAX_RANGES = 3

#: The notice on a root link with mass that is fixed to the world.
WELDED = 'The base is fixed; base = "free" in the table [model] of a case lets it fall.'


@dataclass(frozen=True)
class Refusal:
    """Why a case refuses a feature of a file that acts from the beginning.

    clause: the feature, and what it does. word: the word of `ignore` that leaves it out; None if no word does. them: "it" if
    the file has it once, else "them".
    """

    clause: str
    word: Ignored | None
    them: str

    def sentence(self, option: str = 'ignore = ["{}"]') -> str:
        """Return the sentence, with advice on leaving the feature out. option: what leaves something out, {} for the word."""
        advice = "" if self.word is None else f"; {option.format(self.word)} leaves {self.them} out"
        return f"{self.clause}, which a case cannot state yet{advice}"


def notices(read: Read, choice: Choice, file: str) -> Iterator[str]:
    """Yield a sentence on each feature of a file that a case leaves out, and on a base that the file fixes.

    file: the name of the file, which is left out where it is clear.
    """
    for feature in read.features:
        if feature.acts and feature.word in choice.ignore & choice.use:
            clause = f"{feature.text}, and are left out"
        elif feature.word in choice.ignore - choice.use:
            clause = "are left out, as the case ignores them"
        elif not feature.acts:
            clause = feature.text.removeprefix(feature.noun[1]).strip()
        else:
            continue
        yield f"{_subject(feature, file)} {_agreeing(clause, feature)}."
    if _is_held(read):
        yield WELDED


def _is_held(read: Read) -> bool:
    """Return whether a body with mass is fixed to the world, and none floats."""
    of_world = {joint["type"] for joint in read.tables["joints"] if joint["parent"] == WORLD}
    return "free" not in of_world and (read.welded or "fixed" in of_world)


def refusals(read: Read, ignore: Collection[Ignored]) -> Iterator[Refusal]:
    """Yield the reason for each feature that acts from the beginning and is not ignored."""
    for feature in read.features:
        if feature.acts and feature.word not in ignore:
            clause = feature.text.removeprefix(feature.noun[1]).strip()
            them = "it" if _is_one(feature) else "them"
            yield Refusal(f"{_subject(feature, None)} {_agreeing(clause, feature)}", feature.word, them)


def without(read: Read, ignore: Collection[Ignored]) -> Iterator[Ignored]:
    """Yield the words of `ignore` that leave out something that a file has."""
    words = {feature.word for feature in read.features} | {word for word, has in _acting_later(read) if has}
    yield from sorted(word for word in ignore if word in words)


def _acting_later(read: Read) -> Iterator[tuple[Ignored, bool]]:
    yield "limits", bool(read.ranges)
    yield "contacts", read.touching


def _subject(feature: Feature, file: str | None) -> str:
    count = len(feature.lines)
    noun = feature.noun[count > 1]
    counted = f"The {noun.format(count)}" if "{}" in noun else f"{count} {noun}"
    return f"{counted} ({places(feature.lines, file)})"


def _is_one(feature: Feature) -> bool:
    """Return whether the subject of a sentence on a feature is singular."""
    return len(feature.lines) == 1 or "{}" in feature.noun[1]


def _agreeing(clause: str, feature: Feature) -> str:
    """Return a clause about several parts as one about the parts of a feature."""
    if not _is_one(feature):
        return clause
    words = clause.split(" ")
    return " ".join(SINGULAR.get(word.rstrip(","), word.rstrip(",")) + "," * word.endswith(",") for word in words)


def places(lines: Sequence[tuple[str, int]], file: str | None) -> str:
    """Return a phrase for places in files, such as "robot.xml, lines 10 and 14"; without the name of a given file."""
    by_file: dict[str, list[int]] = {}
    for name, line in lines:
        by_file.setdefault(name, []).append(line)
    return "; ".join(
        (f"{name}, " if name != file else "") + _of_lines(sorted(set(numbers))) for name, numbers in by_file.items()
    )


def _of_lines(numbers: Sequence[int]) -> str:
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][-1] + 1:
            ranges[-1] = [ranges[-1][0], number]
        else:
            ranges.append([number])
    if ranges == [[numbers[0], numbers[0] + 1]]:
        ranges = [[numbers[0]], [numbers[1]]]
    if len(ranges) > MAX_RANGES:
        ranges = [[numbers[0], numbers[-1]]]
    phrases = [" to ".join(map(str, each)) for each in ranges]
    listed = ", ".join(phrases[:-1]) + (" and " if phrases[1:] else "") + phrases[-1]
    return f"line{'s' if len(numbers) > 1 else ''} {listed}"
