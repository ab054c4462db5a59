"""At t = 0 the truth of bodies that touch is the state of the file, with nothing but the rounding to doubles."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.figures.conservation import (
    angular_momentum,
    angular_momentum_size,
    rotational_energy,
    rotational_energy_size,
    total_energy,
)
from bodycheck.figures.definition import Comparison
from bodycheck.reference.bodies import initial, of_bodies
from bodycheck.reference.bounds import EPS
from bodycheck.reference.contact.truth import PRINTED_ROUNDINGS
from bodycheck.reference.observables import observe
from bodycheck.reference.scene import Scene
from bodycheck.reference.truth import truth

#: A case of every kind of motion of bodies that touch.
KINDS = (
    *("falling-rod", "ball-on-ramp", "dropped-ball", "rolling-coin-wobble", "block-slides-on-ramp"),
    *("dropped-brick-edge", "stack-of-ten", "simbenchmark-rolling"),
)


@pytest.mark.parametrize("name", KINDS)
def test_the_state_at_the_start_is_that_of_the_file(name: str) -> None:
    scene = load(name).scene
    found = truth(scene, np.array([0.0, 0.001]))
    begin, states = initial(scene), of_bodies(found.trajectory)
    assert (states.position[:, 0] == begin.position[:, 0]).all()
    assert (states.velocity[:, 0] == begin.velocity[:, 0]).all()
    assert (states.angular_velocity[:, 0] == begin.angular_velocity[:, 0]).all()
    same = np.abs((states.quaternion[:, 0] * begin.quaternion[:, 0]).sum(axis=-1))
    assert same == pytest.approx(1, abs=4 * EPS)  # up to the sign, and to the roundings of a unit quaternion
    speed = np.linalg.norm(begin.velocity, axis=-1).max()
    assert found.bounds.velocity_error[0] <= PRINTED_ROUNDINGS * EPS * speed


def test_figures_of_a_body_at_rest_are_not_divided_by_roundings() -> None:
    found = truth(load("falling-rod").scene, np.linspace(0.0, 0.2, 21))
    wrong = replace(found.trajectory, angular_velocity=found.trajectory.angular_velocity + 1e-3)
    compared = Comparison(found, wrong)
    for figure in (total_energy, rotational_energy, angular_momentum):
        assert 0 < np.max(figure(compared)) < 0.1  # the rod turns at 0.5 rad/s at the end
    scene = found.scene
    assert isinstance(scene, Scene)
    seen = observe(scene, found.trajectory)
    most = np.fmax.reduce(seen.kinetic_energy)
    assert rotational_energy_size(seen, found.bounds.angular_momentum_error[0]) == most
    # A rod that falls turns about its end: the rotation with the whole kinetic energy is the size of its angular momentum.
    size = angular_momentum_size(scene, seen, found.bounds.angular_momentum_error[0])
    assert size == pytest.approx(np.sqrt(2 * most * max(scene.body.moments)))


def test_a_size_below_its_own_bound_counts_as_zero() -> None:
    flown = truth(load("intermediate-axis-flip").scene, np.array([0.0, 1.0]))
    scene = flown.scene
    assert isinstance(scene, Scene)
    seen = observe(scene, flown.trajectory)
    momentum = float(np.linalg.norm(seen.angular_momentum[0]))
    most = np.fmax.reduce(seen.kinetic_energy)
    assert angular_momentum_size(scene, seen, momentum / 2) == momentum
    assert angular_momentum_size(scene, seen, momentum) == pytest.approx(np.sqrt(2 * most * max(scene.body.moments)))
    assert rotational_energy_size(seen, momentum / 2) == seen.rotational_energy[0]
    assert rotational_energy_size(seen, momentum) == most
