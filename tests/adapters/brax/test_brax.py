"""What the pipelines of Brax are."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.brax.engine import PIPELINES, TAKE
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.kinematics import geodesic_angle, rotate
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth

BRAX = registry.load("brax")
TUMBLING, DRAG, SLIDING = (load(name).scene for name in ("osrf-boxes-complex", "football-drag", "sliding-brick"))
STEPS = (4e-3, 2e-3, 1e-3)
DURATION = 0.4


def rows(method: str, timestep: float, scene: Scene, samples: int = 1) -> Array:
    """The states (samples, 13) at evenly spaced instants up to 0.4 s."""
    simulation = BRAX.prepare([scene], Method.parse(method, timestep))
    return np.array(simulation.advance(np.full(samples, round(DURATION / timestep / samples)))[0, :, 0])


def orders(errors: list[float]) -> Array:
    return np.log2(np.divide(errors[:-1], errors[1:]))


def test_generalized_is_of_first_order_on_a_tumbling_box() -> None:
    exact = truth(TUMBLING, np.array([0.0, DURATION])).trajectory
    ends = [rows("generalized", h, TUMBLING)[-1] for h in STEPS]
    rates = [float(np.linalg.norm(row[10:] - exact.angular_velocity[-1])) for row in ends]
    turns = [float(geodesic_angle(row[3:7], exact.quaternion[-1])) for row in ends]
    # The next power of the step is below a hundredth of the first one at 4 ms.
    np.testing.assert_allclose(orders(rates), 1, atol=0.05)
    np.testing.assert_allclose(orders(turns), 1, atol=0.05)


def test_spring_knows_no_gyroscopic_torque() -> None:
    """The angular velocity of a tumbling box stays as it was in the world frame, and its angular momentum does not."""
    seen = rows("spring", 1e-3, TUMBLING, samples=10)
    turning = rotate(seen[:, 3:7], seen[:, 10:])
    # A rate of 5 rad/s is turned to the body frame and back, with a few roundings.
    np.testing.assert_allclose(turning, np.tile(TUMBLING.initial.angular_velocity, (10, 1)), rtol=0, atol=1e-13)


def test_positional_loses_the_rate_that_it_takes_from_the_sine_of_half_a_turn() -> None:
    """A step turns by 2 atan(h w / 2) and finds the rate 2 sin(atan(h w / 2)) / h."""
    h, rate = 4e-3, float(np.linalg.norm(TUMBLING.initial.angular_velocity))
    found = np.linalg.norm(rows("positional", h, TUMBLING)[-1, 10:])
    for _ in range(round(DURATION / h)):
        rate /= np.hypot(1, h * rate / 2)
    # A rate is a difference of quaternions over the step: each of 100 steps adds a rounding error of 1e-16 over 4 ms.
    assert found == pytest.approx(rate, abs=1e-11)
    assert found < np.linalg.norm(TUMBLING.initial.angular_velocity) - 1e-3


@pytest.mark.parametrize("method", PIPELINES)
def test_drag_is_a_change_of_gravity_that_is_kept_for_a_step(method: str) -> None:
    exact = truth(DRAG, np.array([0.0, DURATION])).trajectory
    errors = [float(np.linalg.norm(rows(method, h, DRAG)[-1, 7:10] - exact.velocity[-1])) for h in STEPS]
    np.testing.assert_allclose(orders(errors), 1, atol=0.05)  # the next power of the step is below a hundredth


def test_scenes_of_one_kind_share_compiled_code() -> None:
    rows("spring", 1e-3, TUMBLING)
    before = TAKE["spring"].one._cache_size()
    body = replace(TUMBLING.body, mass=3.0, moments=(0.3, 0.4, 0.5))
    rows("spring", 2e-3, replace(TUMBLING, body=body, gravity=1.0))
    assert TAKE["spring"].one._cache_size() == before


def test_the_friction_of_positional_grows_with_the_mass_of_the_body() -> None:
    """It compares an impulse with a speed; `spring`, whose friction does not know the mass, brakes as Coulomb's law says."""
    slow, plane = {}, SLIDING.plane
    assert plane is not None
    for method in ("positional", "spring"):
        for mass in (0.1, 10.0):
            a, b, c = SLIDING.body.moments
            body = replace(SLIDING.body, mass=mass, moments=(mass * a, mass * b, mass * c))
            seen = rows(method, 1e-3, replace(SLIDING, body=body), samples=4)
            slow[method, mass] = (2.0 - float(np.linalg.norm(seen[0, 7:9]))) / (DURATION / 4)
    assert slow["positional", 10.0] > 50 * slow["positional", 0.1]  # a hundred times, but for the bounces of the body
    for mass in (0.1, 10.0):
        # In the first few steps the body sinks in, for which the impulses are larger: 2 % over 0.1 s.
        assert slow["spring", mass] == pytest.approx(plane.friction * SLIDING.gravity, rel=0.04)


def test_a_cylinder_on_a_plane_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match="Brax refuses the model: Cylinders of half-length"):
        BRAX.prepare([load("curling-disk").scene], Method.parse("spring", 1e-3))
