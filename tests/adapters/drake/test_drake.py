"""What is special about Drake: orders of its integrators, norms of its quaternions, half steps, and its contacts."""

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.trajectory import Array
from tests.support.orders import observed_order

DRAKE = registry.load("drake")
BRICK = Brick((0.1, 0.2, 0.05))
BODY = Body(1.0, principal_moments(BRICK, 1.0), BRICK)
TUMBLE = Scene(BODY, State(velocity=(1.0, 2.0, 3.0), angular_velocity=(3.0, 2.0, 1.0)), gravity=9.81)
SPEED, FRICTION, GRAVITY = 2.0, 0.5, 9.81
SLIDE = Scene(BODY, State((0.0, 0.0, 0.05), velocity=(SPEED, 0.0, 0.0)), GRAVITY, Plane(FRICTION))


def after(scene: Scene, spelling: str, timestep: float, steps: int) -> Array:
    """The state (13,) after so many steps."""
    return DRAKE.prepare([scene], Method.parse(spelling, timestep)).advance(np.array([steps]))[0, 0, 0]


@pytest.mark.parametrize("spelling", offers.offered(DRAKE.engine, TUMBLE))
def test_an_integrator_has_the_order_that_is_claimed(spelling: str) -> None:
    claimed = next(own.order for own in DRAKE.engine.integrators if own.name == spelling)
    observed = observed_order(DRAKE, TUMBLE, spelling, (0.02, 0.01, 0.005), 1.0)["attitude"]
    # The next term of the error changes the order by about the step times a rate: 10 ms times a few rad/s.
    assert observed == pytest.approx(claimed, abs=0.15)


def test_the_norm_of_a_quaternion_is_that_of_explicit_euler() -> None:
    """A step adds h/2 w q, which is perpendicular to q: the norm grows by sqrt(1 + (h w / 2)^2), and no velocity with it."""
    spin, timestep, steps = 20.0, 5e-3, 400
    initial = State((0.0, 0.0, 0.0), (0.6, 0.8, 0.0, 0.0), angular_velocity=(0.0, 0.0, spin))
    simulation = DRAKE.prepare([Scene(BODY, initial)], Method.parse("explicit_euler", timestep))
    row = simulation.advance(np.array([steps]))[0, 0, 0]
    expected = (1 + (timestep * spin / 2) ** 2) ** (steps / 2) - 1
    assert expected > 0.5
    # Rounding: 400 steps of some operations.
    assert simulation.quaternion_norm_error == pytest.approx(expected, rel=1e-12)
    assert np.linalg.norm(row[3:7]) == pytest.approx(1, abs=1e-15)
    np.testing.assert_allclose(row[10:], (0.0, 0.0, spin), rtol=0, atol=1e-11)


@pytest.mark.parametrize("spelling", ["runge_kutta3", "radau3"])
def test_steps_are_neither_divided_nor_added(spelling: str) -> None:
    """A step that rounding makes longer than the time step is one step."""
    from bodycheck.adapters.drake.engine import APPROXIMATIONS, loop
    from bodycheck.adapters.drake.models import build

    model = build(TUMBLE, Method.parse(spelling, 1e-3), APPROXIMATIONS)
    loop(model, 1e-3).advance(np.array([700, 300]))
    integrator = model.simulator.get_integrator()
    assert integrator.get_num_steps_taken() == 1000
    assert integrator.get_num_substep_failures() == 0


@pytest.mark.parametrize("spelling", ["implicit_euler", "velocity_implicit_euler"])
def test_implicit_euler_takes_two_half_steps(spelling: str) -> None:
    """Radau of one stage is implicit Euler too, but in whole steps."""
    halves, wholes = after(TUMBLE, spelling, 2e-3, 100), after(TUMBLE, "radau1", 1e-3, 200)
    # Newton's method stops at a residual of 1e-5 of a step's change, which is 1e-2; the error of a scheme is 100 times this.
    np.testing.assert_allclose(halves, wholes, rtol=0, atol=1e-5)
    assert np.abs(after(TUMBLE, "radau1", 2e-3, 100) - wholes).max() > 1e-3


@pytest.mark.parametrize(("spelling", "points", "surfaces"), [("contact=points", 4, 0), ("settings=engine", 1, 0), ("", 0, 1)])
def test_a_brick_touches_the_plane_as_the_options_say(spelling: str, points: int, surfaces: int) -> None:
    from bodycheck.adapters.drake.engine import APPROXIMATIONS, loop
    from bodycheck.adapters.drake.models import build

    model = build(SLIDE, Method.parse(f"lagged:{spelling}" if spelling else "lagged", 1e-3), APPROXIMATIONS)
    loop(model, 1e-3).advance(np.array([5]))
    found = model.plant.get_contact_results_output_port().Eval(model.context)
    assert (found.num_point_pair_contacts(), found.num_hydroelastic_contacts()) == (points, surfaces)


@pytest.mark.parametrize("spelling", ["lagged", "lagged:contact=points"])
def test_a_slide_ends_where_semi_implicit_euler_ends_it_one_step_late(spelling: str) -> None:
    """At v0^2 / (2 mu g) + v0 h / 2.

    The velocity at the end of a step moves the body through it, which takes v0 h / 2 away. `lagged` computes friction with the
    normal force of the step before; before the first step the body only just touches, so that v0 h is added.
    """
    timestep = 1e-3
    expected = SPEED**2 / (2 * FRICTION * GRAVITY) + SPEED * timestep / 2
    # While the body settles, the load is not yet the weight: some hundredths of a step's way.
    assert after(SLIDE, spelling, timestep, 600)[0] == pytest.approx(expected, abs=5e-5)


@pytest.mark.parametrize(("spelling", "thrown"), [("lagged", False), ("similar", True), ("sap", True)])
def test_convex_contact_throws_a_sliding_body_up(spelling: str, thrown: bool) -> None:
    method = Method.parse(f"{spelling}:contact=points", 1e-3)
    top = DRAKE.prepare([SLIDE], method).advance(np.ones(300, np.int64))[0, :, 0, 2].max() - 0.05
    # By centimetres, or not at all but for rounding.
    assert top > 0.01 if thrown else top < 1e-12
