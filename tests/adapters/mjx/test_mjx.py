"""What the integrators of MJX are, and that its contacts are MuJoCo's."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mjx.compiled import check_precision
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth

MJX = registry.load("mjx")
TUMBLING, DRAG, SLIDING = (load(name).scene for name in ("osrf-boxes-complex", "football-drag", "sliding-brick"))
STEPS = (4e-3, 2e-3, 1e-3)
DURATION = 0.4


def end(method: str, timestep: float, scene: Scene = TUMBLING) -> Array:
    """The state (13,) after 0.4 s."""
    simulation = MJX.prepare([scene], Method.parse(method, timestep))
    return np.array(simulation.advance(np.array([round(DURATION / timestep)]))[0, 0, 0])


def orders(errors: list[float]) -> Array:
    return np.log2(np.divide(errors[:-1], errors[1:]))


@pytest.mark.parametrize(("method", "of_rates", "of_attitude"), [("Euler", 1, 1), ("RK4", 4, 2)])
def test_an_integrator_has_its_order_on_a_tumbling_box(method: str, of_rates: int, of_attitude: int) -> None:
    """RK4 is of fourth order in the rates, whose equations know nothing of the attitude, and of second in the attitude."""
    exact = truth(TUMBLING, np.array([0.0, DURATION])).trajectory
    ends = [end(method, h) for h in STEPS]
    rates = [float(np.linalg.norm(row[10:] - exact.angular_velocity[-1])) for row in ends]
    turns = [float(geodesic_angle(row[3:7], exact.quaternion[-1])) for row in ends]
    # The next power of the step changes an order by less than 0.1 at 4 ms, as it halves from one pair of steps to the next.
    np.testing.assert_allclose(orders(rates), of_rates, atol=0.2)
    np.testing.assert_allclose(orders(turns), of_attitude, atol=0.2)


def test_implicitfast_takes_the_steps_of_euler() -> None:
    # Both solve with the mass matrix, in another order of operations; a rounding grows little in 400 steps.
    np.testing.assert_allclose(end("implicitfast", 1e-3), end("Euler", 1e-3), rtol=0, atol=1e-10)


def test_the_force_of_drag_is_kept_for_a_step() -> None:
    """Therefore even RK4 is of first order in it."""
    exact = truth(DRAG, np.array([0.0, DURATION])).trajectory
    for method in ("Euler", "RK4"):
        errors = [float(np.linalg.norm(end(method, h, DRAG)[7:10] - exact.velocity[-1])) for h in STEPS]
        np.testing.assert_allclose(orders(errors), 1, atol=0.05)


@pytest.mark.parametrize("method", ["Euler", "Euler:cone=elliptic"])
def test_a_contact_is_that_of_mujoco(method: str) -> None:
    strides = np.full(20, 10)
    own, other = (
        registry.load(name).prepare([SLIDING], Method.parse(method, 1e-3)).advance(strides) for name in ("mjx", "mujoco")
    )
    # Both minimise one function to a tolerance of 1e-8 of their scale; the difference in 200 steps is some roundings of it.
    np.testing.assert_allclose(own, other, rtol=0, atol=1e-5)


def test_another_precision_of_the_process_is_refused() -> None:
    with pytest.raises(RuntimeError, match="JAX computes in float64 in this process, and mjx in float32"):
        check_precision(replace(MJX.engine, precision="float32"))
