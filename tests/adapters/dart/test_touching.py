"""DART's contacts of bodies that roll, rest, slide down, bounce, are pushed and bear each other."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.dart import engine as dart
from bodycheck.adapters.dart.touching import of_bodies
from bodycheck.adapters.touching import plane_of
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.scene import Body, Brick, Ellipsoid, Plane, Push, Scene, State
from bodycheck.reference.trajectory import Array
from tests.support.sensed_scenes import after
from tests.support.touching import (
    BALL,
    CUBE,
    DOWNHILL,
    GRAVITY,
    INCLINE,
    MASS,
    OF_BALL,
    OF_CUBE,
    RADIUS,
    downhill,
    lying,
    on,
    several,
)

EULER = "semi-implicit-euler"
METHODS = (EULER, f"{EULER}:solver=nsgs", f"{EULER}:settings=engine")
STEP = 1e-3

#: A plane on which round bodies roll.
SLOPE = Plane(1.0, incline=INCLINE)


def states(scene: Scene | Mechanism, spelling: str, duration: float, timestep: float = STEP) -> Array:
    """States (n, bodies, 13) after every step."""
    strides = np.ones(round(duration / timestep), dtype=np.int64)
    return np.asarray(dart.prepare([scene], Method.parse(spelling, timestep)).advance(strides)[0])


@pytest.mark.parametrize("spelling", METHODS)
def test_round_bodies_roll_down(spelling: str) -> None:
    ball = states(on(SLOPE, OF_BALL), spelling, 1.0)[-1, 0]
    cylinder = states(lying(SLOPE), spelling, 1.0)[-1, 0]
    # DART's contacts yield by 1e-5 of the velocity that a step's forces change.
    assert downhill(ball) == pytest.approx(5 / 7 * DOWNHILL, rel=1e-4)
    assert downhill(cylinder) == pytest.approx(2 / 3 * DOWNHILL, rel=1e-4)


@pytest.mark.parametrize("spelling", METHODS)
def test_a_block_stays_where_friction_holds_it_and_slides_where_it_does_not(spelling: str) -> None:
    held = states(on(Plane(2 * math.tan(INCLINE), incline=INCLINE), OF_CUBE), spelling, 1.0)[-1, 0]
    assert abs(downhill(held)) < 1e-5
    slips = states(on(Plane(0.5 * math.tan(INCLINE), incline=INCLINE), OF_CUBE), spelling, 1.0)[-1, 0]
    # In the first steps the block may stand on two corners, until it has sunk onto all four.
    assert downhill(slips) == pytest.approx(DOWNHILL / 2, rel=2e-3)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_an_impact_returns_its_part_of_the_velocity(restitution: float) -> None:
    above = 0.5
    scene = on(Plane(0.5, restitution=restitution), OF_BALL, RADIUS + above)
    velocity = states(scene, EULER, 0.5)[:, 0, 9]
    (impact,) = np.flatnonzero((velocity[1:] > -1e-3) & (velocity[:-1] < -1.0))
    # DART returns the part of the velocity that the ball would have at the end of the step.
    assert velocity[impact + 1] == pytest.approx(restitution * -(velocity[impact] - GRAVITY * STEP), abs=1e-3)


def test_rebounds_below_a_tenth_of_a_metre_a_second_are_left_out() -> None:
    for speed, rebound in ((0.21, 0.105), (0.19, 0.0)):
        scene = replace(on(Plane(0.0, restitution=0.5), OF_BALL), gravity=0.0)
        seen = states(replace(scene, initial=replace(scene.initial, velocity=(0.0, 0.0, -speed))), EULER, 0.01)
        assert seen[-1, 0, 9] == pytest.approx(rebound, abs=1e-3)  # a penetration is removed at up to 1 mm/s


def test_pushes_accelerate_and_turn_between_their_instants() -> None:
    force, arm, begin, until = (3.0, -2.0, 0.0), (0.0, 0.05, 0.0), 0.2, 0.5
    floating = Scene(OF_BALL, State((0.0, 0.0, 5.0)), 0.0, Plane(0.5))
    push = Push(force, start=begin, end=until)
    central = states(replace(floating, pushes=(push,)), EULER, 0.8)
    assert central[199, 0, 7:10] == pytest.approx(0, abs=0)
    assert central[499, 0, 7:10] == pytest.approx(np.array(force) * (until - begin) / MASS, rel=1e-12)
    assert central[-1, 0, 7:10] == pytest.approx(central[499, 0, 7:10], rel=1e-14)
    beside = states(replace(floating, pushes=(replace(push, force=(3.0, 0.0, 0.0), point=arm),)), EULER, 0.8)
    # The first step turns a ball at rest by the whole torque, point x force, about -z.
    assert beside[200, 0, 12] == pytest.approx(-arm[1] * 3.0 * STEP / OF_BALL.moments[2], rel=1e-5)


def test_the_loads_of_a_stack_are_the_weights_above() -> None:
    stack = several([(CUBE, (0.0, 0.0, RADIUS * (2 * place + 1))) for place in range(3)], Plane(0.5))
    loads = dart.interface_loads(stack, Method.parse(EULER, STEP), 500)
    weight = MASS * GRAVITY
    mean = {pair: float(load[400:].mean()) for pair, load in loads.items()}
    assert mean == pytest.approx({(WORLD, 0): 3 * weight, (0, 1): 2 * weight, (1, 2): weight}, rel=1e-4)


def test_pairs_have_their_own_friction() -> None:
    blocks = [(CUBE, (0.0, y, RADIUS)) for y in (-1.0, 0.0, 1.0)]
    own = (PairContact((WORLD, 0), 0.0, 0.0), PairContact((WORLD, 2), 0.1, 0.0))
    scene = several(blocks, Plane(0.5 * math.tan(INCLINE), incline=INCLINE), contacts=own)
    third = 1 - 0.1 / math.tan(INCLINE)
    # As for one block.
    assert downhill(states(scene, EULER, 0.5)[-1]) == pytest.approx(np.array([1.0, 0.5, third]) * DOWNHILL * 0.5, rel=2e-3)


def test_coefficients_of_bodies_give_each_pair_its_own() -> None:
    """Three bodies have as many pairs as coefficients, and DART multiplies their coefficients of restitution."""
    scene = several(
        [(BALL, (0.0, 0.0, 1.0)), (BALL, (0.0, 0.0, 2.0))],
        Plane(0.3, restitution=0.5),
        contacts=(PairContact((0, 1), 0.6, 0.8), PairContact((WORLD, 1), 0.3, 0.4)),
    )
    frictions, restitutions = of_bodies(scene)
    assert np.minimum.outer(frictions, frictions)[[0, 0, 1], [1, 2, 2]] == pytest.approx([0.6, 0.3, 0.3], rel=1e-15)
    products = np.multiply.outer(restitutions, restitutions)
    assert products[[0, 0, 1], [1, 2, 2]] == pytest.approx([0.8, 0.5, 0.4], rel=1e-14)
    given = dart.contact_terms(scene, Method.parse(f"{EULER}:solver=nsgs", STEP))
    assert given == "restitution in rebounds from 0.1 m/s to 100 m/s alone"


def test_what_cannot_be_given_is_told() -> None:
    scene = several([(BALL, (0.0, y, RADIUS)) for y in (0.0, 1.0)], Plane(0.3), contacts=(PairContact((0, 1), 0.1, 0.0),))
    given = dart.contact_terms(scene, Method.parse(EULER, STEP))
    assert given.startswith("friction limited in each of two directions, along x and y, instead of by a cone; ")
    assert given.endswith("friction 0.3 instead of 0.1 between body-0 and body-1")
    oval = Scene(Body(1.0, (0.1, 0.1, 0.1), Ellipsoid((0.1, 0.1, 0.2))), State((0.0, 0.0, 1.0)), GRAVITY, Plane(0.5))
    with pytest.raises(SceneUnsupported, match="replaces by a small sphere"):
        dart.prepare([oval], Method.parse(f"{EULER}:detector=ode", STEP))


def test_a_brick_in_flight_above_its_plane_moves_as_one_without_a_plane() -> None:
    body = Body(1.0, (0.01, 0.02, 0.03), Brick((0.1, 0.2, 0.05)))
    flying = Scene(body, State((0.0, 0.0, 9.0), angular_velocity=(1.0, 2.0, 3.0)), GRAVITY)
    above = replace(flying, plane=Plane(0.5, incline=INCLINE))
    np.testing.assert_array_equal(states(above, EULER, 0.2), states(flying, EULER, 0.2))


def test_the_force_on_a_rolling_ball_is_that_of_its_acceleration() -> None:
    """Its weight less its acceleration down the ramp, 5/7 g sin a."""
    case = load("sensor-rolling-ball")
    assert isinstance(case.scene, Scene)
    (*_, force), _ = after(dart, case.scene, case.sensors, METHODS[0], 300)
    incline, weight = plane_of(case.scene).incline, case.scene.body.mass * GRAVITY
    down = 5 / 7 * weight * math.sin(incline)
    # Contacts yield by 1e-5 of what a step changes.
    assert force == pytest.approx([down * math.cos(incline), 0.0, weight - down * math.sin(incline)], abs=1e-4 * weight)
