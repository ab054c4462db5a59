"""Newton's solvers: their orders, Newton's own damping, the friction of their contacts, and the replay of recorded steps."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.links import links_of
from bodycheck.adapters.newton import engine as adapter
from bodycheck.adapters.newton.solvers import SOLVERS
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from tests.support.orders import observed_order

NEWTON = registry.load("newton")
TUMBLING = Scene(Body(2.0, (0.3, 0.4, 0.6)), State(velocity=(0.0, 2.0, 1.0), angular_velocity=(6.0, 2.0, 4.0)), gravity=9.81)
SPINNING = replace(TUMBLING, initial=State(angular_velocity=(0.0, 0.0, 3.0)))
SLIDING = load("sliding-brick").scene


def rows(scene: Scene, spelling: str, timestep: float, strides: list[int]) -> Array:
    """The states (n, 13) of a scene after each of n strides."""
    return NEWTON.prepare([scene], Method.parse(spelling, timestep)).advance(np.array(strides))[0, :, 0]


@pytest.mark.parametrize("integrator", [name for name, own in SOLVERS.items() if "flight" in own.kinds])
def test_the_order_of_a_solver_in_flight(integrator: str) -> None:
    order = observed_order(NEWTON, TUMBLING, integrator, (0.016, 0.008, 0.004), 0.32)["attitude"]
    # MuJoCo's scheme of order 4 was one of order 2 before MuJoCo 4. The differences of 1e-4 rad that tell an order of 2 are a
    # thousand roundings of single precision; the next term of the error changes an order of 1 by less than the step, 0.016.
    assert order == pytest.approx(2 if integrator == "MuJoCo-rk4" else 1, abs=0.1)


@pytest.mark.parametrize(
    ("method", "damping"),
    [
        *(("SemiImplicit", 0.0), ("SemiImplicit:settings=engine", 0.05)),
        *(("Steel", 0.0), ("Steel:settings=engine", 0.05)),
        *(("Featherstone", 0.0), ("XPBD", 0.0), ("Kamino-euler", 0.0), ("MuJoCo-implicitfast", 0.0)),
    ],
)
def test_rotation_is_damped_by_newtons_own_settings_alone(method: str, damping: float) -> None:
    h, steps = 4e-3, 250
    last = rows(SPINNING, method, h, [steps])[0]
    # 250 steps with several roundings of 6e-8 each; damping takes away five percent.
    assert last[12] == pytest.approx(3.0 * (1 - damping * h) ** steps, rel=1e-4)


@pytest.mark.parametrize(("integrator", "order"), [("MuJoCo-rk4", 4), ("MuJoCo-euler", 1), ("Featherstone", 1)])
def test_the_order_against_drag_is_that_of_the_engine_where_it_evaluates_drag_itself(integrator: str, order: int) -> None:
    """MuJoCo's solvers have drag among their passive forces; for the others it is held through a step."""
    falling = replace(load("football-no-spin").scene, initial=State(velocity=(20.0, 3.0, 9.0)))
    if order == 4:  # errors at small steps are rounding, so that only the size of the error at a large step shows the order
        speeds = [np.linalg.norm(rows(falling, integrator, step, [round(1.6 / step)])[0, 7:10]) for step in (0.2, 0.01)]
        assert speeds[0] == pytest.approx(speeds[1], rel=1e-5)
    else:
        assert observed_order(NEWTON, falling, integrator, (0.2, 0.1, 0.05), 1.6)["position"] == pytest.approx(order, abs=0.1)


def test_vbd_slows_a_rotation_by_its_scheme() -> None:
    """Its angular velocity is smaller by (w h)^2 / 12 in each step: 1 / w^2 grows by h t / 6."""
    h, spin, duration = 8e-3, 10.0, 2.0
    scene = replace(SPINNING, initial=State(angular_velocity=(0.0, 0.0, spin)), gravity=0.0)
    last = rows(scene, "VBD", h, [round(duration / h)])[0]
    # The terms that are left out are smaller by (w h)^2; a step rounds the velocity by 1e-7 rad / h, of either sign.
    assert last[12] == pytest.approx(spin / np.sqrt(1 + spin**2 * h * duration / 6), rel=1e-3)


@pytest.mark.parametrize("integrator", list(SOLVERS))
def test_a_sliding_brick_is_slowed_by_mu_g(integrator: str) -> None:
    begin, end = rows(SLIDING, integrator, 1e-3, [150, 150])
    # Most contacts are soft, so that the brick is still settling: its load swings, by up to 6 % of the weight with MuJoCo's.
    assert (begin[7] - end[7]) / 0.15 == pytest.approx(0.5 * 9.81, rel=0.1)
    assert end[2] == pytest.approx(0.05, abs=2e-3)  # Newton's stiffness of 2500 N/m at each corner


@pytest.mark.parametrize("method", offers.offered(NEWTON.engine, SLIDING))
def test_a_replayed_step_is_a_step(method: str) -> None:
    """To the last bit, over several steps: no solver decides in Python what a later step computes."""
    parsed = Method.parse(method, 1e-3)
    links = links_of(SLIDING)
    model = adapter.built(links, SLIDING, parsed)
    state = model.state()
    step = adapter.stepper(SLIDING, parsed, SOLVERS[parsed.integrator], model, state, model.state())
    for _ in range(6):
        step()
    seen = np.concatenate([state.body_q.numpy()[0], state.body_qd.numpy()[0]], dtype=np.float64)
    stepped = adapter.rows(links[0], seen[None])[0]
    stepped[3:7] /= np.linalg.norm(stepped[3:7])
    np.testing.assert_array_equal(rows(SLIDING, method, 1e-3, [6])[0], stepped)


def test_kaminos_quaternions_drift_and_are_normalised() -> None:
    simulation = NEWTON.prepare([TUMBLING], Method.parse("Kamino-euler", 4e-3))
    quaternion = simulation.advance(np.array([250]))[0, 0, 0, 3:7]
    # 250 products of quaternions, each of which is rounded.
    assert 2e-7 < simulation.quaternion_norm_error < 250 * np.finfo(np.float32).eps
    assert np.linalg.norm(quaternion) == pytest.approx(1, abs=1e-15)
