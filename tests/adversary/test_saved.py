"""Damaged results, studies and baselines: read again, they end in a message and an exit code, and write nowhere else."""

import pytest

from tests.adversary.sizes import SEED, batches
from tests.adversary.trials import failures


def test_a_damaged_baseline_is_compared_or_refused() -> None:
    assert not failures("saved:diff_of_damage", SEED, 100)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("FOLDERS", 2))
def test_many_damaged_baselines_are_compared_or_refused(first: int, count: int) -> None:
    assert not failures("saved:diff_of_damage", first, count)
