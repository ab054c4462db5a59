"""Bodies that touch in Exudyn: they slide, roll, bounce, rest and are pushed, and its sensors read the forces of contacts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import ContactTerms, InterfaceLoads, Method, SceneUnsupported
from bodycheck.adapters.exudyn.contact import TIME_CONSTANT_S
from bodycheck.reference.mechanisms.mechanism import WORLD
from bodycheck.reference.scene import Plane
from tests.support import touching_engines as measured
from tests.support.sensor_readings import readings
from tests.support.touching import BALL, CUBE, GRAVITY, MASS, RADIUS, several

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
    assert isinstance(EXUDYN, InterfaceLoads)
    scene = several([(BALL, (0.0, 0.0, (2 * number + 1) * RADIUS)) for number in range(3)], Plane(0.5))
    loads = EXUDYN.interface_loads(scene, Method.parse("GeneralizedAlpha", 2e-3), 200)
    last = {pair: float(load_of_pair[-1]) for pair, load_of_pair in loads.items()}
    weight = MASS * GRAVITY
    # Critically damped contacts of three balls have settled to a thousandth after 0.4 s.
    assert last == pytest.approx({(WORLD, 0): 3 * weight, (0, 1): 2 * weight, (1, 2): weight}, rel=1e-3)


def test_a_sensor_reads_the_force_of_contacts_on_a_ramp() -> None:
    seen = readings(EXUDYN, "sensor-block-on-ramp", "GeneralizedAlpha", 0.002, 100)
    plane = load("sensor-block-on-ramp").scene.plane
    assert plane is not None
    along, weight = np.array([math.cos(plane.incline), 0.0, -math.sin(plane.incline)]), GRAVITY * math.cos(plane.incline)
    # The contact has settled, and friction has its coefficient while the block slides.
    assert seen.given["contact"][-1] == pytest.approx(
        weight * (np.array(plane.normal) - plane.friction * along), abs=1e-3 * GRAVITY
    )


def test_a_sensor_on_the_second_of_two_balls_reads_what_bears_it() -> None:
    """The force of a contact is on the first of its two balls, and the other one gets its opposite."""
    scene = several([(BALL, (0.0, 0.0, RADIUS)), (BALL, (0.0, 0.0, 3 * RADIUS))], Plane(0.5))
    case = replace(load("sensor-rolling-ball"), scene=scene)
    sensors = [replace(case.sensors[-1], name=f"on {body}", body=body) for body in (0, 1)]
    simulation = EXUDYN.prepare_sensing(scene, sensors, Method.parse("GeneralizedAlpha", 2e-3))  # type: ignore[attr-defined]
    simulation.simulation.advance(np.array([200]))
    weight = np.array([0.0, 0.0, MASS * GRAVITY])
    # Both balls are at rest, so that each has the force that bears its own weight.
    for force in simulation.read():
        assert force == pytest.approx(weight, abs=1e-3 * MASS * GRAVITY)


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
        EXUDYN.prepare(
            [several([(CUBE, (0.0, 0.0, RADIUS)), (BALL, (1.0, 0.0, RADIUS))], Plane(0.5))], Method.parse(METHODS[0], 1e-3)
        )
    with pytest.raises(SceneUnsupported, match="none of a body of the shape cylinder"):
        EXUDYN.prepare([load("falling-rod").scene], Method.parse(METHODS[0], 1e-3))


def test_a_fast_ball_does_not_fall_through_the_plane() -> None:
    """The contact of a sphere turns round where its centre passes the plane: a fast one must be stiff enough."""
    scene = measured.ball(Plane(0.3), position=measured.RADIUS + 20.0)
    heights = measured.states(EXUDYN, scene, METHODS[1], 1e-3, [1] * 2500)[:, 0, 2]
    assert heights.min() > measured.RADIUS / 2 - 1e-3
    assert heights[-1] == pytest.approx(measured.RADIUS, abs=1e-3)
    assert math.isfinite(heights[-1])
