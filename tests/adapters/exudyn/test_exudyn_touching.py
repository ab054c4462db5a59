"""Bodies that touch in Exudyn: they slide, roll, bounce, rest and are pushed, and its sensors read the forces of contacts."""

import math

import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, Method, SceneUnsupported
from bodycheck.adapters.exudyn.contact import TIME_CONSTANT_S
from bodycheck.reference.scene import Plane
from tests.support import touching_engines as measured
from tests.support.touching import GRAVITY

EXUDYN = registry.load("exudyn")
METHODS = ("GeneralizedAlpha", "GeneralizedAlpha:settings=engine", "TrapezoidalIndex2")


@pytest.mark.parametrize("method", METHODS)
def test_a_block_slides_and_a_ball_rolls_as_in_mechanics(method: str) -> None:
    # Newton's method ends at a relative error of 1e-8 in each step.
    assert measured.slide(EXUDYN, method, 2e-3) == pytest.approx(1, abs=1e-8)
    speed, slip = measured.rolling_speed(EXUDYN, method, 2e-3)
    # The slip decays below 1 mm/s, where friction is proportional to it.
    assert speed == pytest.approx(5 / 7, abs=1e-3)
    assert slip == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("method", METHODS)
def test_a_ball_at_rest_sinks_in_by_its_weight_over_the_stiffness(method: str) -> None:
    # Newton's method ends at a relative error of 1e-8.
    assert measured.sunk_at_rest(EXUDYN, method, 2e-3) == pytest.approx(GRAVITY * TIME_CONSTANT_S**2, rel=1e-6)


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.8, 1.0])
def test_a_ball_bounces_nearly_with_its_coefficient(restitution: float) -> None:
    # Impact model 2 is an approximation, and gravity acts during the impact.
    assert measured.bounce(EXUDYN, "GeneralizedAlpha", 2e-4, restitution) == pytest.approx(restitution, abs=0.02)


@pytest.mark.parametrize("method", METHODS)
def test_a_push_acts_from_its_start_to_its_end_at_its_point(method: str) -> None:
    velocity = measured.pushed(EXUDYN, method, 1e-3)
    # The implicit solvers carry accelerations over from step to step, so that each jump costs half a step at most.
    assert velocity[0] == pytest.approx(0.2, rel=5e-3)
    assert velocity[4] == pytest.approx(1.0, rel=5e-3)


def test_the_loads_of_balls_on_each_other_are_the_weights_above() -> None:
    # Critically damped contacts of three balls have settled to a thousandth after 0.4 s.
    for part in measured.loads_of_three_balls(EXUDYN, "GeneralizedAlpha", 2e-3, 200).values():
        assert part == pytest.approx(1, rel=1e-3)


def test_a_sensor_reads_the_force_of_contacts_on_a_ramp() -> None:
    # The contact has settled, and friction has its coefficient while the block slides.
    given, exact = measured.read_on_ramp(EXUDYN, "GeneralizedAlpha", friction=True)
    assert given == pytest.approx(exact, abs=1e-3 * GRAVITY)


def test_a_sensor_on_the_second_of_two_balls_reads_what_bears_it() -> None:
    """The force of a contact is on the first of its two balls, and the other one gets its opposite."""
    for force in measured.read_on_two_balls(EXUDYN, "GeneralizedAlpha", 2e-3, 200):
        assert force == pytest.approx([0, 0, 1], abs=1e-3)


def test_what_exudyn_is_given_instead_is_named() -> None:
    assert isinstance(EXUDYN, ContactTerms)
    plain = Method.parse("GeneralizedAlpha", 1e-3)
    given = EXUDYN.contact_terms(measured.ball(Plane(0.3, restitution=0.5)), plain)
    friction = "friction that is proportional to the velocity below 0.001 m/s"
    assert given == f"{friction}; restitution 0.5 as springs with the damping of impact model 2"
    block = EXUDYN.contact_terms(load("block-slides-on-ramp").scene, plain)
    assert block == f"{friction}; spheres of 0.01 m in the corners of body"
    assert EXUDYN.contact_terms(load("football-drag").scene, plain) == ""


def test_shapes_without_contacts_are_refused() -> None:
    with pytest.raises(SceneUnsupported, match="none of a body of the shape brick among several bodies"):
        EXUDYN.prepare([measured.cube_and_ball()], Method.parse(METHODS[0], 1e-3))
    with pytest.raises(SceneUnsupported, match="none of a body of the shape cylinder"):
        EXUDYN.prepare([load("falling-rod").scene], Method.parse(METHODS[0], 1e-3))


def test_a_fast_ball_does_not_fall_through_the_plane() -> None:
    """The contact of a sphere turns round where its centre passes the plane: a fast one must be stiff enough."""
    scene = measured.ball(Plane(0.3), position=measured.RADIUS + 20.0)
    heights = measured.states(EXUDYN, scene, METHODS[1], 1e-3, [1] * 2500)[:, 0, 2]
    assert heights.min() > measured.RADIUS / 2 - 1e-3
    assert heights[-1] == pytest.approx(measured.RADIUS, abs=1e-3)
    assert math.isfinite(heights[-1])
