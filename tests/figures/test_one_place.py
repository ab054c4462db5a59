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
from bodycheck.running.outcome import Completed
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


def planted(*arguments: str, code: int = 0) -> str:
    """What bodycheck with the planted figure and axis prints. code: its exit status."""
    command = [sys.executable, "-m", "tests.figures.planted", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == code, done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("planted")
    (folder / "thrown.case.toml").write_text(CASE)
    return folder


def test_the_schemas_and_the_documentation_have_them() -> None:
    tables = json.loads(planted("schema"))["$defs"]
    words = "largest difference of the height of the centre of mass from that of mechanics"
    assert tables["ExpectTable"]["properties"]["height_error"]["description"] == f"{words}, m"
    lift = tables["ExtremesTable"]["properties"]["lift"]
    assert (lift["description"], lift["maxItems"]) == ("height by which the start is lifted, m", 50)
    row = json.loads(planted("schema", "results"))["$defs"]["run"]["properties"]["height_error"]
    assert row["description"] == f"{words[0].upper()}{words[1:]}. Unit: m."
    printed = planted("tables").splitlines()
    assert f"| `height_error` | m | {words} |" in printed
    assert "| `lift` | m | height by which the start is lifted |" in printed


def test_a_run_is_judged_by_the_figure_and_its_report_shows_it(folder: Path) -> None:
    out = folder / "run"
    options = ("--engine", "mujoco", "--integrator", "Euler", "--out", str(out))
    planted("run", str(folder / "thrown.case.toml"), *options, code=1)
    (row,) = csv.DictReader((out / "results.csv").read_text().splitlines())
    # Semi-implicit Euler is behind a parabola by h g t / 2: with h = 2 ms after 0.2 s.
    assert float(row["height_error"]) == pytest.approx(0.002 * 9.81 * 0.2 / 2, rel=1e-6)
    assert row["reason"].startswith("height_error is 0.001962 m, expected at most 1e-06 m; worst at t = 0.2 s")
    assert "Height error" in (out / "report.html").read_text()
    assert "Height error" in (out / "report.md").read_text()


def test_a_case_is_pushed_along_the_axis_and_the_page_shows_it(folder: Path) -> None:
    out = folder / "extremes"
    options = ("--engine", "mujoco", "--integrator", "Euler", "--out", str(out))
    planted("extremes", str(folder / "thrown.case.toml"), *options)
    (row,) = csv.DictReader((out / "extremes.csv").read_text().splitlines())
    assert (row["axis"], row["value"], row["status"]) == ("lift", "5.0", "ok")
    assert "lift of the start" in (out / "report.html").read_text()


def test_the_axis_is_refused_where_the_scene_lacks_what_it_needs(folder: Path) -> None:
    path = folder / "flat.case.toml"
    brick = CASE.replace('shape = "sphere"\nradius = 0.1', 'shape = "brick"\nsemi_axes = [0.1, 0.1, 0.1]')
    path.write_text(brick.replace("gravity = 9.81", "gravity = 9.81\nplane = {friction = 0.5}"))
    assert "extremes.lift: read [5.0]; a body that lies on a plane" in planted("validate", str(path), code=2)


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
