"""The figures of the chapter, redrawn: each is written, and its data show what the figure is there to show."""

import importlib.util
import math
import re
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.integrate import dblquad

from tests.support import ROOT

SCRIPT = ROOT / "docs" / "figures.py"
NUMBERS = ("2.17", "2.18", "2.19", "2.20", "2.21", "2.22", "2.23", "2.24")


@pytest.fixture(scope="module")
def figures() -> ModuleType:
    spec = importlib.util.spec_from_file_location("figures", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def curves(figures: ModuleType, number: str) -> dict[str, np.ndarray]:
    """The values of each curve that a figure draws, over the ten seconds of its case."""
    rows: list[dict[str, Any]] = figures.FIGURES[number]()["data"]["values"]
    found: dict[str, list[float]] = {}
    for row in rows:
        found.setdefault(row["component"], []).append(row["value"])
    assert (rows[0]["t"], rows[-1]["t"]) == (0.0, 10.0)
    return {name: np.array(values) for name, values in found.items()}


def reversals(values: np.ndarray) -> int:
    return int((np.diff(np.sign(values)) != 0).sum())


def test_one_command_writes_every_figure(figures: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figures.main(["--out", str(tmp_path / "new")])
    written = sorted((tmp_path / "new").iterdir())
    assert [path.name for path in written] == [f"figure-{number}.svg" for number in NUMBERS]
    assert capsys.readouterr().out.split() == [str(path) for path in written]
    for number, path in zip(NUMBERS, written, strict=True):
        svg = path.read_text(encoding="utf-8")
        assert svg.startswith("<svg")
        assert f"Fig. {number}" in svg
        # Vega draws what it cannot place as NaN, and says nothing.
        assert "NaN" not in svg
        assert len(re.findall("<path", svg)) > 5


def test_the_page_of_figures_has_all_of_them_with_a_text() -> None:
    page = (ROOT / "docs" / "chapter-figures.md").read_text("utf-8")
    drawn = re.findall(r'^figure\("(\S+)", "(.{40,})"\)$', page, re.MULTILINE)
    assert [number for number, _ in drawn] == list(NUMBERS)


def test_figure_2_17_shows_the_axis_that_the_rotation_leaves_alone(figures: ModuleType) -> None:
    specification = figures.FIGURES["2.17"]()
    assert "0.770 π" in specification["title"]
    tips = {row["name"]: np.array([row["x"], row["y"], row["z"]]) for row in specification["data"]["values"] if row["end"] == 1}
    assert sorted(tips) == sorted("ijkIJKa")
    body = np.stack([tips[name] for name in "IJK"], axis=1)
    np.testing.assert_allclose(body @ tips["a"], tips["a"], rtol=0, atol=1e-15)
    # As the chapter's figure: mostly up, to positive x and negative y.
    np.testing.assert_allclose(tips["a"], [0.378, -0.157, 0.912], rtol=0, atol=5e-4)
    seen = {row["name"]: math.hypot(row["u"], row["v"]) for row in specification["data"]["values"] if row["end"] == 1}
    assert all(length <= np.linalg.norm(tips[name]) + 1e-15 for name, length in seen.items())


def test_figures_2_18_and_2_19_show_a_stable_spin(figures: ModuleType) -> None:
    for rate in curves(figures, "2.18").values():
        assert reversals(rate) == 0
        # Ten units, and a wobble of less than a thousandth.
        assert np.abs(rate - 10).max() < 0.01
    (pitch,) = curves(figures, "2.19").values()
    assert pitch[0] == pytest.approx(math.pi / 2)
    assert 0.02 < np.abs(pitch - math.pi / 2).max() < 0.04
    assert reversals(pitch - pitch.mean()) >= 10


def test_figures_2_20_and_2_21_show_an_unstable_spin(figures: ModuleType) -> None:
    for rate in curves(figures, "2.20").values():
        assert reversals(rate) >= 4
        assert rate.min() < -9
    (pitch,) = curves(figures, "2.21").values()
    assert pitch[0] == pytest.approx(math.pi / 2)
    assert pitch.min() < 0.5
    assert pitch.max() > 2.5


def test_figures_2_22_and_2_23_show_one_angular_momentum_in_two_frames(figures: ModuleType) -> None:
    body, inertial = (np.stack(list(curves(figures, number).values())) for number in ("2.22", "2.23"))
    size = np.linalg.norm(body[:, 0])
    # The truth of a flip is good to 1e-11 at least, with any backend.
    np.testing.assert_allclose(np.linalg.norm(body, axis=0), size, rtol=1e-10)
    np.testing.assert_allclose(inertial - inertial[:, :1], 0, atol=1e-10 * size)
    # From axis to axis: the spin is handed to I in each flip, and comes back to K with the other sign.
    swing = np.ptp(body, axis=1) / size
    assert (swing > 0.8).all()
    assert swing[2] > 1.9
    # One component carries nearly all in the inertial frame, and it is negative, as in the chapter.
    assert inertial[1, 0] < -0.99 * size


def test_figure_2_24_is_the_torque_integral(figures: ModuleType) -> None:
    rows = figures.FIGURES["2.24"]()["data"]["values"]
    # The chapter's axis ends at 6, for a = b = 2.
    assert 5.5 < max(row["integral"] for row in rows) < float(figures.spin_integral(np.array(2.0), np.array(2.0))) < 6.5
    assert {(row["a"], row["b2"]) for row in rows} >= {(0.0, 2.0), (1.0, 1.0)}
    for row in rows[::397]:
        a, b = (row["a"] + row["a2"]) / 2, (row["b"] + row["b2"]) / 2
        by_quadrature, _ = dblquad(lambda y, x: math.hypot(x, y), 0, a, 0, b, epsabs=1e-11)
        assert row["integral"] == pytest.approx(by_quadrature, abs=1e-9)
