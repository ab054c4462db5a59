"""Curves of reports: few points that keep every largest value and every bend."""

import math

import numpy as np
import pytest

from bodycheck.reports.series import corners, ends, envelope, rounded


@pytest.mark.parametrize("samples", [1, 2, 7, 255, 256, 257, 1001, 99_999])
def test_an_envelope_covers_every_sample(samples: int) -> None:
    values = np.random.default_rng(samples).random(samples)
    last = ends(samples, 256)
    thin = envelope(values, 256)
    assert len(thin) == len(last) == min(samples, 256)
    assert last[-1] == samples - 1
    interval = np.searchsorted(last, np.arange(samples))
    assert (values <= thin[interval]).all()
    assert set(thin) <= set(values)
    assert (np.array([thin[i] == values[interval == i].max() for i in range(len(thin))])).all()


def test_corners_follow_curves() -> None:
    t = np.linspace(0, 10, 2001)
    curves = np.column_stack([np.sin(3 * t), 0.2 * np.cos(7 * t), np.full_like(t, 0.5)])
    kept = corners(t, curves, 800)
    assert kept[0] == 0
    assert kept[-1] == 2000
    assert len(kept) < 400
    drawn = np.column_stack([np.interp(t, t[kept], column) for column in curves[kept].T])
    # A thousandth of the range of the curves, which is 2.
    assert np.abs(drawn - curves).max() <= 2e-3
    assert corners(t, np.ones((2001, 3)), 800) == [0, 2000]
    assert len(corners(t, np.random.default_rng(0).random((2001, 3)), 100)) == 100
    assert corners(t[:1], curves[:1], 800) == [0]


def test_rounding_leaves_no_number_that_json_lacks() -> None:
    assert rounded([0.0, 123456.0, 1.23456e-7, math.nan, math.inf]) == [0.0, 123500.0, 1.235e-7, None, None]
