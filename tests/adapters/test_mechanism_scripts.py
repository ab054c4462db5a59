"""The scripts of mechanisms make the steps of the adapters' own runs, in a process that cannot import bodycheck."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported, Scripts
from bodycheck.adapters.scripts import MECHANISM_COLUMNS
from bodycheck.reference.mechanisms.control import Samples, Sine, Stops
from tests.support.coupled_joints import gripper, hip
from tests.support.driven_hinge import PD, hinge
from tests.support.jointed import ball_and_hinge, cart_pole, four_bar, tree

STEP, DURATION, SAMPLES = 0.003, 0.2, 5  # the instants are no multiples of the step

HELD = Samples((0.0, 0.05), (1.0, 0.5))

MECHANISMS = {
    "tree": tree(),
    "loop": four_bar(),
    "ball": ball_and_hinge(),
    "hip": hip(),
    "gripper": gripper(damping=0.1, stiffness=2.0),
    "sampled": hinge(replace(PD, ki=3.0, rate=70.0, delay=2, effort_limit=5.0, no_load_speed=30.0, target=HELD)),
    "continuous": hinge(replace(PD, ki=3.0, target=Sine(0.5, 3.0)), stops=Stops(None, 0.4, None, 50.0, 0.1)),
    "pair": replace(gripper(), controllers=(replace(PD, target=0.02), replace(PD, joint=1, rate=100.0, target=0.01))),
}

RUNS = {
    "mujoco": [
        ("tree", "RK4"),
        ("ball", "discrete"),
        ("loop", "Euler:solref=0.01 1"),
        ("hip", "RK4"),
        *(("gripper", "RK4:solref=0.01 1"), ("sampled", "RK4"), ("continuous", "RK4"), ("continuous", "Euler:limits=effort")),
    ],
    "pinocchio": [
        *(("tree", "rk4"), ("tree", "semi-implicit-euler"), ("ball", "rk4-naive")),
        *(("hip", "rk4"), ("gripper", "rk4"), ("loop", "rk4"), ("loop", "semi-implicit-euler:baumgarte=100 20")),
        *(("sampled", "semi-implicit-euler"), ("continuous", "rk4:limits=effort"), ("pair", "rk4")),
    ],
}

RUNNER = """
import contextlib, pathlib, runpy, sys
sys.modules["bodycheck"] = None
for script in sorted(pathlib.Path(sys.argv[1]).glob("*.py")):
    with script.with_suffix(".csv").open("w") as out, contextlib.redirect_stdout(out):
        runpy.run_path(str(script))
"""


@pytest.mark.parametrize("engine", [name for name in RUNS if registry.installed(name)])
def test_a_script_makes_the_steps_of_the_run_to_the_last_bit(tmp_path: Path, engine: str) -> None:
    adapter = registry.load(engine)
    assert isinstance(adapter, Scripts)
    for number, (which, spelling) in enumerate(RUNS[engine]):
        program = adapter.script(MECHANISMS[which], Method.parse(spelling, STEP), DURATION, SAMPLES)
        (tmp_path / f"{number}.py").write_text(program)
    done = subprocess.run([sys.executable, "-I", "-c", RUNNER, tmp_path], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    steps = np.unique(np.rint(np.linspace(0.0, DURATION, SAMPLES) / STEP).astype(np.int64))
    for number, (which, spelling) in enumerate(RUNS[engine]):
        mechanism = MECHANISMS[which]
        expected = offers.prepare(adapter, [mechanism], Method.parse(spelling, STEP)).advance(np.diff(steps, prepend=0))[0]
        first, *lines = (tmp_path / f"{number}.csv").read_text().splitlines()
        cells = [line.split(",") for line in lines]
        assert first == MECHANISM_COLUMNS
        assert [cell[1] for cell in cells] == [body.name for body in mechanism.bodies] * SAMPLES
        printed = np.array([[float(number) for number in cell[2:]] for cell in cells]).reshape(expected.shape)
        np.testing.assert_array_equal(printed, expected, err_msg=f"{which} {spelling}")


@pytest.mark.parametrize("engine", [name for name in RUNS if registry.installed(name)])
def test_names_are_data_in_a_script(tmp_path: Path, engine: str) -> None:
    """A name of a stranger's file has quotes and backslashes, and would be code if it ended the text around it."""
    adapter, mark = registry.load(engine), tmp_path / "mark"
    assert isinstance(adapter, Scripts)
    names = (f'a""" + str(open({str(mark)!r}, "w")) + """', "b\\\\n\\\\", "'''{0}%s")
    named = [replace(body, name=name) for body, name in zip(tree().bodies, names, strict=False)]
    mechanism = replace(tree(), bodies=(*named, *tree().bodies[len(named) :]))
    (tmp_path / "0.py").write_text(adapter.script(mechanism, Method.parse(RUNS[engine][0][1], STEP), DURATION, SAMPLES))
    done = subprocess.run([sys.executable, "-I", "-c", RUNNER, tmp_path], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert not mark.exists()
    printed = (tmp_path / "0.csv").read_text()
    assert all(name in printed for name in names)


def test_what_cannot_be_a_script_is_refused_with_the_reason() -> None:
    adapter = registry.load("mujoco")
    assert isinstance(adapter, Scripts)
    with pytest.raises(SceneUnsupported, match="for a mechanism without loops"):
        adapter.script(cart_pole(), Method.parse("Euler:solref=0.01 1", STEP), DURATION, SAMPLES)
