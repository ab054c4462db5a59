"""Bodies that touch in Rapier: they slide, roll, bounce and are pushed as in mechanics, and may fall asleep on a slope."""

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, Method, SceneUnsupported
from bodycheck.reference.scene import Plane
from tests.support import touching_engines as measured

RAPIER = registry.load("rapier")
METHODS = ("symplectic-euler", "symplectic-euler:settings=engine")


@pytest.mark.parametrize("method", METHODS)
def test_a_block_slides_and_a_ball_rolls_as_in_mechanics(method: str) -> None:
    # Single precision rounds a velocity of 2 m/s by 1e-7 in each of 1000 steps.
    assert measured.slide(RAPIER, method, 1e-3) == pytest.approx(1, abs=2e-3)
    speed, slip = measured.rolling_speed(RAPIER, method, 1e-3)
    # A step of 1 ms changes the velocity of a ball that slips by 5e-3 m/s.
    assert speed == pytest.approx(5 / 7, abs=5e-3)
    assert slip == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_bodies_at_rest_sink_into_soft_contacts_and_bear_their_weights(method: str) -> None:
    assert measured.sunk_at_rest(RAPIER, method, 1 / 240) < 2e-4
    loads = measured.loads_of_stack(RAPIER, method, 1 / 240)
    exact = {(index - 1, index): 10.0 - index for index in range(10)}
    assert loads == pytest.approx(exact, rel=0.02)  # the iterations do not converge


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("timestep", [1 / 60, 1e-3])
def test_a_ball_bounces_with_its_coefficient(method: str, timestep: float) -> None:
    assert measured.bounce(RAPIER, method, timestep) == pytest.approx(0.8, abs=1e-5)


def test_a_block_that_slides_slowly_falls_asleep_with_the_engines_settings() -> None:
    """Mechanics has it at 0.35 m after 4 s, with 0.18 m/s."""
    scene = load("block-slides-on-ramp").scene
    asleep = measured.states(RAPIER, scene, METHODS[1], 1 / 60, [120, 120])[:, 0]
    assert (asleep[0, :3] == asleep[1, :3]).all()
    assert not asleep[1, 7:].any()
    awake = measured.states(RAPIER, scene, METHODS[0], 1 / 60, [240])[-1, 0]
    assert np.linalg.norm(awake[7:10]) == pytest.approx(4 * 0.0442, rel=0.01)


@pytest.mark.parametrize("method", METHODS)
def test_a_push_acts_from_its_start_to_its_end_at_its_point(method: str) -> None:
    velocity = measured.pushed(RAPIER, method, 1e-3)
    assert velocity[0] == pytest.approx(0.2, rel=1e-3)
    assert velocity[4] == pytest.approx(1.0, rel=5e-3)


def test_a_brick_is_the_same_along_other_axes() -> None:
    # The order of the axes changes the order of the iterations; a brick turned by 90 degrees would differ by some 0.1.
    assert measured.differs_along_other_axes(RAPIER, "symplectic-euler", 0.005) < 1e-2


def test_what_rapier_is_given_instead_is_named() -> None:
    assert isinstance(RAPIER, ContactTerms)
    plain, block = Method.parse("symplectic-euler", 1e-3), load("block-slides-on-ramp").scene
    assert RAPIER.contact_terms(measured.ball(Plane(0.3, restitution=0.5)), plain) == ""
    law = "friction of a face as one force and one torque against its spin, with a bound each"
    assert RAPIER.contact_terms(block, plain) == law
    assert RAPIER.contact_terms(block, Method.parse("symplectic-euler:friction=coulomb", 1e-3)) == ""
    assert RAPIER.contact_terms(load("football-drag").scene, plain) == ""


def test_a_shape_that_rapier_lacks_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match="none of Rapier's shapes"):
        RAPIER.prepare([measured.ellipsoid()], Method.parse("symplectic-euler", 1e-3))


def test_a_sensor_reads_the_normal_force_of_contacts_on_a_ramp() -> None:
    given, exact = measured.read_on_ramp(RAPIER, "symplectic-euler", friction=False)
    assert given == pytest.approx(exact, abs=0.02 * measured.GRAVITY)
