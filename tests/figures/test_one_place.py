"""A figure of a run and an axis of extremes are written in one place, from which all the rest follows."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bodycheck import load, simulate, truth
from bodycheck.figures.columns import FIGURES, LIMITED
from bodycheck.figures.definition import Comparison
from bodycheck.figures.scales import in_run, in_scene
from bodycheck.results.outcome import Completed
from tests.support import ROOT
from tests.support.cases import shortened

CASE = """\
format = 1
name = "thrown"
title = "A thrown body"
[body]
shape = "sphere"
radius = 0.1
mass = 1.0
[initial]
velocity = [1.0, 0.0, 1.0]
[scene]
gravity = 9.81
[run]
duration = 0.2
samples = 3
[extremes]
lift = [5.0]
[[expect]]
engine = "mujoco"
integrator = "Euler"
timestep = 0.002
height_error = 1e-6
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("planted")
    (folder / "thrown.case.toml").write_text(CASE)
    brick = CASE.replace('shape = "sphere"\nradius = 0.1', 'shape = "brick"\nsemi_axes = [0.1, 0.1, 0.1]')
    (folder / "flat.case.toml").write_text(brick.replace("gravity = 9.81", "gravity = 9.81\nplane = {friction = 0.5}"))
    return folder


@pytest.fixture(scope="module")
def planted(folder: Path) -> dict[str, tuple[int, str]]:
    """The exit code of commands with the planted figure and axis, and what they print."""
    options = ("--engine", "mujoco", "--integrator", "Euler", "--out")
    commands = {
        "schema": ("schema",),
        "schema of results": ("schema", "results"),
        "tables": ("tables",),
        "run": ("run", str(folder / "thrown.case.toml"), *options, str(folder / "run")),
        "extremes": ("extremes", str(folder / "thrown.case.toml"), *options, str(folder / "extremes")),
        "validate": ("validate", str(folder / "flat.case.toml")),
    }
    asked = json.dumps(list(commands.values()))
    process = [sys.executable, "-m", "tests.figures.planted"]
    done = subprocess.run(process, input=asked, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return {name: (code, text) for name, (code, text) in zip(commands, json.loads(done.stdout), strict=True)}


def test_the_schemas_and_the_documentation_have_them(planted: dict[str, tuple[int, str]]) -> None:
    tables = json.loads(planted["schema"][1])["$defs"]
    words = "largest difference of the height of the centre of mass from that of mechanics"
    assert tables["ExpectTable"]["properties"]["height_error"]["description"] == f"{words}, m"
    lift = tables["ExtremesTable"]["properties"]["lift"]
    assert (lift["description"], lift["maxItems"]) == ("height by which the start is lifted, m", 50)
    row = json.loads(planted["schema of results"][1])["$defs"]["run"]["properties"]["height_error"]
    assert row["description"] == f"{words[0].upper()}{words[1:]}. Unit: m."
    printed = planted["tables"][1].splitlines()
    assert f"| `height_error` | m | {words} |" in printed
    assert "| `lift` | m | height by which the start is lifted |" in printed


def test_a_run_is_judged_by_the_figure_and_its_report_shows_it(planted: dict[str, tuple[int, str]], folder: Path) -> None:
    assert planted["run"][0] == 1, planted["run"][1]
    out = folder / "run"
    (row,) = csv.DictReader((out / "results.csv").read_text().splitlines())
    # Semi-implicit Euler is behind a parabola by h g t / 2: with h = 2 ms after 0.2 s.
    assert float(row["height_error"]) == pytest.approx(0.002 * 9.81 * 0.2 / 2, rel=1e-6)
    assert row["reason"].startswith("height_error is 0.001962 m, expected at most 1e-06 m; worst at t = 0.2 s")
    assert "Height error" in (out / "report.html").read_text()
    assert "Height error" in (out / "report.md").read_text()


def test_a_case_is_pushed_along_the_axis_and_the_page_shows_it(planted: dict[str, tuple[int, str]], folder: Path) -> None:
    assert planted["extremes"][0] == 0, planted["extremes"][1]
    out = folder / "extremes"
    (row,) = csv.DictReader((out / "extremes.csv").read_text().splitlines())
    assert (row["axis"], row["value"], row["status"]) == ("lift", "5.0", "ok")
    assert "lift of the start" in (out / "report.html").read_text()


def test_the_axis_is_refused_where_the_scene_lacks_what_it_needs(planted: dict[str, tuple[int, str]]) -> None:
    code, printed = planted["validate"]
    assert code == 2
    assert "extremes.lift: read [5.0]; a body that lies on a plane" in printed


@pytest.mark.parametrize("name", ["free-brick", "sliding-brick", "football-drag"])
def test_every_figure_is_what_its_entry_says(name: str) -> None:
    case = shortened(load(name), 0.1, 11)
    outcome = simulate(case, "mujoco", "Euler", 0.002).outcome
    assert isinstance(outcome, Completed)
    reference = truth(case).at(outcome.trajectory.t)
    compared = Comparison(reference, outcome.trajectory, outcome.load)
    for figure in FIGURES.values():
        value = figure.compute(compared)
        if figure.presence == "every run":
            assert value is not None, figure.name
        if value is not None:
            assert isinstance(value, np.ndarray) == figure.largest, figure.name
            assert np.shape(value) == ((11,) if figure.largest else ()), figure.name
            assert (np.asarray(value) >= 0).all(), figure.name


def test_the_sizes_for_limits_are_those_of_the_run_or_more_and_never_zero() -> None:
    reference = truth(load("resting-brick"))
    run, scene = in_run(reference, reference.trajectory), in_scene(reference)
    for figure in (FIGURES[name] for name in LIMITED if name in FIGURES):
        assert figure.scale(scene) >= figure.scale(run), figure.name
        assert figure.scale(scene) > 0, figure.name
