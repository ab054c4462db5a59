"""The sheet of contact: what is run, what its rows say, and its report."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from bodycheck.casefile.case import load
from bodycheck.figures.columns import FIGURES
from bodycheck.running import engines
from bodycheck.studies.contact import sheet
from bodycheck.studies.contact.rows import SHEET
from bodycheck.studies.contact.study import plan, usual_methods
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


def settings(made: Path) -> dict[str, dict[str, str]]:
    """The rows of contact_settings.csv on the brick, by setting."""
    table = csv.DictReader((made / "out" / "contact_settings.csv").read_text().splitlines())
    return {row["setting"]: row for row in table if row["group"] == "plane"}


def test_the_best_setting_is_no_worse_than_the_defaults(made: Path) -> None:
    errors = {row["setting"]: float(row["value"]) for row in rows(made) if row["figure"] == "position_error"}
    assert errors["best"] < errors["defaults"]
    listed = settings(made)
    assert float(listed["defaults"]["error"]) == 1
    # Of one scene, the mean is its own ratio.
    assert float(listed["best"]["error"]) == pytest.approx(errors["best"] / errors["defaults"], rel=1e-12)
    assert int(listed["best"]["tried"]) > 20


def test_the_settings_are_listed_and_are_those_of_the_rows(made: Path) -> None:
    listed = settings(made)
    assert (listed["defaults"]["integrator"], listed["defaults"]["timestep"]) == ("Euler", "0.002")
    assert listed["recommended"]["integrator"] == "implicitfast"
    for row in rows(made):
        if row["figure"]:
            own = listed[row["setting"]]
            assert (row["integrator"], row["timestep"]) == (own["integrator"], own["timestep"])
            if row["setting"] == "best":
                assert float(row["timestep"]) >= 0.002 / 4
                assert "model" not in row["integrator"], "models that replace contacts by a force are no settings"


def test_the_defaults_are_those_of_the_engine(made: Path) -> None:
    record = engines.describe(["mujoco"])[0]["mujoco"]
    case = load("resting-brick")
    own = usual_methods(record, case)
    assert {setting: method.name for setting, method in own.items()} == {"defaults": "Euler", "recommended": "implicitfast"}
    tasks = plan([case], {"mujoco": record}, (), ())
    assert [task.method for task in tasks] == list(own.values())
    named = plan([case], {"mujoco": record}, ("RK4",), (1e-3,))
    assert {(task.method.name, task.method.timestep) for task in named} >= {("Euler", 2e-3), ("RK4", 1e-3)}


def test_the_probes_find_the_contacts_of_the_defaults(made: Path) -> None:
    table = csv.DictReader((made / "out" / "contact_properties.csv").read_text().splitlines())
    values = {(row["setting"], row["property"], row["condition"]): row["value"] for row in table}
    # MuJoCo's solref makes a ball keep 0.13 of its speed, and its depth does not depend on its mass.
    assert 0.12 < float(values["defaults", "restitution", "1 m/s"]) < 0.14
    assert values["defaults", "bounce-threshold", ""] == ""
    light, heavy = (float(values["defaults", "depth-at-rest", mass]) for mass in ("1 kg", "100 kg"))
    assert light == pytest.approx(heavy, rel=1e-6)
    assert light > 1e-5
    # The pyramid has the friction mu cos(45 degrees) between its edges.
    pyramid = float(values["defaults", "friction-anisotropy", "edges along the axes of the world"])
    assert pyramid == pytest.approx(1 - 2**-0.5, abs=1e-3)
    assert float(values["defaults", "sleeping", ""]) == 0
    assert 0.04 < float(values["defaults", "viscous-speed", ""]) < 0.05  # 0.9 mu g/b with b = 95/s


def test_an_interrupted_study_makes_only_what_is_left(made: Path, tmp_path: Path) -> None:
    folder = tmp_path / "again"
    shutil.copytree(made / "out", folder)
    journal = folder / "contact.jsonl"
    *kept, _, _, _ = journal.read_text().splitlines(keepends=True)  # the footer and two probes are lost
    journal.write_text("".join(kept))
    run = folder / "run.jsonl"
    run.write_text("".join(run.read_text().splitlines(keepends=True)[:-1]))
    cases = ("--case", "resting-brick", "--case", str(made / "shapeless.case.toml"))
    done = bodycheck("contact", "mujoco", *cases, "--out", str(folder), "--json")
    assert done.returncode == 0, done.stderr
    assert "resuming the interrupted search" in done.stderr
    for table in ("contact", "contact_settings", "contact_properties"):
        assert (folder / f"{table}.csv").read_bytes() == (made / "out" / f"{table}.csv").read_bytes()


def test_what_cannot_be_done_is_called_so(made: Path) -> None:
    row = next(row for row in rows(made) if row["scene"] == "shapeless")
    assert (row["status"], row["setting"], row["figure"], row["value"]) == ("unsupported", "defaults", "", "")
    text = (made / "out" / "report.html").read_text()
    assert "without a shape" in text


def test_every_figure_of_the_sheet_is_a_figure_of_runs() -> None:
    assert set(sheet.SUBJECTS) <= set(FIGURES)
    assert "resting-brick" in sheet.scenes()
    assert "stack-mass-ratio" in sheet.scenes()


def test_scenes_that_show_little_for_their_cost_are_on_the_sheet_only_if_they_are_named() -> None:
    assert sheet.ONLY_NAMED.isdisjoint(sheet.scenes())
    assert all(sheet.TAG in load(name).tags for name in sheet.ONLY_NAMED)
