"""Curves that lie on each other are found, told and drawn so that all are visible; others are left as they are."""

import numpy as np
import pytest
import vl_convert

from bodycheck.reports.runs.charts import coincidence
from bodycheck.reports.runs.charts.step_charts import over_steps
from tests.support.measured_runs import FLIP, ran

GROWING = np.geomspace(1e-9, 1e-3, 60)


def groups(**curves: np.ndarray) -> list[list[str]]:
    return coincidence.coinciding(curves)


def test_curves_within_two_pixels_coincide() -> None:
    """A ratio of 1.04 is 2 pixels on a chart of 260 pixels and 2.2 decades, and less on a chart of more."""
    assert groups(a=GROWING, b=1.04 * GROWING, c=2 * GROWING) == [["a", "b"]]
    assert groups(a=GROWING, c=2 * GROWING, d=GROWING[:-1]) == []


@pytest.mark.parametrize(("apart", "alike"), [(2, True), (6, False)])
def test_a_few_points_may_be_rounding(apart: int, alike: bool) -> None:
    """Of 60 points, 3 are a twentieth."""
    noisy = GROWING.copy()
    noisy[:apart] *= 10
    assert bool(groups(a=GROWING, b=noisy)) is alike


def test_what_is_not_drawn_is_not_compared() -> None:
    """Zeros and numbers that are not finite; but a curve that is not drawn where the other one is does not coincide with it."""
    gone = np.where(np.arange(60) < 30, GROWING, 0.0)
    assert groups(a=gone, b=gone, zero=np.zeros(60), none=np.full(60, np.nan)) == [["a", "b"]]
    assert groups(a=GROWING, b=gone) == []


def test_every_curve_but_the_uppermost_has_a_band_that_the_next_does_not_hide() -> None:
    found = coincidence.bands([["a", "b", "c"], ["d", "e"]])
    assert found.keys() == {"a", "b", "d"}
    assert found["a"] > found["b"] == found["d"]


def test_all_names_or_their_number_are_told() -> None:
    text = coincidence.told([["a", "b"], list("cdefghij")])
    assert "a and b; c, d, e, f and 4 more methods." in text
    assert coincidence.told([]) == ""
    assert "and one more group" in coincidence.told([["a", "b"]] * 4)


def test_a_method_below_another_is_drawn_as_a_band() -> None:
    """The errors of both are the same at all steps."""
    runs = [
        ran(FLIP, "mujoco", name, step, attitude_error=error, position_error=0.0)
        for name in ("RK4", "Euler")
        for step, error in ((0.004, 4e-6), (0.002, 2e-7))
    ]
    (chart,) = over_steps(runs).charts
    assert "mujoco RK4 and mujoco Euler" in chart.notes[0]
    svg = vl_convert.vegalite_to_svg(chart.specification)
    assert svg.count('stroke-width="6"') == 1
    other = [ran(FLIP, timestep=step, attitude_error=10 * step, position_error=0.0) for step in (0.004, 0.002)]
    (chart,) = over_steps([*runs[:2], *other]).charts
    assert chart.notes == ()
    assert 'stroke-width="6"' not in vl_convert.vegalite_to_svg(chart.specification)
