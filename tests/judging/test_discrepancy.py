"""Discrepancies: what is measured of a run held against the truth."""

import math
from dataclasses import replace

import pytest

from bodycheck import compare, load, simulate, truth
from bodycheck.reference.scene import State, Vector
from tests.support.cases import shortened

#: A throw in every direction, with a spin.
THROW = shortened(load("football-no-spin"), 1.0, 11)
#: The same against drag.
BRAKED = shortened(load("football-drag"), 1.0, 11)


@pytest.mark.parametrize("name", ["energy_drift", "energy_error"])
@pytest.mark.parametrize("shift", [(0.0, 0.0, 1.0), (0.0, 0.0, -16.0), (3.0, -200.0, 1000.0)])
def test_energies_do_not_depend_on_where_the_origin_is(name: str, shift: Vector) -> None:
    case = THROW if name == "energy_drift" else BRAKED
    found = []
    for position in (State().position, shift):
        moved = replace(case, scene=replace(case.scene, initial=replace(case.scene.initial, position=position)))
        found.append(compare(truth(moved), simulate(moved, "mujoco", "Euler", 0.01)).maxima()[name])
    scene = case.scene
    kinetic = scene.body.mass * sum(part**2 for part in scene.initial.velocity) / 2
    # Each of 100 steps rounds the height to 2^-53 of at most 1020 m, and so does the truth.
    rounding = 101 * 2.0**-53 * 1020 * scene.body.mass * scene.gravity / kinetic
    assert found[0] > 1e4 * rounding
    assert found[1] == pytest.approx(found[0], rel=0, abs=rounding)


@pytest.mark.parametrize("height", [0.0, 128.0, -3.0])
def test_drifts_of_what_is_zero_are_relative_to_the_kinetic_energy(height: float) -> None:
    case = shortened(load("projectile"), 1.0, 11)
    at_rest = replace(case, scene=replace(case.scene, initial=State((0.0, 0.0, height)), gravity=10.0))
    # From rest the initial kinetic energy is 0; after 1 s of fall it is 50 J per kg.
    run = simulate(at_rest, "mujoco", "Euler", 0.1)
    maxima = compare(truth(at_rest), run).maxima()
    fallen = height - run.outcome.trajectory.position[-1, 2]
    # The height is rounded to 2^-53 of 128 m in each of ten steps.
    assert maxima["energy_drift"] == pytest.approx(abs(50 - 10 * fallen) / 50, rel=1e-12, abs=0)
    assert maxima["angular_momentum_drift"] == 0
    assert not any(math.isnan(value) for value in maxima.values())


def test_a_truth_of_another_case_is_refused() -> None:
    brick, other = shortened(load("free-brick"), 0.1, 3), shortened(load("intermediate-axis-flip"), 0.1, 3)
    run = simulate(brick, "mujoco", "Euler", 0.01)
    with pytest.raises(ValueError, match="another scene than the run, which is of the case 'free-brick'"):
        compare(truth(other), run)
    nudged = replace(brick, scene=replace(brick.scene, gravity=9.8))
    with pytest.raises(ValueError, match="another scene than the run"):
        compare(truth(nudged), run)
    assert compare(truth(replace(brick, samples=11)), run).maxima()["attitude_error"] < 0.1
