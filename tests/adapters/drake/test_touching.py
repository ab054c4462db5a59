"""Drake's contacts of bodies that roll, rest, slide down, bounce, are pushed and bear each other."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.drake import engine as drake
from bodycheck.adapters.drake.touching import of_bodies
from bodycheck.adapters.pair_coefficients import dissipation
from bodycheck.adapters.stepping import Controlled
from bodycheck.adapters.touching import plane_of, touching_bodies
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.scene import Body, Cylinder, Plane, Push, Scene, State
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
    on,
    several,
)

METHODS = ("lagged", "cenic", "sap", "radau3")
STEP = 1e-3

#: A plane on which round bodies roll.
SLOPE = Plane(1.0, incline=INCLINE)


def states(scene: Scene | Mechanism, spelling: str, duration: float, timestep: float = STEP) -> Array:
    """States (n, bodies, 13) after every step."""
    strides = np.ones(round(duration / timestep), dtype=np.int64)
    return np.asarray(drake.prepare([scene], Method.parse(spelling, timestep)).advance(strides)[0])


@pytest.mark.parametrize("spelling", METHODS)
def test_a_ball_rolls_down(spelling: str) -> None:
    # The ball begins on the plane, and sinks in until its weight is borne, which takes some steps.
    assert downhill(states(on(SLOPE, OF_BALL), spelling, 0.5)[-1, 0]) == pytest.approx(5 / 14 * DOWNHILL, rel=1e-3)


@pytest.mark.parametrize("spelling", METHODS)
def test_a_block_stays_where_friction_holds_it_and_slides_where_it_does_not(spelling: str) -> None:
    held = states(on(Plane(2 * math.tan(INCLINE), incline=INCLINE), OF_CUBE), spelling, 0.5)[-1, 0]
    assert abs(downhill(held)) < 1e-3  # creep is of the size of Drake's stiction tolerance
    slips = states(on(Plane(0.5 * math.tan(INCLINE), incline=INCLINE), OF_CUBE), spelling, 0.5)[-1, 0]
    # As above; the convex sap also lifts a block that slides.
    assert downhill(slips) == pytest.approx(DOWNHILL / 4, rel=2e-2)


@pytest.mark.parametrize("spelling", ["lagged", "cenic"])
def test_regularised_friction_creeps_as_its_law_says(spelling: str) -> None:
    """At v = s r / sqrt(1 - r^2) for the part r of the friction that is needed, and the stiction tolerance s."""
    needed = 0.9
    held = states(on(Plane(math.tan(INCLINE) / needed, incline=INCLINE), OF_CUBE), spelling, 1.0)[-1, 0]
    # The friction of a step is that of its normal force before, and the contact still settles by thousandths.
    assert downhill(held) == pytest.approx(1e-4 * needed / math.sqrt(1 - needed**2), rel=1e-2)


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.8, 1.0])
def test_the_first_impact_returns_its_part_of_the_velocity(restitution: float) -> None:
    above, spelling = 0.5, "radau3"
    seen = states(on(Plane(0.5, restitution=restitution), OF_BALL, RADIUS + above), spelling, 0.36, 2e-4)[:, 0]
    first = int(np.argmax(seen[:, 9] > 0))
    leaves = first + int(np.argmax(seen[first:, 2] > RADIUS))
    # Gravity acts during the impact, and takes most from a slow rebound: 0.025 m/s from the slowest, at steps of 50 us too.
    assert seen[leaves, 9] == pytest.approx(restitution * math.sqrt(2 * GRAVITY * above), rel=2e-2, abs=0.03)


@pytest.mark.parametrize(("restitution", "speed"), [(0.02, 1.0), (0.5, 3.0), (0.999, 10.0)])
def test_the_dissipation_of_a_coefficient_is_that_of_an_impact(restitution: float, speed: float) -> None:
    """A spring of unit stiffness that pushes a unit mass with (1 + d x'), in small steps of the midpoint rule."""
    d, h = dissipation(restitution, speed), 2e-4
    x, v = 0.0, speed

    def force(x: float, v: float) -> float:
        return -x * max(1 + d * v, 0.0)

    while x >= 0:
        half = v + h / 2 * force(x, v)
        x, v = x + h * half, v + h * force(x + h / 2 * v, half)
    # Two terms of second order in the step.
    assert -v == pytest.approx(restitution * speed, rel=1e-3)


@pytest.mark.parametrize("spelling", ["lagged", "cenic", "cenic:accuracy=0.001"])
def test_pushes_accelerate_and_turn_between_their_instants(spelling: str) -> None:
    force, arm, begin, until = (3.0, -2.0, 0.0), (0.0, 0.05, 0.0), 0.2, 0.5
    floating = Scene(OF_BALL, State((0.0, 0.0, 5.0)), 0.0, Plane(0.5))
    push = Push(force, start=begin, end=until)
    times = np.array([0.2, 0.3, 0.5, 0.8])

    def ends(pushed: Push) -> Array:
        simulation = drake.prepare([replace(floating, pushes=(pushed,))], Method.parse(spelling, STEP))
        if isinstance(simulation, Controlled):
            return simulation.reach(times)[0, :, 0]
        return simulation.advance(np.diff(np.rint(times / STEP).astype(np.int64), prepend=0))[0, :, 0]

    central = ends(push)
    assert central[0, 7:10] == pytest.approx(0, abs=0)
    # cenic's solver stops at a tolerance of 1e-8.
    assert central[2:, 7:10] == pytest.approx(np.array(force)[None].repeat(2, 0) * (until - begin) / MASS, rel=1e-6)
    beside = ends(replace(push, force=(3.0, 0.0, 0.0), point=arm, end=0.3))
    # The point turns with the ball by a quarter, so that the torque is that of its arm across the force.
    spin = beside[1, 12]
    assert 0.5 < spin / (-arm[1] * 3.0 * 0.1 / OF_BALL.moments[2]) < 1.0
    assert beside[2, 12] == pytest.approx(spin, rel=1e-6)


@pytest.mark.parametrize("spelling", ["lagged", "lagged:contact=hydroelastic", "cenic"])
def test_the_loads_of_a_stack_are_the_weights_above(spelling: str) -> None:
    shapes = [(CUBE, (0.0, 0.0, RADIUS)), (CUBE, (0.0, 0.0, 3 * RADIUS)), (BALL, (0.0, 0.0, 5 * RADIUS))]
    loads = drake.interface_loads(several(shapes, Plane(0.5)), Method.parse(spelling, STEP), 500)
    weight = MASS * GRAVITY
    mean = {pair: float(load[400:].mean()) for pair, load in loads.items()}
    # Hydroelastic contacts still settle: the ball sinks by some tenths of a millimetre a second.
    assert mean == pytest.approx({(WORLD, 0): 3 * weight, (0, 1): 2 * weight, (1, 2): weight}, rel=5e-3)


def test_coefficients_of_bodies_give_each_pair_its_own() -> None:
    """Three bodies have as many pairs as coefficients, and Drake takes the harmonic mean."""
    scene = several(
        [(BALL, (0.0, 0.0, 1.0)), (BALL, (0.0, 0.0, 2.0))],
        Plane(0.3),
        contacts=(PairContact((0, 1), 0.4, 0.0), PairContact((WORLD, 1), 0.35, 0.0)),
    )
    frictions, dissipations = of_bodies(scene, touching_bodies(scene))
    means = [2 / (1 / frictions[one] + 1 / frictions[other]) for one, other in ((0, 1), (WORLD, 0), (WORLD, 1))]
    assert means == pytest.approx([0.4, 0.3, 0.35], rel=1e-14)
    assert dissipations == pytest.approx(dict.fromkeys((WORLD, 0, 1), 50.0), rel=1e-14)
    given = drake.contact_terms(scene, Method.parse("lagged", STEP))
    assert given == "friction that grows with the slip, with a stiction tolerance of 0.0001 m/s"


def test_what_cannot_be_given_is_told() -> None:
    scene = several([(BALL, (0.0, y, RADIUS)) for y in (0.0, 1.0)], Plane(0.0), contacts=(PairContact((0, 1), 0.1, 0.0),))
    given = drake.contact_terms(scene, Method.parse("sap", STEP))
    assert given == "friction that grows with the slip"
    bouncing = on(Plane(0.0, restitution=0.8), OF_BALL, 0.6)
    assert drake.contact_terms(bouncing, Method.parse("lagged", STEP)) == (
        "dissipation 0.119 s/m of Hunt and Crossley for the restitution 0.8 at 3.13 m/s"
    )
    assert drake.contact_terms(bouncing, Method.parse("sap", STEP)).startswith("no restitution")
    disk = Scene(Body(1.0, (0.1, 0.1, 0.1), Cylinder(0.1, 0.1)), State((0.0, 0.0, 1.0)), GRAVITY, Plane(0.5))
    with pytest.raises(SceneUnsupported, match="has points at corners"):
        drake.prepare([disk], Method.parse("lagged:contact=points", STEP))
    with pytest.raises(SceneUnsupported, match="points of other bricks"):
        drake.prepare(
            [several([(CUBE, (0.0, 0.0, 0.1)), (CUBE, (0.0, 0.0, 0.3))], Plane(0.5))], Method.parse("sap:contact=points", STEP)
        )


def test_the_force_on_a_rolling_ball_is_that_of_its_acceleration() -> None:
    """Its weight less its acceleration down the ramp, 5/7 g sin a."""
    case = load("sensor-rolling-ball")
    assert isinstance(case.scene, Scene)
    (*_, force), _ = after(drake, case.scene, case.sensors, METHODS[0], 300)
    incline, weight = plane_of(case.scene).incline, case.scene.body.mass * GRAVITY
    down = 5 / 7 * weight * math.sin(incline)
    # The contact still settles, and the slip that friction needs grows.
    assert force == pytest.approx([down * math.cos(incline), 0.0, weight - down * math.sin(incline)], abs=1e-3 * weight)
