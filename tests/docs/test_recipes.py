"""Recipes for CI do what they say in a repository of someone's own: they are run as they stand in the documents."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
import yaml

from bodycheck.casefile.finding import OF_CASES
from tests.support import ROOT

#: A case whose runs are short.
CASE = """\
format = 1
name = "own"
title = "A throw"
[body]
shape = "brick"
semi_axes = [0.1, 0.2, 0.3]
mass = 1.0
[initial]
velocity = [1.0, 0.0, 2.0]
angular_velocity = [1.0, 2.0, 3.0]
[run]
duration = 0.02
samples = 3
"""


def steps(file: str) -> dict[str, str]:
    """The scripts of a workflow or an action, by the names of their steps."""
    document: dict[str, Any] = yaml.safe_load((ROOT / file).read_text("utf-8"))
    listed = document["runs"]["steps"] if "runs" in document else document["jobs"]["physics"]["steps"]
    return {step["name"]: step["run"] for step in listed if "run" in step}


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository with one case file, and with a virtual environment in which the shipped cases are."""
    (tmp_path / "repository" / "physics").mkdir(parents=True)
    (tmp_path / "repository" / "physics" / "own.case.toml").write_text(CASE)
    (tmp_path / "repository" / "venv").mkdir()
    (tmp_path / "repository" / "venv" / "pyvenv.cfg").touch()
    (tmp_path / "repository" / "venv" / "cases").symlink_to(ROOT / "cases")
    return tmp_path / "repository"


def run(script: str, repository: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """A script as a runner runs it, with this bodycheck as the command `bodycheck`."""
    command = repository.parent / "bin" / "bodycheck"
    command.parent.mkdir(exist_ok=True)
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -P -m bodycheck "$@"\n')
    command.chmod(0o700)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GITHUB_")}
    environment |= {"PATH": f"{command.parent}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(ROOT), **variables}
    shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", script]
    return subprocess.run(shell, cwd=repository, env=environment, capture_output=True, text=True)


def cases(table: Path) -> set[str]:
    return set(pq.read_table(table, columns=["case"])["case"].to_pylist())


def test_the_workflow_runs_the_cases_of_the_repository(repository: Path) -> None:
    workflow = steps("docs/ci/bodycheck.yml")
    done = run(workflow["Run the cases"], repository)
    assert done.returncode == 0, done.stderr
    assert cases(repository / "results/report/results.parquet") == cases(repository / "results/now.parquet") == {"own"}
    assert (repository / "results/junit.xml").exists()
    (repository / "results/now.parquet").rename(repository / "baseline.parquet")
    (repository / "results/now.parquet").hardlink_to(repository / "baseline.parquet")
    assert run(workflow["Compare with the baseline"], repository).returncode == 0


@pytest.mark.parametrize("file", ["docs/ci/bodycheck.yml", "action.yml"])
def test_without_case_files_nothing_is_run(repository: Path, file: str) -> None:
    (repository / "physics" / "own.case.toml").unlink()
    variables = dict.fromkeys(("CASES", "ENGINES", "BASELINE"), "")
    done = run(steps(file)["Run the cases"], repository, OUT=str(repository / "results"), BODYCHECK="bodycheck", **variables)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f".: there is no {OF_CASES} in this folder or below it\n"
    assert not list(repository.rglob("results.*"))


@pytest.mark.slow
@pytest.mark.parametrize("chosen", ["", "\nphysics\n  \n", "**/*.case.toml"])
def test_the_action_runs_the_cases_and_engines_that_are_named(repository: Path, chosen: str) -> None:
    out = repository.parent / "out"
    variables = {"CASES": chosen, "ENGINES": "mujoco\n", "BASELINE": "base.parquet", "OUT": str(out), "BODYCHECK": "bodycheck"}
    done = run(steps("action.yml")["Run the cases"], repository, **variables)
    assert done.returncode == 0, done.stderr
    assert cases(out / "report/results.parquet") == {"own"}
    assert set(pq.read_table(out / "report/results.parquet")["engine"].to_pylist()) == {"mujoco"}
    (repository / "base.parquet").write_bytes((out / "now.parquet").read_bytes())
    assert run(steps("action.yml")["Compare with the baseline"], repository, **variables).returncode == 0


@pytest.mark.slow
def test_the_recipe_of_a_baseline_measures_the_cases_of_the_repository(repository: Path) -> None:
    text = (ROOT / "docs" / "howto" / "gate-ci.md").read_text("utf-8").partition("## Baselines")[2]
    recipe = re.findall(r"^\$ (bodycheck (?:run|diff) .*)", text, re.MULTILINE)[:3]
    assert [command.split()[1] for command in recipe] == ["run", "run", "diff"]
    done = run("\n".join(recipe), repository)
    assert done.returncode == 0, done.stderr
    assert cases(repository / "baseline.parquet") == cases(repository / "now.parquet") == {"own"}


def test_recipes_leave_the_python_of_the_job_alone_and_need_no_new_bash() -> None:
    action = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
    python = next(step for step in action["runs"]["steps"] if "setup-python" in step.get("uses", ""))
    assert python["with"]["update-environment"] is False
    scripts = [*steps("action.yml").values(), *steps("docs/ci/bodycheck.yml").values()]
    assert not [script for script in scripts if "mapfile" in script or "readarray" in script]
    assert not [
        script for script in steps("action.yml").values() if re.search(r"^\s*(python|pip|bodycheck) ", script, re.MULTILINE)
    ]


def test_the_hook_of_pre_commit_checks_case_files(repository: Path) -> None:
    hook, _ = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"))
    files = [str(path.relative_to(repository)) for path in repository.rglob("*") if re.search(hook["files"], str(path))]
    assert files == ["physics/own.case.toml"]
    assert run(f"{hook['entry']} {files[0]}", repository).stdout == "own: valid\n"
    (repository / files[0]).write_text(CASE.replace("mass = 1.0", "mass = -1.0"))
    assert run(f"{hook['entry']} {files[0]}", repository).returncode == 2


#: A robot of two bodies; its upper body has the mass in braces.
ROBOT = """\
<robot name="arm">
  <link name="base"/>
  <link name="arm">
    <inertial><mass value="{}"/><inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
</robot>
"""


def test_the_hook_of_pre_commit_compares_robots(repository: Path) -> None:
    """With the exit code of parity: 1 for a file that an engine refuses."""
    _, hook = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"))
    assert [name for name in ("a.urdf", "b/c.xml", "d.case.toml", "e.xml.txt") if re.search(hook["files"], name)] == [
        "a.urdf",
        "b/c.xml",
    ]
    (repository / "arm.urdf").write_text(ROBOT.format("1.0"), "utf-8")
    entry = f"{hook['entry']} --engine mujoco --states 2 arm.urdf"
    done = run(entry, repository)
    assert done.returncode == 0, done.stdout + done.stderr
    (repository / "arm.urdf").write_text(ROBOT.format("-1.0"), "utf-8")
    assert run(entry, repository).returncode in (1, 2)
