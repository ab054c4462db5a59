"""Datasets in little space: what a page reads again differs from the numbers by less than can be seen."""

from base64 import b64decode
from typing import Any

import numpy as np
import pytest

from bodycheck.reports.runs.charts.packing import FEWEST, LOGARITHMIC, packed

RISING = np.geomspace(1e-17, 3.0, 400).tolist()


def read(name: str, values: list[float | None]) -> np.ndarray:
    """The numbers that are stored in a dataset, as the script of the page computes them."""
    least, largest, codes = one(name, values)
    levels = np.frombuffer(b64decode(codes), "<u2").astype(float)
    numbers = least + (levels - 1) / 65534 * (largest - least)
    return np.where(levels > 0, 10**numbers if name in LOGARITHMIC else numbers, np.nan)


def one(name: str, values: list[float | None]) -> Any:
    (row,) = packed({name: [{"method": "a", "x": values}]})[name]
    assert row["method"] == "a"
    return row["x"]


def test_errors_keep_three_digits_over_all_decades() -> None:
    """Half a level of 18 decades is a factor of 10^(18 / 131068), or 3.2e-4."""
    np.testing.assert_allclose(read("series", RISING), RISING, rtol=3.3e-4)


def test_coordinates_keep_a_share_of_their_range() -> None:
    """Half a level of a range of 2 is 1.6e-5."""
    values = np.sin(np.linspace(0, 9, 100)).tolist()
    np.testing.assert_allclose(read("joints", values), values, atol=1.6e-5)


@pytest.mark.parametrize("name", ["series", "joints"])
def test_what_has_no_place_on_the_scale_is_left_out(name: str) -> None:
    values = [None, *RISING[:FEWEST], 0.0]
    numbers = read(name, values)
    assert np.isnan(numbers).tolist() == [True, *[False] * FEWEST, name == "series"]


def test_short_arrays_and_shared_instants_stay_as_they_are() -> None:
    assert one("series", [1.0, 2.0]) == [1.0, 2.0]
    assert packed({"series": [{"t": RISING}]}) == {"series": [{"t": RISING}]}
    assert packed({"joints": [{"t": RISING}]}) != {"joints": [{"t": RISING}]}


@pytest.mark.parametrize("size", [1e-300, 1e-9, 0.25, 31.4, 1e12])
def test_ranges_of_any_size_are_kept(size: float) -> None:
    """To four digits of the largest number, which are rounded outwards, and half a level."""
    values = np.linspace(-size, size / 3, 50).tolist()
    np.testing.assert_allclose(read("joints", values), values, atol=2e-5 * size)


def test_one_value_alone_and_none_at_all() -> None:
    assert set(read("joints", [0.25] * FEWEST).tolist()) == {0.25}
    assert np.isnan(read("series", [0.0] * FEWEST)).all()
