"""Datasets in little space: what a page reads again differs from the numbers by less than can be seen."""

from base64 import b64decode
from typing import Any

import numpy as np
import pytest

from bodycheck.reports.runs.charts.packing import FEWEST, packed

RISING = np.geomspace(1e-17, 3.0, 400).tolist()


def read(stored: dict[str, Any]) -> np.ndarray:
    """The numbers, as the script of the page computes them."""
    levels = np.frombuffer(b64decode(stored["codes"]), "<u2").astype(float)
    numbers = stored["least"] + (levels - 1) / 65534 * (stored["largest"] - stored["least"])
    return np.where(levels > 0, 10**numbers if stored["log"] else numbers, np.nan)


def one(name: str, values: list[float | None]) -> Any:
    (row,) = packed({name: [{"method": "a", "x": values}]})[name]
    assert row["method"] == "a"
    return row["x"]


def test_errors_keep_three_digits_over_all_decades() -> None:
    """Half a level of 18 decades is a factor of 10^(18 / 131068), or 3.2e-4."""
    np.testing.assert_allclose(read(one("series", RISING)), RISING, rtol=3.3e-4)


def test_coordinates_keep_a_share_of_their_range() -> None:
    """Half a level of a range of 2 is 1.6e-5."""
    values = np.sin(np.linspace(0, 9, 100)).tolist()
    np.testing.assert_allclose(read(one("joints", values)), values, atol=1.6e-5)


@pytest.mark.parametrize("name", ["series", "joints"])
def test_what_has_no_place_on_the_scale_is_left_out(name: str) -> None:
    values = [None, *RISING[:FEWEST], 0.0]
    numbers = read(one(name, values))
    assert np.isnan(numbers).tolist() == [True, *[False] * FEWEST, name == "series"]


def test_short_arrays_and_instants_stay_as_they_are() -> None:
    assert one("series", [1.0, 2.0]) == [1.0, 2.0]
    assert packed({"series": [{"t": RISING}]}) == {"series": [{"t": RISING}]}


def test_one_value_alone_and_none_at_all() -> None:
    assert set(read(one("joints", [0.25] * FEWEST)).tolist()) == {0.25}
    assert np.isnan(read(one("series", [0.0] * FEWEST))).all()
