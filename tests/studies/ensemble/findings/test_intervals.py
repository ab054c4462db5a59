"""Intervals from the spread of 16 sequences: against Student's t, against what is exact, and by how often they hold."""

import numpy as np
import pytest
from scipy import stats

from bodycheck.studies.ensemble.findings.intervals import quantile, quantile_interval, quantiles, share

#: Ensembles of a simulation, and the smallest and largest share of intervals that may hold: 95 % within three standard errors,
#: sqrt(0.05 * 0.95 / 2000) = 0.5 %, and one more per cent because shares of a hundred members are only nearly normal.
REPETITIONS, LEAST, MOST = 2000, 0.925, 0.975


def sequences(members: int) -> np.ndarray:
    return np.arange(members) % 16


def test_the_interval_is_that_of_students_t() -> None:
    sequence = sequences(1600)
    random = np.random.default_rng(1)
    having = random.random(1600) < 0.3
    shares = [having[sequence == one].mean() for one in range(16)]
    low, high = stats.t.interval(0.95, 15, np.mean(shares), stats.sem(shares))
    found = share(having, sequence)
    assert found.value == pytest.approx(having.mean(), rel=1e-15)
    assert (found.low, found.high) == pytest.approx((low, high), rel=1e-12)


@pytest.mark.parametrize("members", [1, 5, 100, 10**5])
def test_without_a_failure_the_bound_is_three_over_the_members(members: int) -> None:
    nothing, everything = np.zeros(members, bool), np.ones(members, bool)
    bound = min(1.0, 3 / members)
    found, whole = share(nothing, sequences(members)), share(everything, sequences(members))
    assert (found.value, found.low, found.high) == (0.0, 0.0, bound)
    assert (whole.value, whole.low, whole.high) == (1.0, 1 - bound, 1.0)
    assert (1 - bound) ** members <= 0.05  # so rarely is there no failure if the probability is the bound


@pytest.mark.parametrize(("probability", "members"), [(0.5, 160), (0.1, 1600), (0.02, 8000)])
def test_intervals_hold_as_often_as_they_say(probability: float, members: int) -> None:
    random = np.random.default_rng(7)
    sequence = sequences(members)
    found = [share(random.random(members) < probability, sequence) for _ in range(REPETITIONS)]
    assert all(0 <= one.low <= one.value <= one.high <= 1 for one in found)
    assert LEAST <= np.mean([one.low <= probability <= one.high for one in found]) <= MOST


def test_intervals_of_quantiles_hold_as_often_as_they_say() -> None:
    random = np.random.default_rng(8)
    sequence = sequences(1600)
    for probability in (0.5, 0.95):
        exact = stats.lognorm.ppf(probability, 1.0)
        ends = [quantile_interval(random.lognormal(size=1600), sequence, probability) for _ in range(REPETITIONS // 4)]
        assert LEAST <= np.mean([low <= exact <= high for low, high in ends]) <= MOST + 0.015  # with a quarter of the ensembles


def test_evenly_spread_members_have_narrower_intervals() -> None:
    """Where each sequence has a member in each hundredth of the range, the 16 shares differ by less than at random."""
    random = np.random.default_rng(9)
    strata = (np.repeat(np.arange(100), 16) + random.random(1600)) / 100
    spread, free = share(strata < 0.505, sequences(1600)), share(random.random(1600) < 0.505, sequences(1600))
    assert 0 < spread.high - spread.low < 0.5 * (free.high - free.low)


def test_quantiles_are_those_of_numpy_and_infinite_next_to_infinite_values() -> None:
    values = np.random.default_rng(3).lognormal(size=997)
    probabilities = [0.0, 0.05, 0.5, 0.95, 0.99, 1.0]
    assert np.array_equal(quantiles(values, probabilities), np.quantile(values, probabilities))
    assert quantile(np.array([1.0, 2.0, np.inf]), 0.5) == 2.0
    assert quantile(np.array([1.0, np.inf, np.inf]), 0.75) == np.inf
    assert quantile(np.array([1.0, np.inf, np.inf]), 0.25) == np.inf
