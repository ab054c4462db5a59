"""No bound of a truth is broken: every figure of random bodies is within its bound of multiprecision arithmetic.

The bounds are those of the closed form alone, to which witnesses only add. `benchmarks/truth_bounds.py` prints the same for
thousands of cases.
"""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.casefile.case import parse
from bodycheck.reference.scenes import variable
from tests.support.bound_checks import UNITS, Check, check
from tests.support.random_cases import REGIMES, drawn

#: The largest median, over the cases of a regime, of the bound of an attitude over its error or a rounding, if that is larger.
LARGEST_MEDIAN = 100

#: The regimes whose bodies can be members of ensembles whose truths are computed at once.
MEMBERS = ("principal-frame", "slender", "separatrix", "principal-spin", "symmetric-top")


def broken(found: Check) -> list[str]:
    """The figures of a case whose bound is broken, with the largest error and the largest bound."""
    return [
        f"{found.regime} {found.seed}, {name}: error {figure.error.max():.3g} {UNITS[name]}, bound {figure.bound.max():.3g}"
        for name, figure in found.figures.items()
        if figure.broken.size
    ]


@pytest.mark.parametrize("regime", REGIMES)
def test_no_bound_is_broken(regime: str) -> None:
    for seed in range(2):
        assert broken(check(regime, seed, vouched=False)) == []


@pytest.mark.parametrize("regime", MEMBERS)
def test_no_bound_of_a_member_of_an_ensemble_is_broken(regime: str) -> None:
    for seed in range(2, 4):
        assert variable(parse(drawn(regime, seed)[0], regime).scene)
        assert broken(check(regime, seed, vouched=False, member=True)) == []


@pytest.mark.slow
@pytest.mark.parametrize("regime", REGIMES)
def test_bounds_are_close_to_the_errors(regime: str) -> None:
    found = [check(regime, seed, vouched=False) for seed in range(2, 21)]
    assert [each for every in found for each in broken(every)] == []
    assert float(np.median([each.figures["error"].ratio for each in found])) <= LARGEST_MEDIAN


def test_a_bound_that_is_too_small_is_seen() -> None:
    """No bound is so wide that a thousandth of it would do."""
    found = check("turned-frame", 0, vouched=False)
    small = {name: replace(figure, bound=figure.bound / 1000) for name, figure in found.figures.items()}
    assert len(broken(replace(found, figures=small))) == len(UNITS)
