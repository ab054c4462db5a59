"""Plots as files: complete in themselves, with names that say what is in them."""

import zlib
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.commands.saved import read
from bodycheck.judging import result_set
from bodycheck.reports import plot_files
from bodycheck.reports.runs import plots
from bodycheck.reports.runs.contents import Contents, gather
from bodycheck.reports.study import StudyReport
from bodycheck.results import store
from tests.support import saved_results
from tests.support.saved_results import call

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of runs, with their plots."""
    return saved_results.made(tmp_path_factory, "run") / "run"


@pytest.fixture(scope="module")
def contents(folder: Path) -> Contents:
    return gather([result_set.judged(store.read(folder))])


def texts(path: Path) -> list[str]:
    return ["".join(element.itertext()) for element in ElementTree.parse(path).iter(f"{SVG}text")]


def test_every_plot_of_the_report_is_there_by_a_name_that_says_what_it_is(folder: Path, contents: Contents) -> None:
    names = [f"{section.name}-{name}" for section in contents.sections for name in section.curves.drawn]
    names += ["spin-momentum_body", "spin-momentum_inertial"]
    stepped = [
        (section.name, chart.title.lower().replace(" ", "-")) for section in contents.sections for chart in section.steps.charts
    ]
    assert ("spin", "attitude-error") not in stepped, "a sphere that spins has the exact attitude"
    assert ("slide", "position-error") in stepped
    names += [f"{section}-{title}-over-the-time-step" for section, title in stepped]
    names += [f"slide-{quantity}-engine-minus-truth" for quantity in ("stopping-distance", "stopping-time")]
    assert sorted(path.name for path in (folder / "figures").iterdir()) == sorted(f"{name}.svg" for name in names)
    assert "spin-position_error" in names


def test_a_plot_has_its_title_its_axes_and_its_whole_legend(folder: Path, contents: Contents) -> None:
    told = texts(folder / "figures" / "spin-position_error.svg")
    assert {
        "A sphere that spins and falls",
        "Position error; grey: the truth's own error",
        "Position error, m",
        "Time, s",
    } <= set(told)
    completed = {row["method"] for row in contents.sections[0].curves.datasets["series"]}
    assert {"mujoco Euler 10 ms", "mujoco RK4 5 ms"} <= completed <= set(told)
    assert {"x", "y", "z"} <= set(texts(folder / "figures" / "spin-momentum_inertial.svg"))


def test_an_svg_has_a_colour_of_its_own_and_no_ground(folder: Path) -> None:
    for path in (folder / "figures").glob("*.svg"):
        text = path.read_text()
        assert "currentColor" not in text
        assert 'class="background"' in text
        (ground,) = [e for e in ElementTree.parse(path).iter(f"{SVG}path") if e.get("class") == "background"][:1] or [None]
        assert ground is None or ground.get("fill") in (None, "none")
        assert len(text) < 200_000


def test_a_png_is_white_and_large_enough_for_a_slide(contents: Contents, tmp_path: Path) -> None:
    named = dict(plots.of_runs(contents))
    plot_files.write(iter([("spin-position_error", named["spin-position_error"])]), tmp_path, ("png",))
    data = (tmp_path / "figures" / "spin-position_error.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, colours = int.from_bytes(data[16:20]), data[25]
    assert width > 1900
    start = data.index(b"IDAT") + 4
    length = int.from_bytes(data[start - 8 : start - 4])
    row = zlib.decompressobj().decompress(data[start : start + length], 5)
    # Behind the kind of filter the first pixel of the first row stands as it is, whatever the filter.
    assert row[1:4] == b"\xff\xff\xff"
    assert colours == 2 or row[4] == 255


def test_the_report_command_writes_them_too(folder: Path, tmp_path: Path) -> None:
    assert call("report", folder, "--out", tmp_path, "--figures", "svg") == 1
    for path in (folder / "figures").iterdir():
        assert (tmp_path / "figures" / path.name).read_bytes() == path.read_bytes()


def test_a_legend_leaves_no_method_out(contents: Contents) -> None:
    section = contents.sections[0]
    name, chart = next(plots.of_runs(contents))
    assert name.startswith("spin-")
    assert chart["config"]["legend"]["symbolLimit"] == 0
    assert chart["config"]["legend"]["columns"] == 1
    assert chart["title"]["text"] == section.title


def test_charts_of_studies_are_files_too(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    report = read(saved_results.made(tmp_path_factory, "ablate") / "ablate")
    assert isinstance(report, StudyReport)
    plot_files.write(plot_files.of_study(report), tmp_path, ("svg",))
    (path,) = (tmp_path / "figures").iterdir()
    assert path.name == "spin-cost-of-a-step-relative-to-the-smallest-model-mujoco-euler-at-10-ms.svg"
    assert {"spin", "Cost of a step, relative to the smallest model: mujoco Euler at 10 ms"} <= set(texts(path))


@given(st.lists(st.text(max_size=300), max_size=20))
def test_names_are_safe_and_never_the_same(names: list[str]) -> None:
    taken: set[str] = set()
    files = [plot_files._file_name(name, taken) for name in names]
    assert len(set(files)) == len(files)
    for name in files:
        assert name
        assert len(name) < 110
        assert set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-_.")
        assert not name.startswith(".")
