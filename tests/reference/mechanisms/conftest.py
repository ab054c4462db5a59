"""What all tests of the truth of mechanisms share."""

import sys
from collections.abc import Iterator

import pytest

from bodycheck.reference.mechanisms import followed


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    """Motions that were measured while a fault was planted are not those of the next test."""
    yield
    followed._measured_until.cache_clear()
    if (equations := sys.modules.get("bodycheck.reference.mechanisms.tree_equations")) is not None:
        equations._kept.cache_clear()
