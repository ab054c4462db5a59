"""Bodies that touch in SAPIEN: they slide, roll, rest and are pushed as in mechanics, and bounce above a threshold."""

import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, Method, SceneUnsupported
from bodycheck.reference.scene import Plane
from tests.support import touching_engines as measured

SAPIEN = registry.load("sapien")
SOLVERS = ("PGS", "TGS")


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_block_slides_and_a_ball_rolls_as_in_mechanics(solver: str) -> None:
    # Single precision rounds a velocity of 2 m/s by 1e-7 in each of 1000 steps.
    assert measured.slide(SAPIEN, solver, 1e-3) == pytest.approx(1, abs=2e-3)
    speed, slip = measured.rolling_speed(SAPIEN, solver, 1e-3)
    # A step of 1 ms changes the velocity of a ball that slips by 5e-3 m/s.
    assert speed == pytest.approx(5 / 7, abs=5e-3)
    assert slip == pytest.approx(0, abs=1e-4)


@pytest.mark.parametrize("solver", SOLVERS)
def test_bodies_at_rest_stay_and_bear_their_weights(solver: str) -> None:
    assert measured.sunk_at_rest(SAPIEN, solver, 0.01) < 1e-6
    loads = measured.loads_of_stack(SAPIEN, solver, 0.01)
    exact = {(index - 1, index): 10.0 - index for index in range(10)}
    assert loads == pytest.approx(exact, rel=0.02)  # ten iterations do not converge


@pytest.mark.parametrize("timestep", [1e-2, 1e-3])
def test_a_ball_bounces_with_its_coefficient_above_the_threshold(timestep: float) -> None:
    """The impact at 3.1 m/s is above the threshold of 2 m/s, and below one of 4 m/s."""
    # The velocity that bounces has the gravity of the step of the impact.
    assert measured.bounce(SAPIEN, "TGS", timestep) == pytest.approx(0.8, abs=1.1 * 9.81 * timestep / 3.1)
    assert measured.bounce(SAPIEN, "TGS:bounce_threshold=4", timestep) < 0.01


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_push_acts_from_its_start_to_its_end_at_its_point(solver: str) -> None:
    velocity = measured.pushed(SAPIEN, solver, 1e-3)
    assert velocity[0] == pytest.approx(0.2, rel=1e-3)
    assert velocity[4] == pytest.approx(1.0, rel=5e-3)


def test_a_brick_is_the_same_along_other_axes() -> None:
    # The order of the axes changes the order of the iterations; a brick turned by 90 degrees would differ by some 0.1.
    assert measured.differs_along_other_axes(SAPIEN, "TGS", 0.005) < 1e-2


def test_what_physx_is_given_instead_is_named() -> None:
    assert isinstance(SAPIEN, ContactTerms)
    plain, bouncing = Method.parse("TGS", 1e-3), measured.ball(Plane(0.3, restitution=0.5))
    assert SAPIEN.contact_terms(measured.ball(Plane(0.3)), plain) == ""
    assert SAPIEN.contact_terms(bouncing, plain) == "no restitution below 2 m/s"
    chosen = Method.parse("TGS:bounce_threshold=0.1", 1e-3)
    assert SAPIEN.contact_terms(bouncing, chosen) == "no restitution below 0.1 m/s"
    assert SAPIEN.contact_terms(load("football-drag").scene, plain) == ""


def test_a_shape_that_sapien_lacks_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match="none of SAPIEN's shapes"):
        SAPIEN.prepare([measured.ellipsoid()], Method.parse("TGS", 1e-3))


def test_a_sensor_reads_the_normal_force_of_contacts_on_a_ramp() -> None:
    given, exact = measured.read_on_ramp(SAPIEN, "TGS", friction=False)
    assert given == pytest.approx(exact, abs=0.02 * measured.GRAVITY)


def test_a_patch_brakes_a_spin_by_the_coefficient_of_torsional_friction() -> None:
    # Single precision rounds a spin of 10 rad/s by 1e-6 in each of 100 steps, of a change of 1.5 rad/s.
    assert measured.spin_deceleration(SAPIEN, "TGS", 2e-3, 3e-3) == pytest.approx(1, abs=1e-3)
    with pytest.raises(SceneUnsupported, match="PGS ignores"):
        measured.spin_deceleration(SAPIEN, "PGS", 2e-3, 3e-3)
    assert isinstance(SAPIEN, ContactTerms)
    given = SAPIEN.contact_terms(load("ball-spins-down").scene, Method.parse("TGS", 1e-3))
    assert given == "torsional friction of patches of 0.006 m"
