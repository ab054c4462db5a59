"""Bodies between fingers by Pinocchio's rigid contacts."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.pinocchio import contact
from bodycheck.adapters.pinocchio import engine as adapter
from bodycheck.figures.contact import creep
from bodycheck.figures.definition import Comparison
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.scene import Cylinder
from bodycheck.reference.trajectory import Array
from bodycheck.results.outcome import Completed
from bodycheck.running.simulation import simulate
from bodycheck.running.truths import truth
from tests.support.grips import GRAVITY, PAD, grip

pytestmark = pytest.mark.skipif(not contact.HAS_POINT_CONTACTS, reason="this release has no point contacts")


def states(scene: Mechanism, press: float, steps: int, timestep: float = 0.002) -> Array:
    """The states (n, bodies, 13) after each step, with constant efforts in the place of controllers."""
    joints = tuple(replace(joint, effort=press) for joint in scene.joints)
    method = Method.parse("admm", timestep)
    simulation = adapter.prepare([replace(scene, joints=joints, controllers=())], method)
    return np.asarray(simulation.advance(np.ones(steps, dtype=np.int64))[0])


@pytest.mark.parametrize(("friction", "press"), [(0.0, 12.0), (0.2, 8.0), (0.4, 8.0)])
def test_a_body_falls_with_gravity_less_twice_the_friction(friction: float, press: float) -> None:
    speed = states(grip(press, friction), press, 25)[-1, 0, 9]
    # Rigid contacts at points: the tolerance is that of ADMM.
    assert speed == pytest.approx(-(GRAVITY - 2 * friction * press) * 0.05, rel=1e-6)


def test_fingers_stay_where_they_are_and_hold_the_body() -> None:
    seen = states(grip(12.0, 0.5, finger=PAD), 12.0, 25)
    assert np.abs(seen[-1, :, :3] - seen[0, :, :3]).max() < 1e-10


def test_a_shipped_body_that_is_held_does_not_creep() -> None:
    case = load("gripped-block-holds")
    outcome = simulate(case, "pinocchio", "admm", 0.01).outcome
    assert isinstance(outcome, Completed)
    crept = creep(Comparison(truth(case, outcome.trajectory.t), outcome.trajectory))
    assert crept is not None
    assert crept < 1e-10


def test_fingers_on_a_carriage_take_their_controllers() -> None:
    """The effort on the carriage is that of the weights: nothing moves."""
    scene = grip(12.0, 0.5, lift=2.8 * GRAVITY)
    simulation = adapter.prepare([scene], Method.parse("admm", 0.002))
    simulation.apply(np.array([12.0, 12.0, 2.8 * GRAVITY]))  # type: ignore[attr-defined]
    seen = simulation.advance(np.full(2, 10))[0]
    assert np.abs(seen[-1, :, 7:10]).max() < 1e-10


def test_a_cylinder_is_refused() -> None:
    scene = grip(12.0, 0.5)
    bodies = (replace(scene.bodies[0], shape=Cylinder(0.1, 0.1)), *scene.bodies[1:])
    with pytest.raises(SceneUnsupported, match="bricks and spheres alone"):
        adapter.prepare([replace(scene, bodies=bodies)], Method.parse("admm", 0.002))
