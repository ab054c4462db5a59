"""Bodies that touch in PyBullet: they slide, roll, rest and are pushed as in mechanics, and bounce with an option."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, Method, SceneUnsupported
from bodycheck.reference.mechanisms.mechanism import PairContact
from bodycheck.reference.scene import Plane
from tests.support import touching_engines as measured
from tests.support.sensor_readings import readings
from tests.support.touching import BALL, RADIUS, several

PYBULLET = registry.load("pybullet")
SOLVERS = ("maximal", "multibody")

#: The options with which contacts act only when bodies touch, and add no velocity.
BOUNCING = "multibody:contactERP=0,contactProcessingThreshold=0"


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_block_slides_and_a_ball_rolls_as_in_mechanics(solver: str) -> None:
    # The solver stops its iterations at a residual; the friction is exact to some 1e-5.
    assert measured.slide(PYBULLET, solver, 1e-3) == pytest.approx(1, abs=1e-4)
    speed, slip = measured.rolling_speed(PYBULLET, solver, 1e-3)
    # A step of 1 ms changes the velocity of a ball that slips by 5e-3 m/s, and gravity sinks it by the slop of 1e-5 m at first.
    assert speed == pytest.approx(5 / 7, abs=5e-3)
    assert slip == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_bodies_at_rest_sink_by_the_slop_and_bear_their_weights(solver: str) -> None:
    assert measured.sunk_at_rest(PYBULLET, solver, 1 / 240) == pytest.approx(1e-5, rel=0.1)  # PyBullet's contactSlop
    loads = measured.loads_of_stack(PYBULLET, solver, 1 / 240)
    exact = {(index - 1, index): 10.0 - index for index in range(10)}
    assert loads == pytest.approx(exact, rel=1e-3)


def test_a_ball_keeps_its_coefficient_only_when_contacts_act_at_the_touch() -> None:
    """Contacts at a distance take the bounce away, and the correction of penetration adds to it."""
    assert measured.bounce(PYBULLET, "multibody", 1e-3) < 0.05
    assert measured.bounce(PYBULLET, "multibody", 2e-3) == pytest.approx(0.66, abs=0.01)
    # The velocity that bounces has the gravity of the step of the impact, 9.81 h / 3.1 of it.
    for timestep in (1e-3, 2.5e-4):
        assert measured.bounce(PYBULLET, BOUNCING, timestep) == pytest.approx(0.8, abs=1.1 * 9.81 * timestep / 3.1)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_push_acts_from_its_start_to_its_end_at_its_point(solver: str) -> None:
    velocity = measured.pushed(PYBULLET, solver, 1e-3)
    assert velocity[0] == pytest.approx(0.2, rel=1e-3)
    assert velocity[4] == pytest.approx(1.0, rel=5e-3)


def test_a_brick_is_the_same_along_other_axes() -> None:
    # The order of the axes changes the order of the iterations; a brick turned by 90 degrees would differ by some 0.1.
    assert measured.differs_along_other_axes(PYBULLET, "multibody", 1 / 240) < 1e-2


def test_what_bullet_is_given_instead_is_named() -> None:
    assert isinstance(PYBULLET, ContactTerms)
    plain, bouncing = Method.parse("multibody", 1e-3), measured.ball(Plane(0.3, restitution=0.5))
    assert PYBULLET.contact_terms(measured.ball(Plane(0.3)), plain) == ""
    assert PYBULLET.contact_terms(bouncing, plain) == "no restitution below 0.2 m/s"
    assert PYBULLET.contact_terms(bouncing, Method.parse("multibody:restitutionVelocityThreshold=0", 1e-3)) == ""
    assert PYBULLET.contact_terms(measured.ball(Plane(12.0)), plain) == "friction 10 instead of 12 of the plane and body"
    assert PYBULLET.contact_terms(load("football-drag").scene, plain) == ""


def test_a_shape_that_bullet_lacks_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match="none of Bullet's shapes"):
        PYBULLET.prepare([measured.ellipsoid()], Method.parse("multibody", 1e-3))


def test_a_sensor_reads_the_forces_of_contacts_on_a_ramp() -> None:
    """The list of contacts has the friction with the other sign, which does not change the size of the sum."""
    seen = readings(PYBULLET, "sensor-block-on-ramp", "multibody", 0.002, 100)
    size = 9.81 * math.cos(0.5) * math.hypot(1, 0.3)
    assert np.linalg.norm(seen.given["contact"][-1]) == pytest.approx(size, rel=1e-3)


@pytest.mark.parametrize("method", SOLVERS)
@pytest.mark.parametrize("coefficient", [2e-3, 1e-4])
def test_rolling_friction_decelerates_a_ball_by_its_coefficient(method: str, coefficient: float) -> None:
    # The iterations end at a residual, which is the larger part of a smaller friction.
    assert measured.rolling_deceleration(PYBULLET, method, 2e-3, coefficient) == pytest.approx(1, abs=1e-8)


def test_torsional_friction_brakes_a_spin_by_its_coefficient() -> None:
    assert measured.spin_deceleration(PYBULLET, "multibody", 2e-3, 3e-3) == pytest.approx(1, abs=1e-9)
    with pytest.raises(SceneUnsupported, match="maximal coordinates ignore it"):
        measured.spin_deceleration(PYBULLET, "maximal", 2e-3, 3e-3)


def test_the_bounds_of_rolling_friction_are_named() -> None:
    assert isinstance(PYBULLET, ContactTerms)
    one = replace(Plane(0.5, rolling_friction=2e-3), cone="one")
    bounds = "a bound of its own for friction, torsional friction, and rolling friction about each of two axes"
    for plane in (Plane(0.5, rolling_friction=2e-3), one):
        assert PYBULLET.contact_terms(measured.ball(plane), Method.parse("multibody", 1e-3)) == bounds
    two = several(
        [(BALL, (x, 0.0, RADIUS)) for x in (0.0, 1.0)],
        Plane(0.5, rolling_friction=2e-3),
        contacts=(PairContact((0, 1), 0.5, 0.0),),
    )
    given = PYBULLET.contact_terms(two, Method.parse("multibody", 1e-3))
    assert given == f"{bounds}; rolling friction 0.004 instead of 0 of body-0 and body-1"
    with pytest.raises(SceneUnsupported, match="without friction"):
        PYBULLET.prepare([measured.ball(Plane(0.0, rolling_friction=2e-3))], Method.parse("multibody", 1e-3))
