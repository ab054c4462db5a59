"""Adapters: conventions, what stepping means, and what the engines' schemes are."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bodycheck import compare, load, simulate, truth
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.reference.scene import Body, Plane, Scene, State
from bodycheck.running.outcome import Diverged, Unsupported
from bodycheck.running.smoke import check
from tests.support.cases import shortened

TUMBLE = shortened(load("osrf-boxes-complex"), 1.0, 11)
METHODS = [
    (engine, integrator) for engine in ("mujoco", "pinocchio") for integrator in registry.load(engine).integrators(TUMBLE.scene)
]


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
def test_obvious_scenes_have_their_obvious_answers(engine: str) -> None:
    assert check(engine) == []


def test_every_integrator_of_the_installed_mujoco_is_offered() -> None:
    assert len(registry.load("mujoco").integrators(TUMBLE.scene)) == len(mujoco.mjtIntegrator.__members__)


@pytest.mark.parametrize(("engine", "integrator"), METHODS)
def test_stepping_in_pieces_is_stepping_at_once(engine: str, integrator: str) -> None:
    adapter = registry.load(engine)
    strides = np.array([0, 3, 0, 5, 10_000, 1])
    whole = adapter.prepare(TUMBLE.scene, Method(integrator, 1e-3)).advance(strides)
    simulation = adapter.prepare(TUMBLE.scene, Method(integrator, 1e-3))
    pieces = [simulation.advance(part) for part in (strides[:2], strides[2:3], strides[3:])]
    np.testing.assert_array_equal(np.concatenate(pieces), whole)


@pytest.mark.parametrize("integrator", registry.load("mujoco").integrators(TUMBLE.scene))
def test_mujoco_states_are_those_of_mj_step(integrator: str) -> None:
    simulation = registry.load("mujoco").prepare(TUMBLE.scene, Method(integrator, 1e-3))
    data = mujoco.MjData(simulation.model)
    data.qpos, data.qvel = simulation.data.qpos, simulation.data.qvel
    mujoco.mj_step(simulation.model, data, nstep=700)
    np.testing.assert_array_equal(simulation.advance(np.array([700]))[0], [*data.qpos, *data.qvel])


def test_mujoco_models_nothing_that_a_free_body_does_not_need() -> None:
    model = registry.load("mujoco").prepare(TUMBLE.scene, Method("Euler", 1e-3)).model
    assert (model.ngeom, model.nsensor, model.nu, model.nv) == (0, 0, 0, 6)
    assert model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT
    assert model.body_mass[1] == TUMBLE.scene.body.mass
    np.testing.assert_array_equal(model.body_inertia[1], TUMBLE.scene.body.moments)
    np.testing.assert_array_equal(model.body_iquat[1], [1, 0, 0, 0])


#: Uniform gravity alone is integrated without error by a scheme of order 2 in world velocities: only rounding is left.
EXACT = None

#: In attitude and in position.
ORDERS = {
    ("mujoco", "Euler"): (1, 1),
    ("mujoco", "implicit"): (1, 1),
    ("mujoco", "implicitfast"): (1, 1),
    ("mujoco", "discrete"): (1, 1),
    ("mujoco", "RK4"): (4, EXACT),
    ("pinocchio", "semi-implicit-euler"): (1, 1),
    ("pinocchio", "body-twist-euler"): (1, 1),
    ("pinocchio", "rk4"): (4, 4),
    ("pinocchio", "rk4-naive"): (2, 2),
}


@pytest.mark.parametrize(("engine", "integrator"), ORDERS)
def test_observed_order_from_three_steps(engine: str, integrator: str) -> None:
    """Halving the step twice halves a first-order error twice: Richardson's estimate of the order, from both halvings."""
    steps = (4e-3, 2e-3, 1e-3)
    exact = truth(TUMBLE)
    maxima = [compare(exact, simulate(TUMBLE, engine, integrator, h)).maxima() for h in steps]
    for quantity, order in zip(("attitude_error", "position_error"), ORDERS[engine, integrator], strict=True):
        errors = np.array([maximum[quantity] for maximum in maxima])
        if order is EXACT:
            assert errors.max() < 1e-12
        else:
            # The next term of the error is of relative size h times a rate of 5 rad/s: 2 % in the ratio.
            np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), order, atol=0.1)


def test_semi_implicit_euler_is_what_mujoco_does() -> None:
    runs = [simulate(TUMBLE, *method, 1e-3) for method in (("mujoco", "Euler"), ("pinocchio", "semi-implicit-euler"))]
    one, other = (run.outcome.trajectory for run in runs)
    # Two programs, one scheme: 1000 steps of rounding, little amplified in a second.
    np.testing.assert_allclose(one.quaternion, other.quaternion, atol=1e-12)
    np.testing.assert_allclose(one.position, other.position, atol=1e-12)


def test_a_silent_reset_of_mujoco_is_diverged(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    flip = load("intermediate-axis-flip")
    fast = replace(flip, scene=replace(flip.scene, initial=State(angular_velocity=(3.0, 0.0, 300.0))))
    outcome = simulate(shortened(fast, 2.0, 21), "mujoco", "Euler", 2e-3).outcome
    assert isinstance(outcome, Diverged)
    assert "reset itself after BADQACC" in outcome.reason
    assert not list(tmp_path.iterdir()), "MuJoCo left a log file in the working directory"


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
def test_scenes_of_contact_are_unsupported(engine: str) -> None:
    scene = replace(TUMBLE.scene, plane=Plane(0.5))
    adapter = registry.load(engine)
    assert adapter.unsupported(scene) is not None
    with pytest.raises(SceneUnsupported):
        adapter.prepare(scene, Method(adapter.integrators()[0], 1e-3))
    run = simulate(replace(TUMBLE, scene=scene), engine, adapter.integrators()[0])
    assert isinstance(run.outcome, Unsupported)


def test_moments_that_mujoco_refuses_are_unsupported() -> None:
    """A disc whose moments break A + B >= C by a rounding error exists in mechanics."""
    disc = Body(1.0, (0.1, 0.2, 0.30000000000000004 * (1 + 1e-14)))
    outcome = simulate(replace(TUMBLE, scene=Scene(disc, State())), "mujoco", "Euler").outcome
    assert isinstance(outcome, Unsupported)
    assert "MuJoCo refuses the model" in outcome.reason


def test_an_integrator_that_is_not_there_is_unsupported() -> None:
    outcome = simulate(TUMBLE, "pinocchio", "RK4").outcome
    assert isinstance(outcome, Unsupported)
    assert "has no integrator 'RK4'" in outcome.reason
