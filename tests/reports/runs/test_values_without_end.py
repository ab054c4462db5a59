"""Reports of numbers that are none, or too large: what is drawn ends, and a page is made of whatever a results folder holds."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bodycheck.reference.trajectory import Array
from bodycheck.reports import series
from bodycheck.reports.runs import contents
from tests.support import saved_results
from tests.support.saved_results import REPORT, call

#: Instants of the curves below.
SAMPLES = 200


@pytest.fixture(scope="session")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return saved_results.made(tmp_path_factory, "run")


def curve(value: float, at: Any) -> Array:
    values = np.random.default_rng(1).normal(size=(SAMPLES, 3))
    values[at] = value
    return values


@pytest.mark.parametrize("at", [0, 57, SAMPLES - 1, slice(None), slice(3, 150)], ids=str)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e308, 5e-324])
def test_what_follows_a_curve_ends_and_keeps_what_is_finite(value: float, at: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    values, most, passes = curve(value, at), 50, 0
    plain = series._worst_misses

    def counted(*arguments: Any) -> Any:
        nonlocal passes
        passes += 1
        assert passes <= 2 * most, "it would not end"
        return plain(*arguments)

    monkeypatch.setattr(series, "_worst_misses", counted)
    with np.errstate(all="ignore"):
        kept = series.corners(np.arange(float(SAMPLES)), values, most)
    assert kept == sorted(set(kept))
    assert len(kept) <= most
    finite = np.isfinite(values).all(axis=1)
    if finite.any():
        assert finite[kept].all(), "a sample that is no number is a corner"
        assert {kept[0], kept[-1]} == {int(np.flatnonzero(finite)[0]), int(np.flatnonzero(finite)[-1])}


def test_what_takes_too_long_is_left_out_and_the_page_says_so(
    saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The drawing of one case would go on for ever; the other case of the same results is drawn."""
    folder = tmp_path / "run"
    shutil.copytree(saved / "run", folder)
    plain, hung = contents.animated, []

    def playing(scene: Any, *arguments: Any) -> Any:
        hung.append(scene)
        while len(hung) == 1:
            pass
        return plain(scene, *arguments)

    monkeypatch.setattr(contents, "animated", playing)
    monkeypatch.setattr(contents, "DRAWING_LIMIT_S", 0.5)
    assert call("report", folder) in (0, 1)
    assert (folder / "report.md").read_text().count("because drawing them took more than 0.5 s") == 1


@pytest.mark.parametrize("value", [np.nan, 1e300])
@pytest.mark.parametrize("column", ["x", "qw", "wz"])
@pytest.mark.parametrize("whose", ["truth", "runs"])
def test_a_report_is_made_of_trajectories_that_hold_such_values(
    saved: Path, tmp_path: Path, value: float, column: str, whose: str
) -> None:
    folder = tmp_path / "run"
    shutil.copytree(saved / "run", folder)
    for file in (folder / "trajectories").rglob("*.parquet"):
        table = pq.read_table(file)
        if file.name.startswith("truth") == (whose == "truth") and column in table.column_names:
            values = table[column].to_numpy().copy()
            values[len(values) // 2 :] = value
            place = table.column_names.index(column)
            pq.write_table(table.set_column(place, column, pa.array(values)), file)
    for name in REPORT:
        (folder / name).unlink()
    assert call("report", folder) in (0, 1)
    assert all((folder / name).stat().st_size for name in REPORT)
    page = (folder / "report.html").read_text()
    assert "the value is not a finite number" in page or "There is no animation because" in page
