"""Bodies that roll, bounce, rest and are pushed by the contacts of Newton's solvers MuJoCo and XPBD."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.newton import engine as adapter
from bodycheck.adapters.newton import touching
from bodycheck.reference.mechanisms.mechanism import WORLD, Mechanism, PairContact
from bodycheck.reference.scene import Plane, Push, Scene, State
from bodycheck.reference.trajectory import Array
from tests.support import touching_engines as measured
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

METHODS = ("XPBD:iterations=10", "MuJoCo-implicitfast")
BLOCKS = [(CUBE, (0.0, y, RADIUS)) for y in (-1.0, 0.0, 1.0)]
OWN = (PairContact((WORLD, 0), 0.0, 0.0), PairContact((WORLD, 2), 2.0, 0.0))


def states(scene: Scene | Mechanism, spelling: str, steps: int, timestep: float = 0.002) -> Array:
    """States (n, bodies, 13) after every step."""
    strides = np.ones(steps, dtype=np.int64)
    return np.asarray(adapter.prepare([scene], Method.parse(spelling, timestep)).advance(strides)[0])


@pytest.mark.parametrize("spelling", METHODS)
def test_round_bodies_roll_down_and_blocks_slide_or_stay(spelling: str) -> None:
    slope = Plane(1.0, incline=INCLINE)
    ball = several([(BALL, (0.0, 0.0, RADIUS))], slope)
    # The contact point of the ball creeps by less than a hundredth of the speed. XPBD divides the corrections of a cylinder by
    # the number of its contacts, so that its iterations end before they hold it.
    for scene, part, tolerance in ((ball, 5 / 7, 1e-2), (lying(slope), 2 / 3, 0.05)):
        assert downhill(states(scene, spelling, 250)[-1, 0]) == pytest.approx(part * DOWNHILL / 2, rel=tolerance)
    for times, share in ((0.0, 1.0), (0.5, 0.5), (2.0, 0.0)):
        block = on(Plane(times * math.tan(INCLINE), incline=INCLINE), OF_CUBE)
        # MuJoCo's convex friction lifts a block that slides; creep is what a figure tells.
        assert downhill(states(block, spelling, 250)[-1, 0]) == pytest.approx(share * DOWNHILL / 2, rel=0.05, abs=1e-2)


def test_a_ball_moves_in_the_solver_mujoco_as_in_mujoco() -> None:
    pushes = (Push((1.0, 0.0, 0.0), end=0.1), Push((0.0, 2.0, 0.0), (0.05, 0.0, 0.0), 0.05, 0.2))
    thrown = State((0.0, 0.0, 0.2), velocity=(0.5, 0.0, -1.0), angular_velocity=(3.0, -20.0, 5.0))
    scene = Scene(OF_BALL, thrown, GRAVITY, Plane(0.4, incline=INCLINE), pushes=pushes)
    own = states(scene, "MuJoCo-implicitfast", 200)
    other = registry.load("mujoco").prepare([scene], Method.parse("implicitfast", 0.002)).advance(np.ones(200, dtype=np.int64))
    # Positions of 1 m have roundings of 6e-8. A contact turns them into errors of velocities by its stiffness and the step,
    # some 1e3/s, and there are a hundred steps in contact.
    np.testing.assert_allclose(own, other[0], rtol=0, atol=5e-3)


def test_xpbd_rebounds_with_the_restitution_above_its_threshold() -> None:
    """A ball falls by `height`; below an impact of two steps of gravity it does not rebound."""
    for height, wanted in ((0.5, 0.8), (5e-5, 0.0)):
        scene = on(Plane(0.0, restitution=0.8), OF_BALL, RADIUS + height)
        speeds = states(scene, "XPBD:iterations=10", round(1.3 * math.sqrt(2 * height / GRAVITY) / 0.002) + 5)[:, 0, 9]
        # The impact is in the step before the rebound, in which gravity still acts.
        assert -speeds.max(initial=0.0) / speeds.min() == pytest.approx(wanted, abs=0.02)
    assert adapter.contact_terms(scene, Method.parse("XPBD", 0.002)).startswith("restitution above 0.0392 m/s")


@pytest.mark.parametrize("spelling", METHODS)
def test_pushes_accelerate_and_turn_between_their_instants(spelling: str) -> None:
    floating = Scene(OF_BALL, State((0.0, 0.0, 5.0)), 0.0, Plane(0.5))
    push = Push((3.0, 0.0, 0.0), (0.0, 0.05, 0.0), 0.2, 0.5)
    seen = states(replace(floating, pushes=(push,)), spelling, 300)[:, 0]
    assert seen[99, 7:] == pytest.approx(0, abs=0)
    # A hundred roundings of single precision.
    assert seen[[249, 299], 7] == pytest.approx([3.0 * 0.3 / MASS] * 2, rel=1e-5)
    assert seen[100, 12] == pytest.approx(-0.05 * 3.0 * 0.002 / OF_BALL.moments[2], rel=1e-4)


def test_mujocos_pairs_have_their_own_friction() -> None:
    scene = several(BLOCKS, Plane(0.5 * math.tan(INCLINE), incline=INCLINE), contacts=OWN)
    seen = states(scene, "MuJoCo-implicitfast", 250)[-1]
    assert downhill(seen) == pytest.approx(np.array([1.0, 0.5, 0.0]) * DOWNHILL * 0.5, rel=0.05, abs=1e-2)


def test_xpbd_has_the_coefficients_of_pairs_as_means() -> None:
    method = Method.parse("XPBD", 0.002)
    means = (PairContact((WORLD, 0), 0.4, 0.0, 0.002, 0.001), PairContact((WORLD, 1), 0.6, 0.0, 0.004, 0.003))
    two = several(
        [(BALL, (0.0, y, RADIUS)) for y in (-1.0, 1.0)],
        Plane(0.5, rolling_friction=0.003, torsional_friction=0.002),
        contacts=means,
    )
    # The pairs are (plane, 0), (plane, 1) and (0, 1), in the last of which are the coefficients of the plane.
    given = [(law.friction, law.rolling_friction, law.torsional_friction) for law in touching.materials_of(two, 2, method)]
    assert np.array(given) == pytest.approx(np.array([[0.5, 0.003, 0.002], [0.3, 0.001, 0.0], [0.7, 0.005, 0.004]]), abs=1e-12)
    assert adapter.contact_terms(two, method) == ""
    # Three bodies have three pairs with the plane, but the friction of no body is negative.
    third = several(BLOCKS, Plane(0.5), contacts=OWN)
    assert "instead of" in adapter.contact_terms(third, method)


@pytest.mark.parametrize("coefficient", [2e-3, 1e-4])
@pytest.mark.parametrize("method", ["XPBD:iterations=10", "MuJoCo-implicitfast:cone=elliptic,impratio=100"])
def test_rolling_friction_decelerates_a_ball_by_its_coefficient(method: str, coefficient: float) -> None:
    # Single precision rounds a speed of 1 m/s by 6e-8 in each of 200 steps, of a change of 1.4e-3 m/s for the smaller one.
    assert measured.rolling_deceleration(adapter, method, 1e-3, coefficient) == pytest.approx(1, abs=0.03)


@pytest.mark.parametrize("method", ["XPBD:iterations=10", "MuJoCo-implicitfast"])
def test_torsional_friction_brakes_a_spin_by_its_coefficient(method: str) -> None:
    # MuJoCo's soft contact has a few thousandths more.
    assert measured.spin_deceleration(adapter, method, 1e-3, 3e-3) == pytest.approx(1, abs=5e-3)


def test_the_loads_of_a_stack_are_the_weights_above() -> None:
    """In the solver MuJoCo; Newton calls the loads of XPBD approximate."""
    stack = several([(CUBE, (0.0, 0.0, RADIUS * (2 * place + 1))) for place in range(2)], Plane(0.5))
    loads = adapter.interface_loads(stack, Method.parse("MuJoCo-implicitfast", 0.002), 300)
    weight = MASS * GRAVITY
    # The loads of soft contacts swing by less than a hundredth in the last tenths of a second.
    assert loads[WORLD, 0][200:].mean() == pytest.approx(2 * weight, rel=1e-2)
    assert loads[0, 1][200:].mean() == pytest.approx(weight, rel=1e-2)


def test_other_solvers_say_why_they_have_no_bodies_that_touch() -> None:
    scene = on(Plane(0.5), OF_BALL)
    for integrator in adapter.engine.integrators:
        lacking = offers.not_offered(adapter.engine, scene, Method.parse(integrator.name, 0.002))
        offered = integrator.name == "XPBD" or integrator.name.startswith("MuJoCo")
        assert (lacking is None) == offered, integrator.name
