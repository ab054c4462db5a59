"""Adapters: conventions, what stepping means, and what the engines' schemes are."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np
import pytest

from bodycheck import compare, load, simulate, truth
from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, Strides
from bodycheck.adapters.stepping import Normalised
from bodycheck.reference.scene import Body, Scene, State
from bodycheck.reference.trajectory import Array
from bodycheck.results.outcome import Diverged, Unsupported
from tests.support.cases import shortened

TUMBLE = shortened(load("osrf-boxes-complex"), 1.0, 11)


def test_every_integrator_of_the_installed_mujoco_is_offered() -> None:
    assert len(offers.offered(registry.load("mujoco").engine, TUMBLE.scene)) == len(mujoco.mjtIntegrator.__members__)


@pytest.mark.parametrize("integrator", offers.offered(registry.load("mujoco").engine, TUMBLE.scene))
def test_mujoco_states_are_those_of_mj_step(integrator: str) -> None:
    simulation = registry.load("mujoco").prepare([TUMBLE.scene], Method.parse(integrator, 1e-3))
    data = mujoco.MjData(simulation.model)
    data.qpos, data.qvel = simulation.data.qpos, simulation.data.qvel
    mujoco.mj_step(simulation.model, data, nstep=700)
    np.testing.assert_array_equal(simulation.advance(np.array([700]))[0, 0, 0], [*data.qpos, *data.qvel])


def test_mujoco_models_nothing_that_a_free_body_does_not_need() -> None:
    model = registry.load("mujoco").prepare([TUMBLE.scene], Method.parse("Euler", 1e-3)).model
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


def test_moments_that_mujoco_refuses_are_unsupported() -> None:
    """A disc whose moments break A + B >= C by a rounding error exists in mechanics."""
    disc = Body(1.0, (0.1, 0.2, 0.30000000000000004 * (1 + 1e-14)))
    outcome = simulate(replace(TUMBLE, scene=Scene(disc, State())), "mujoco", "Euler").outcome
    assert isinstance(outcome, Unsupported)
    assert "MuJoCo refuses the model" in outcome.reason


def test_a_method_for_other_scenes_is_unsupported() -> None:
    outcome = simulate(TUMBLE, "pinocchio", "admm").outcome
    assert isinstance(outcome, Unsupported)
    assert "has no integrator 'admm' for this scene" in outcome.reason
    outcome = simulate(TUMBLE, "mujoco", "Euler:cone=elliptic,drag=fluid").outcome
    assert isinstance(outcome, Unsupported)
    assert "has no option cone=elliptic, drag=fluid of 'Euler' for this scene" in outcome.reason


def test_a_contact_without_friction_claims_none() -> None:
    scene, adapter = load("sliding-brick").scene, registry.load("mujoco")
    assert adapter.contact_law(scene, Method.parse("Euler", 1e-3)).friction == 0.5
    assert adapter.contact_law(scene, Method.parse("Euler:condim=1", 1e-3)).friction == 0.0
    assert adapter.contact_law(scene, Method.parse("Euler:condim=4", 1e-3)) is None


@dataclass
class Drifting:
    """A simulation whose quaternions have the given norms, one a stride."""

    norms: Array

    def advance(self, strides: Strides) -> Array:
        states = np.ones((1, len(strides), 1, 13))
        states[..., 3:7] *= self.norms[: len(strides), None, None] / 2
        return states


def test_quaternions_are_normalised_and_their_norms_remembered() -> None:
    simulation = Normalised(Drifting(np.array([1.0, 1.3, 0.9])))
    states = simulation.advance(np.array([0, 1, 1]))
    np.testing.assert_allclose(np.linalg.norm(states[..., 3:7], axis=-1), 1.0, rtol=1e-15)
    np.testing.assert_array_equal(states[..., [0, 1, 2, 7, 12]], 1.0)
    assert simulation.quaternion_norm_error == pytest.approx(0.3, abs=1e-15)
    simulation.advance(np.array([0]))
    assert simulation.quaternion_norm_error == pytest.approx(0.3, abs=1e-15)
    simulation.simulation.norms = np.array([np.nan])
    simulation.advance(np.array([0]))
    assert simulation.quaternion_norm_error == np.inf
