"""Bodies that roll, bounce, rest and are pushed in MuJoCo Warp move as in MuJoCo, to the rounding of single precision."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.contract import EngineDiverged, Method
from bodycheck.adapters.mujoco_warp import engine as adapter
from bodycheck.adapters.mujoco_warp import touching
from bodycheck.reference.mechanisms.mechanism import WORLD, PairContact
from bodycheck.reference.scene import Plane, Push, Scene, State
from tests.support import touching_engines as measured
from tests.support.touching import CUBE, DOWNHILL, GRAVITY, INCLINE, MASS, OF_BALL, OF_CUBE, RADIUS, downhill, on, several

MUJOCO = registry.load("mujoco")
EULER = Method.parse("Euler", 0.002)
STACK = several([(CUBE, (0.0, 0.0, RADIUS * (2 * place + 1))) for place in range(2)], Plane(0.5))


@pytest.mark.parametrize("spelling", ["Euler", "RK4", "Euler:cone=elliptic"])
def test_a_ball_that_bounces_down_a_ramp_and_is_pushed_beside_its_centre_moves_as_in_mujoco(spelling: str) -> None:
    pushes = (Push((1.0, 0.0, 0.0), end=0.1), Push((0.0, 2.0, 0.0), (0.05, 0.0, 0.0), 0.05, 0.2))
    thrown = State((0.0, 0.0, 0.2), velocity=(0.5, 0.0, -1.0), angular_velocity=(3.0, -20.0, 5.0))
    scene = Scene(OF_BALL, thrown, GRAVITY, Plane(0.4, incline=INCLINE), pushes=pushes)
    method, strides = Method.parse(spelling, 0.002), np.array([0, 20, 30, 30, 45, 75])
    own, other = (engine.prepare([scene], method).advance(strides) for engine in (adapter, MUJOCO))
    # Positions of 1 m have roundings of 6e-8. A contact turns them into errors of velocities by its stiffness and the step,
    # some 1e3/s, and there are a hundred steps in contact.
    np.testing.assert_allclose(own, other, rtol=0, atol=5e-3)


def test_blocks_with_a_friction_of_their_own_slide_by_it() -> None:
    blocks = [(CUBE, (0.0, y, RADIUS)) for y in (-1.0, 0.0, 1.0)]
    own = (PairContact((WORLD, 0), 0.0, 0.0), PairContact((WORLD, 2), 2.0, 0.0))
    scene = several(blocks, Plane(0.5 * math.tan(INCLINE), incline=INCLINE), contacts=own)
    seen = adapter.prepare([scene], EULER).advance(np.array([250]))[0, -1]
    # The middle one slides with the friction of the plane, within what convex friction does to it.
    assert downhill(seen) == pytest.approx(np.array([1.0, 0.5, 0.0]) * DOWNHILL * 0.5, rel=0.05, abs=1e-2)


def test_the_loads_of_a_stack_under_a_push_are_the_weights_above() -> None:
    pushed = replace(STACK, pushes=(Push((0.0, 0.0, -MASS * GRAVITY), body=1, start=0.5),))
    loads = adapter.interface_loads(pushed, EULER, 500)
    assert set(loads) == {(WORLD, 0), (0, 1)}
    weight = MASS * GRAVITY
    # The loads of soft contacts swing by less than a hundredth in the last tenths of a second.
    assert loads[WORLD, 0][200:250].mean() == pytest.approx(2 * weight, rel=1e-2)
    assert loads[0, 1][450:].mean() == pytest.approx(2 * weight, rel=1e-2)


def test_a_run_ends_where_contacts_are_dropped(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    """With memory for fewer contacts than a stack has when it has sunk into the plane."""
    monkeypatch.setattr(touching, "CONTACTS_OF_A_BODY", 2)
    falling = on(Plane(0.5), OF_CUBE, 1.05 * RADIUS)
    with pytest.raises(EngineDiverged, match="dropped contacts or constraints: NARROWPHASE"):
        adapter.prepare([falling], EULER).advance(np.array([100]))
    capfd.readouterr()  # MuJoCo Warp prints its warning


def test_rolling_friction_has_the_dimensions_and_the_coefficient_of_mujoco() -> None:
    plain, steep = Method.parse("Euler", 0.001), "Euler:cone=elliptic,impratio=100"
    # Contacts of six dimensions have nearly the whole coefficient with the elliptic cone and a large impratio.
    assert measured.rolling_deceleration(adapter, steep, 0.001, 2e-3) == pytest.approx(1, abs=0.01)
    given = adapter.contact_terms(measured.ball(Plane(0.5, rolling_friction=2e-3)), plain)
    assert given == (
        "soft friction in a pyramid of four sides; a pyramid of friction, torsional and rolling friction; "
        "torsional friction 1e-05 m"
    )
