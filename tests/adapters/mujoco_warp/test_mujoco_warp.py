"""MuJoCo Warp takes MuJoCo's steps, in single precision."""

import numpy as np
import pytest

from bodycheck import load
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.mujoco_warp import engine as adapter
from bodycheck.reference.scene import Body, Scene, State
from tests.support.orders import observed_order

mujoco_warp = pytest.importorskip("mujoco_warp")

MUJOCO, ENGINE = registry.load("mujoco"), adapter.engine
STRIDES = np.array([0, 50, 50, 100])
EPS = float(np.finfo(np.float32).eps)
CASES = ("osrf-boxes-complex", "football-drag", "sliding-brick")


@pytest.mark.parametrize(
    ("case", "spelling"), [(case, method) for case in CASES for method in offers.offered(ENGINE, load(case).scene)]
)
def test_its_states_are_those_of_mujoco(case: str, spelling: str, capfd: pytest.CaptureFixture[str]) -> None:
    """To the rounding of single precision, in flight, with drag and with friction; and nothing is printed."""
    scene, method = load(case).scene, Method.parse(spelling, 1e-3)
    single = adapter.prepare([scene], method).advance(STRIDES)[0, :, 0]
    assert capfd.readouterr() == ("", "")
    double = MUJOCO.prepare([scene], method).advance(STRIDES)[0, :, 0]
    # One rounding in each step of the largest number there is; a term that is missing in the forces has far more effect. The
    # stiffness of a contact turns the rounding of a position into a larger one of a velocity.
    roundings = STRIDES.sum() * EPS * (10 if scene.plane else 1)
    for part in (slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)):
        np.testing.assert_allclose(
            single[:, part], double[:, part], rtol=0, atol=roundings * max(1.0, abs(double[:, part]).max())
        )


@pytest.mark.parametrize("case", ["football-drag", "sliding-brick"])
def test_a_replayed_step_is_a_step(case: str) -> None:
    """To the last bit, for the integrator with most stages."""
    scene, method = load(case).scene, Method.parse("RK4", 1e-3)
    xml, joints = adapter.described_by_mujoco(scene, method)
    model, data, rows = adapter.started(xml, [joints], scene)
    for _ in range(20):
        mujoco_warp.step(model, data)
    stepped = rows(np.concatenate([data.qpos.numpy()[0], data.qvel.numpy()[0]], dtype=np.float64)[None])
    np.testing.assert_array_equal(adapter.prepare([scene], method).advance(np.array([20]))[0, 0], stepped)


@pytest.mark.parametrize("integrator", [own.name for own in ENGINE.integrators if own.kinds])
def test_the_order_of_an_integrator(integrator: str) -> None:
    initial = State(velocity=(0.0, 2.0, 1.0), angular_velocity=(6.0, 2.0, 4.0))
    scene = Scene(Body(2.0, (0.3, 0.4, 0.6)), initial, gravity=9.81)
    order = observed_order(adapter, scene, integrator, (0.08, 0.04, 0.02), 0.32)["attitude"]
    # The next term of the error is smaller by w h = 0.1 at these steps, which are so large that single precision shows order 4.
    assert order == pytest.approx(4 if integrator == "RK4" else 1, abs=0.2)


def test_a_solver_that_it_lacks_is_not_offered() -> None:
    """MuJoCo Warp refuses every model with iterations of the noslip solver."""
    assert not any("noslip" in integrator.options for integrator in ENGINE.integrators)
    assert all("impratio" in integrator.options for integrator in ENGINE.integrators)
