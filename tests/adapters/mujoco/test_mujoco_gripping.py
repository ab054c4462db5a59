"""Bodies between fingers in MuJoCo."""

import io
import runpy
from contextlib import redirect_stdout
from pathlib import Path

import mujoco
import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mujoco import engine as adapter
from bodycheck.adapters.mujoco import gripping
from bodycheck.figures.contact import creep
from bodycheck.figures.definition import Comparison
from bodycheck.figures.touching import energy_gain
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.results.outcome import Completed
from bodycheck.running.simulation import simulate
from bodycheck.running.truths import truth
from tests.support.grips import GRAVITY, PAD, grip, pressed


def heights(scene: Mechanism, spelling: str, steps: int, timestep: float = 0.002) -> Array:
    """The heights (n,) of the body after each step."""
    strides = np.ones(steps, dtype=np.int64)
    return np.asarray(adapter.prepare([scene], Method.parse(spelling, timestep)).advance(strides)[0][:, 0, 2])


def test_fingers_are_slides_and_pairs_touch_alone() -> None:
    scene = grip(12.0, 0.5, torsional=0.01, lift=20.0)
    model = mujoco.MjModel.from_xml_string(gripping.document(scene, Method.parse("Euler", 0.002)))
    kinds = mujoco.mjtJoint
    assert model.jnt_type.tolist() == [kinds.mjJNT_FREE, kinds.mjJNT_SLIDE, kinds.mjJNT_SLIDE, kinds.mjJNT_SLIDE]
    assert not model.geom_contype.any()
    assert model.pair_dim.tolist() == [4, 4]
    assert model.pair_friction[:, :3].tolist() == [[0.5, 0.5, 0.01]] * 2


def test_a_body_without_friction_falls_between_its_fingers() -> None:
    scene = pressed(grip(12.0, 0.0), 12.0)
    # Semi-implicit Euler falls g h t/2 too far.
    assert heights(scene, "Euler", 50)[-1] == pytest.approx(-GRAVITY * 0.1 * 0.102 / 2, rel=1e-12)


@pytest.mark.parametrize("friction", [0.2, 0.4])
def test_a_body_falls_with_gravity_less_twice_the_friction(friction: float) -> None:
    """Within 5 %: MuJoCo's soft contacts push away fingers on which a body slips, which loosens them a little."""
    fallen = heights(pressed(grip(8.0, friction, finger=PAD), 8.0), "Euler:cone=elliptic", 250, 0.001)
    speeds = np.diff(fallen) / 0.001
    assert (speeds[-51] - speeds[-1]) / 0.05 == pytest.approx(GRAVITY - 2 * friction * 8.0, rel=0.05)


def test_the_script_of_a_run_prints_what_the_run_gives(tmp_path: Path) -> None:
    scene, method, steps = pressed(grip(12.0, 0.5), 12.0), Method.parse("Euler", 0.002), [0, 50, 50, 50]
    path = tmp_path / "script.py"
    path.write_text(adapter.script(scene, method, 0.3, 4), "utf-8")
    with redirect_stdout(io.StringIO()) as printed:
        runpy.run_path(str(path))
    expected = adapter.prepare([scene], method).advance(np.array(steps))[0]
    rows = [line.split(",")[-13:] for line in printed.getvalue().splitlines()[1:]]
    np.testing.assert_array_equal(np.array(rows, dtype=float).reshape(expected.shape), expected)


def test_a_run_has_the_creep_of_a_held_body_and_no_gain_of_energy() -> None:
    run = simulate(load("gripped-block-holds"), "mujoco", "Euler:cone=elliptic", 0.002)
    outcome = run.outcome
    assert isinstance(outcome, Completed)
    compared = Comparison(truth(load("gripped-block-holds"), outcome.trajectory.t), outcome.trajectory)
    slipped = outcome.trajectory.position[0, :, 2]
    assert creep(compared) == pytest.approx((slipped[100] - slipped[200]) / 1.0, rel=1e-9)
    assert energy_gain(compared) is None
