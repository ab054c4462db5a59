"""What is special about DART: its order, the friction of its solvers, its sleeping, and how it overflows."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters.contract import EngineDiverged, Method, kind_of
from bodycheck.adapters.dart import engine as dart
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Body, Plane, Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth

INTEGRATOR = "semi-implicit-euler"
BRICK = load("sliding-brick").scene


def end(scene: Scene, method: str, timestep: float, steps: int) -> Array:
    return dart.prepare([scene], Method.parse(method, timestep)).advance(np.array([steps]))[0, 0, 0]


@pytest.mark.parametrize("case", ["osrf-boxes-complex", "football-drag"])
def test_the_error_is_proportional_to_the_time_step(case: str) -> None:
    scene = load(case).scene
    exact = truth(scene, np.array([0.0, 0.5])).trajectory
    errors = []
    for steps in (125, 250, 500):
        row = end(scene, INTEGRATOR, 0.5 / steps, steps)
        errors.append([np.linalg.norm(row[:3] - exact.position[-1]), geodesic_angle(row[3:7], exact.quaternion[-1])])
    # The next term of the error is smaller by the order of the step times the rate, 1 ms times 10/s.
    np.testing.assert_allclose(np.log2(errors[:-1]) - np.log2(errors[1:]), 1.0, atol=0.05)


def test_a_steady_spin_has_no_error_but_rounding() -> None:
    """Through many half turns, where the rotation vector that DART keeps changes its sign."""
    spin = 40.0
    body = Body(2.0, (0.3, 0.4, 0.5))
    row = end(Scene(body, State(angular_velocity=(0.0, spin, 0.0))), INTEGRATOR, 1e-3, 1000)
    # A rounding of 1e-16 of an angle of 3 rad in each of 1000 steps; near a half turn a vector loses some more digits.
    assert geodesic_angle(row[3:7], np.array([math.cos(spin / 2), 0.0, math.sin(spin / 2), 0.0])) < 1e-11


@pytest.mark.parametrize(
    ("solver", "ratio"), [("", math.sqrt(2)), (":solver=pgs", math.sqrt(2)), (":solver=nsgs", 1.0), (":solver=fbf", 1.0)]
)
def test_friction_oblique_to_the_axes_is_that_of_a_box_or_of_a_cone(solver: str, ratio: float) -> None:
    plane = BRICK.plane
    assert plane is not None
    scene = replace(BRICK, initial=replace(BRICK.initial, velocity=(math.sqrt(2), math.sqrt(2), 0.0)))
    row = end(scene, INTEGRATOR + solver, 1e-3, 100)
    lost = 2.0 - float(np.linalg.norm(row[7:10]))
    # The solvers stop at residuals of 1e-5 and 1e-3.
    assert lost / (plane.friction * scene.gravity * 0.1) == pytest.approx(ratio, rel=5e-3)


def test_only_the_engines_own_settings_let_a_slow_body_sleep() -> None:
    """Without friction, at half a millimetre in a second, which is below DART's threshold of 1 mm/s."""
    speed = 5e-4
    scene = replace(BRICK, initial=replace(BRICK.initial, velocity=(speed, 0.0, 0.0)), plane=Plane(friction=0.0))
    assert kind_of(scene) == "plane"
    assert end(scene, INTEGRATOR, 1e-3, 1500)[7] == pytest.approx(speed, rel=1e-9)
    assert end(scene, f"{INTEGRATOR}:settings=engine", 1e-3, 1500)[7] == 0.0


def test_an_overflow_is_a_divergence() -> None:
    scene = Scene(Body(2.0, (0.3, 0.4, 0.5)), State(angular_velocity=(100.0, 500.0, 20.0)))
    with pytest.raises(EngineDiverged, match="overflow at t = 0"):
        end(scene, INTEGRATOR, 0.1, 100)
