"""The scripts of adapters make the steps of the adapters' own runs, in a process that cannot import bodycheck."""

import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, Scripts
from bodycheck.adapters.scripts import COLUMNS
from bodycheck.casefile.case import Case, parse
from bodycheck.reference.trajectory import Array
from bodycheck.results.outcome import Completed
from bodycheck.running.exporting import NoScript, Question, written
from bodycheck.running.simulation import run

SAMPLES = 15
TIMESTEP = 0.003  # the instants of the cases are no multiples of it

#: Runs every script of a folder, where bodycheck cannot be imported, and writes what each prints beside it.
RUNNER = """
import contextlib, pathlib, runpy, sys
sys.modules["bodycheck"] = None
for script in sorted(pathlib.Path(sys.argv[1]).glob("*.py")):
    with script.with_suffix(".csv").open("w") as out, contextlib.redirect_stdout(out):
        runpy.run_path(str(script))
"""

THROWN = """
format = 1
name = "thrown"
title = "A body in a frame of its own"
[body]
shape = "none"
mass = 1.3
inertia = [[0.04, 0.002, 0.001], [0.002, 0.03, -0.003], [0.001, -0.003, 0.02]]
[initial]
position = [0.1, 0.2, 0.3]
velocity = [{velocity}]
quaternion = [0.5, 0.5, -0.5, 0.5]
angular_velocity = [{rates}]
[scene]
gravity = {gravity}
[run]
duration = 0.2
samples = 15
"""

#: A body that moves in every way, one that only turns, and one that only falls.
TUMBLING = THROWN.format(velocity="1.0, -2.0, 3.0", rates="0.1, 5.0, -0.3", gravity=9.81)
TURNING = THROWN.format(velocity="0.0, 0.0, 0.0", rates="0.1, 5.0, -0.3", gravity=0.0)
FALLING = THROWN.format(velocity="1.0, -2.0, 3.0", rates="0.0, 0.0, 0.0", gravity=9.81)
CASES = {name: parse(text, name) for name, text in (("tumbling", TUMBLING), ("turning", TURNING), ("falling", FALLING))}
CASES |= {name: replace(load(name), duration=0.2, samples=SAMPLES) for name in ("football-drag", "curling-brick", "free-brick")}

#: The cases on which every method is tried that an engine offers for them, one of each kind of scene.
KINDS = ("tumbling", "football-drag", "curling-brick")

#: Further runs, of the other models of a scene.
OTHERS = {
    "mujoco": [
        *(("turning", name) for name in ("RK4", "Euler:model=rotation", "RK4:model=translation-and-rotation")),
        *(("falling", "RK4"), ("free-brick", "Euler:model=far-geometry"), ("tumbling", "RK4:model=everything")),
        ("curling-brick", "implicitfast:cone=elliptic,pads=3,solref=0.01 1"),
    ],
    "pinocchio": [
        *(("turning", name) for name in ("semi-implicit-euler", "rk4", "rk4:model=six-coordinates")),
        ("falling", "semi-implicit-euler"),
    ],
}


def runs(engine: str) -> list[tuple[str, str]]:
    """Names of cases and spellings of methods whose scripts are compared with the engine's runs."""
    record = registry.load(engine).engine
    return [*((case, name) for case in KINDS for name in offers.offered(record, CASES[case].scene)), *OTHERS.get(engine, ())]


def states(text: str) -> Array:
    """The rows (n, 14) of times and states that a script printed."""
    first, *lines = text.splitlines()
    assert first == COLUMNS
    return np.array([[float(number) for number in line.split(",")] for line in lines])


def states_of_run(case: Case, engine: str, method: Method) -> Array:
    made = run(case, engine, method).outcome
    assert isinstance(made, Completed), made
    way = made.trajectory
    return np.column_stack([way.t, way.position, way.quaternion, way.velocity, way.angular_velocity])


def printed(folder: Path, programs: Sequence[str]) -> list[Array]:
    """What scripts print, which are run in one process that cannot import bodycheck."""
    for number, program in enumerate(programs):
        (folder / f"{number:03}.py").write_text(program)
    done = subprocess.run([sys.executable, "-I", "-c", RUNNER, folder], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    return [states((folder / f"{number:03}.csv").read_text()) for number in range(len(programs))]


@pytest.mark.parametrize("engine", [name for name in registry.names() if registry.installed(name)])
def test_a_script_makes_the_steps_of_the_run_to_the_last_bit(tmp_path: Path, engine: str) -> None:
    try:
        if not isinstance(registry.load(engine), Scripts):
            pytest.skip(f"the adapter of {engine} writes no scripts")
    except registry.EngineMissing as error:
        pytest.skip(str(error))
    asked = [Question(CASES[case], engine, Method.parse(name, TIMESTEP)) for case, name in runs(engine)]
    programs = {question: answer for question in asked if isinstance(answer := written(question), str)}
    refused = {f"{question.case.name} {question.method.name}" for question in asked if question not in programs}
    assert refused <= {
        "curling-brick Euler:model=planar",
        "curling-brick law-force",
        "curling-brick law-force:model=planar-joint",
    }
    for question, rows in zip(programs, printed(tmp_path, list(programs.values())), strict=True):
        expected = states_of_run(question.case, engine, question.method)
        assert len(expected) == SAMPLES
        np.testing.assert_array_equal(rows, expected, err_msg=f"{question.case.name} {question.method}")


@pytest.mark.parametrize(
    ("engine", "case", "method", "reason"),
    [
        ("mujoco", "curling-brick", "Euler:model=planar", "its friction is a force of bodycheck, not of MuJoCo"),
        ("mujoco", "free-brick", "Euler:model=planar", "no model 'planar' of this scene"),
        ("mujoco", "free-brick", "Euler:cone=elliptic", "has no option cone=elliptic"),
        ("pinocchio", "curling-brick", "law-force", "its friction is a force of bodycheck, not of Pinocchio"),
        ("pinocchio", "curling-brick", "admm:model=everything", "there is one of the model 'contact'"),
        ("pinocchio", "free-brick", "rk4:model=everything", "scripts have the smaller ones: translation, rotation"),
    ],
)
def test_what_cannot_be_a_script_is_refused_with_the_reason(engine: str, case: str, method: str, reason: str) -> None:
    try:
        assert isinstance(registry.load(engine), Scripts)
    except registry.EngineMissing as error:
        pytest.skip(str(error))
    answer = written(Question(CASES[case], engine, Method.parse(method, TIMESTEP)))
    assert isinstance(answer, NoScript)
    assert reason in answer.reason
