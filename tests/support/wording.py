"""What a sentence tells, whatever its words: tests look at it, and golden pages keep the words."""

import re

NUMBER = r"-?\d+(?:\.\d+)*(?:e[-+]?\d+)?"


def facts(text: str, *names: str) -> list[str]:
    """All numbers of a sentence, and these names wherever it has them, in the order in which they are told."""
    known = sorted(map(re.escape, names), key=len, reverse=True)
    return re.findall(rf"(?<![\w.-])(?:{'|'.join([*known, NUMBER])})(?!\w)", text)
