"""Discrepancies: what is measured of a run held against the truth."""

import math
from dataclasses import replace

import pytest

from bodycheck import compare, load, simulate, truth
from bodycheck.reference.scene import State
from tests.support.cases import shortened


def test_drifts_of_what_is_zero_are_relative_to_the_kinetic_energy() -> None:
    case = shortened(load("projectile"), 1.0, 11)
    at_rest = replace(case, scene=replace(case.scene, initial=State(), gravity=10.0))
    # From rest at z = 0 the initial energy is 0; after 1 s of fall the kinetic energy is 50 J per kg.
    run = simulate(at_rest, "mujoco", "Euler", 0.1)
    maxima = compare(truth(at_rest), run).maxima()
    position = run.outcome.trajectory.position[-1, 2]
    assert maxima["energy_drift"] == pytest.approx(abs(50 + 10 * position) / 50, rel=1e-12, abs=0)
    assert maxima["angular_momentum_drift"] == 0
    assert not any(math.isnan(value) for value in maxima.values())
