"""Bodies that touch in Simbody: they slide, roll, bounce, rest and are pushed, and sensors read the forces of contacts."""

import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, Method, SceneUnsupported
from bodycheck.adapters.simbody.contact import SINKING
from bodycheck.reference.scene import Plane
from tests.support import touching_engines as measured
from tests.support.touching import GRAVITY

SIMBODY = registry.load("simbody")
METHODS = ("RungeKuttaMerson", "RungeKutta3:settings=engine")


@pytest.mark.parametrize("method", METHODS)
def test_a_block_slides_and_a_ball_rolls_as_in_mechanics(method: str) -> None:
    # The block slides faster than the transition speed, from which on friction has its coefficient.
    assert measured.slide(SIMBODY, method, 2e-3) == pytest.approx(1, abs=1e-6)
    speed, slip = measured.rolling_speed(SIMBODY, method, 2e-3)
    # The slip decays below the transition speed, and the contact point of a ball that has sunk in is nearer to its centre.
    assert speed == pytest.approx(5 / 7, abs=5e-3)
    assert slip == pytest.approx(0, abs=1.5e-2)


@pytest.mark.parametrize("method", METHODS)
def test_a_ball_at_rest_sinks_in_by_its_part_of_the_radius(method: str) -> None:
    # Critically damped contact has settled to less than a thousandth after a second.
    assert measured.sunk_at_rest(SIMBODY, method, 2e-3) == pytest.approx(SINKING * measured.RADIUS, rel=1e-3)


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.8, 1.0])
def test_a_ball_bounces_nearly_with_its_coefficient(restitution: float) -> None:
    # Gravity acts during the impact, in which the ball sinks in by some centimetres.
    assert measured.bounce(SIMBODY, METHODS[0], 5e-4, restitution) == pytest.approx(restitution, abs=0.03)


@pytest.mark.parametrize("method", METHODS)
def test_a_push_acts_from_its_start_to_its_end_at_its_point(method: str) -> None:
    velocity = measured.pushed(SIMBODY, method, 1e-3)
    # The last stage of the step before a jump already has the force after it.
    assert velocity[0] == pytest.approx(0.2, rel=5e-3)
    assert velocity[4] == pytest.approx(1.0, rel=5e-3)


def test_the_loads_of_balls_on_each_other_are_the_weights_above() -> None:
    # Critically damped contacts of three balls have settled to a thousandth after 0.4 s.
    for part in measured.loads_of_three_balls(SIMBODY, METHODS[0], 2e-3, 200).values():
        assert part == pytest.approx(1, rel=1e-3)


def test_a_sensor_reads_the_force_of_contacts_on_a_ramp() -> None:
    # The contact has settled, and friction has its coefficient while the block slides.
    given, exact = measured.read_on_ramp(SIMBODY, METHODS[0], friction=True)
    assert given == pytest.approx(exact, abs=1e-3 * GRAVITY)


def test_a_sensor_on_the_second_of_two_balls_reads_what_bears_it() -> None:
    """The force of a contact is on the first of its two balls, and the other one gets its opposite."""
    # Friction below the transition speed is so stiff that it needs steps of less than 1 ms.
    for force in measured.read_on_two_balls(SIMBODY, METHODS[0], 5e-4, 800):
        assert force == pytest.approx([0, 0, 1], abs=1e-3)


def test_what_simbody_is_given_instead_is_named() -> None:
    assert isinstance(SIMBODY, ContactTerms)
    plain = Method.parse(METHODS[0], 1e-3)
    friction = "friction that grows with the slip up to 0.01 m/s"
    given = SIMBODY.contact_terms(measured.ball(Plane(0.3, restitution=0.5), measured.RADIUS + 0.5), plain)
    assert given == f"{friction}; dissipation 0.305 s/m of Hunt and Crossley for the restitution 0.5 at 3.13 m/s"
    block = SIMBODY.contact_terms(load("block-slides-on-ramp").scene, plain)
    assert block == f"{friction}; spheres of 0.005 m in the corners of body"
    assert SIMBODY.contact_terms(load("football-drag").scene, plain) == ""


def test_shapes_without_contacts_are_refused() -> None:
    with pytest.raises(SceneUnsupported, match="none of a body of the shape brick among several bodies"):
        SIMBODY.prepare([measured.cube_and_ball()], Method.parse(METHODS[0], 1e-3))
    with pytest.raises(SceneUnsupported, match="none of a body of the shape cylinder"):
        SIMBODY.prepare([load("falling-rod").scene], Method.parse(METHODS[0], 1e-3))
