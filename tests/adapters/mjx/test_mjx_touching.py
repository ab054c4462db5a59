"""Bodies that roll, bounce, rest and are pushed in MJX move as in MuJoCo, whose model MJX reads."""

import math

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mjx import engine as adapter
from bodycheck.reference.mechanisms.mechanism import WORLD, PairContact
from bodycheck.reference.scene import Plane, Push, Scene, State
from tests.support import touching_engines as measured
from tests.support.touching import CUBE, DOWNHILL, GRAVITY, INCLINE, MASS, OF_BALL, RADIUS, downhill, on, several

MUJOCO = registry.load("mujoco")
EULER = Method.parse("Euler", 0.002)


def test_a_ball_that_bounces_down_a_ramp_and_is_pushed_beside_its_centre_moves_as_in_mujoco() -> None:
    pushes = (Push((1.0, 0.0, 0.0), end=0.1), Push((0.0, 2.0, 0.0), (0.05, 0.0, 0.0), 0.05, 0.2))
    thrown = State((0.0, 0.0, 0.2), velocity=(0.5, 0.0, -1.0), angular_velocity=(3.0, -20.0, 5.0))
    scene = Scene(OF_BALL, thrown, GRAVITY, Plane(0.4, incline=INCLINE), pushes=pushes)
    strides = np.array([0, 20, 30, 30, 45, 75])
    own, other = (engine.prepare([scene], EULER).advance(strides) for engine in (adapter, MUJOCO))
    # The impacts of soft contacts multiply the rounding errors of the two solvers.
    np.testing.assert_allclose(own, other, rtol=0, atol=1e-7)


def test_blocks_with_a_friction_of_their_own_slide_by_it() -> None:
    blocks = [(CUBE, (0.0, y, RADIUS)) for y in (-1.0, 0.0, 1.0)]
    own = (PairContact((WORLD, 0), 0.0, 0.0), PairContact((WORLD, 2), 2.0, 0.0))
    scene = several(blocks, Plane(0.5 * math.tan(INCLINE), incline=INCLINE), contacts=own)
    seen = adapter.prepare([scene], EULER).advance(np.array([250]))[0, -1]
    # The middle one slides with the friction of the plane, within what convex friction does to it.
    assert downhill(seen) == pytest.approx(np.array([1.0, 0.5, 0.0]) * DOWNHILL * 0.5, rel=0.05, abs=1e-2)


@pytest.mark.parametrize("spelling", ["Euler", "Euler:cone=elliptic"])
def test_the_load_under_a_push_is_the_weight_and_the_push(spelling: str) -> None:
    weight = MASS * GRAVITY
    pushed = on(Plane(0.5), OF_BALL, pushes=(Push((0.0, 0.0, -weight), start=0.5),))
    (load,) = adapter.interface_loads(pushed, Method.parse(spelling, 0.002), 500).values()
    # The loads of soft contacts swing by less than a hundredth in the last tenths of a second.
    assert load[[249, 499]] == pytest.approx([weight, 2 * weight], rel=1e-2)


def test_rolling_friction_has_the_dimensions_and_the_coefficient_of_mujoco() -> None:
    plain, steep = Method.parse("Euler", 0.001), "Euler:cone=elliptic,impratio=100"
    # Contacts of six dimensions have nearly the whole coefficient with the elliptic cone and a large impratio.
    assert measured.rolling_deceleration(adapter, steep, 0.001, 2e-3) == pytest.approx(1, abs=0.01)
    given = adapter.contact_terms(measured.ball(Plane(0.5, rolling_friction=2e-3)), plain)
    assert given == (
        "soft friction in a pyramid of four sides; a pyramid of friction, torsional and rolling friction; "
        "torsional friction 1e-05 m"
    )
