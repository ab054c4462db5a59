"""Print which expectations could not be checked, because their engines cannot be used."""

from collections.abc import Sequence
from typing import TextIO

from bodycheck.results.unchecked import Unchecked, sentences


def show(unchecked: Sequence[Unchecked], stream: TextIO) -> None:
    """Print a sentence for each engine and reason."""
    for sentence in sentences(unchecked):
        print(sentence, file=stream)
