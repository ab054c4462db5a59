"""Hostile case files: each is a case or has faults with places, and a case has a truth or a reason why it has none."""

import pytest

from tests.adversary.sizes import SEED, batches
from tests.adversary.trials import failures


def test_a_hostile_file_has_faults_or_a_truth() -> None:
    assert not failures("loading:truth_of_a_file", SEED, 200)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), batches("FILES"))
def test_many_hostile_files_have_faults_or_a_truth(first: int, count: int) -> None:
    assert not failures("loading:truth_of_a_file", first, count)
