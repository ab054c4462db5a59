"""The sheet of contact: what is run, what its rows say, and its report."""

import csv
import json
from collections import defaultdict
from pathlib import Path

import pytest

from bodycheck.casefile.case import load
from bodycheck.figures.columns import FIGURES
from bodycheck.running import engines
from bodycheck.studies.contact import sheet
from bodycheck.studies.contact.rows import SHEET
from bodycheck.studies.contact.study import default_method, plan
from tests.support.commands import bodycheck

#: A scene that no engine and no truth has.
LIFTED = """\
format = 1
name = "shapeless"
title = "A body without a shape on a plane"
tags = ["contact"]
[body]
shape = "none"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
[scene]
gravity = 9.81
plane = {}
[run]
duration = 0.1
samples = 3
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of two scenes in MuJoCo, one of which it cannot do."""
    folder = tmp_path_factory.mktemp("contact")
    (folder / "shapeless.case.toml").write_text(LIFTED)
    cases = ("--case", "resting-brick", "--case", str(folder / "shapeless.case.toml"))
    done = bodycheck("contact", "mujoco", *cases, "--out", str(folder / "out"), "--json")
    assert done.returncode == 0, done.stderr
    (folder / "printed.json").write_text(done.stdout)
    return folder


def rows(made: Path) -> list[dict[str, str]]:
    return list(csv.DictReader((made / "out" / "contact.csv").read_text().splitlines()))


def test_the_table_has_its_columns_and_is_what_is_printed(made: Path) -> None:
    assert list(rows(made)[0]) == list(SHEET.by_name)
    assert [row["figure"] for row in json.loads((made / "printed.json").read_text())] == [row["figure"] for row in rows(made)]


def test_the_best_of_a_figure_is_no_worse_than_the_defaults(made: Path) -> None:
    values: dict[str, dict[str, float]] = defaultdict(dict)
    for row in rows(made):
        if row["figure"]:
            values[row["figure"]][row["setting"]] = float(row["value"])
    assert {"penetration", "position_error"} <= set(values)
    for figure, own in values.items():
        assert own["best"] <= own["defaults"], figure


def test_the_defaults_are_those_of_the_engine(made: Path) -> None:
    record = engines.describe(["mujoco"])[0]["mujoco"]
    own = default_method(record, load("resting-brick"))
    assert own is not None
    assert (own.name, own.timestep) == ("Euler", 0.002)
    usual = [row for row in rows(made) if row["setting"] == "defaults" and row["figure"]]
    assert {(row["integrator"], row["timestep"]) for row in usual} == {("Euler", "0.002")}
    # Models that replace the contacts by a force are no settings of contacts.
    tasks = plan([load("resting-brick")], {"mujoco": record}, (), ())
    assert not any(task.method.option("model") for task in tasks)
    assert {task.method.timestep for task in tasks} == {0.002, 0.0005}


def test_what_cannot_be_done_is_called_so(made: Path) -> None:
    (row,) = (row for row in rows(made) if row["scene"] == "shapeless")
    assert (row["status"], row["setting"], row["figure"], row["value"]) == ("unsupported", "defaults", "", "")
    text = (made / "out" / "report.html").read_text()
    assert "without a shape" in text


def test_every_figure_of_the_sheet_is_a_figure_of_runs() -> None:
    assert set(sheet.SUBJECTS) <= set(FIGURES)
    assert "resting-brick" in sheet.scenes()
