"""Larger models of a mechanism move as the smallest one does, up to their time-step errors and the softness of constraints."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters import mechanism_models, registry
from bodycheck.adapters.contract import Method, Models, SceneUnsupported
from bodycheck.reference.mechanisms.mechanism import Joint, Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.jointed import ball_and_hinge, body, cart_pole

STEP, STEPS = 0.001, 200


def arm() -> Mechanism:
    """A body on a ball, one on a hinge of it, and one that is fixed to that; nothing acts on the joints."""
    bare = ball_and_hinge()
    free = tuple(replace(joint, armature=0.0, damping=0.0, stiffness=0.0) for joint in bare.joints)
    finger = Joint("glue", "fixed", 1, 2, (0.1, 0.0, -0.3), (0.9, 0.1, 0.3, -0.2))
    bodies = (*bare.bodies, body("finger", 0.3, (0.02, 0.03, 0.025), (0.0, 0.1, 0.1)))
    return replace(bare, bodies=bodies, joints=(*free, finger))


def moved(engine: str, spelling: str) -> Array:
    """The states (bodies, 13) of the arm after 0.2 s."""
    adapter = registry.load(engine)
    return adapter.prepare([arm()], Method.parse(spelling, STEP)).advance(np.array([STEPS]))[0, -1]


@pytest.mark.parametrize(
    ("engine", "integrator", "model", "most"),
    [
        # The errors of both runs with RK4 are some 1e-9 m here.
        ("mujoco", "RK4", "model=three-hinges", 1e-8),
        ("pinocchio", "rk4", "model=three-hinges", 1e-8),
        # A hinge at two points has a redundant constraint, whose rounding is divided by a regularisation of 1e-6.
        ("pinocchio", "rk4", "model=free-bodies", 1e-6),
        # Soft constraints at the default impedance sag, and nearly rigid ones much less.
        ("mujoco", "RK4", "model=free-bodies", 0.05),
        ("mujoco", "RK4", "model=free-bodies,solref=-1e5 -1e3,solimp=0.999 0.999 0.001", 1e-4),
    ],
)
def test_a_larger_model_moves_as_the_smallest(engine: str, integrator: str, model: str, most: float) -> None:
    apart = np.abs(moved(engine, f"{integrator}:{model}") - moved(engine, integrator))[:, :3].max()
    assert 0 < apart < most


@pytest.mark.parametrize("engine", ["mujoco", "pinocchio"])
def test_there_are_the_models_that_a_mechanism_can_have(engine: str) -> None:
    adapter = registry.load(engine)
    assert isinstance(adapter, Models)
    integrator = adapter.engine.integrators[0].name
    assert list(adapter.models(arm(), integrator)) == ["joints", "three-hinges", "free-bodies"]
    assert not adapter.models(ball_and_hinge(), integrator)  # a damped ball
    assert not adapter.models(cart_pole(), integrator)
    assert not adapter.models(arm(), f"{integrator}:model=free-bodies")


@pytest.mark.parametrize(
    ("model", "mechanism", "reason"),
    [
        ("three-hinges", cart_pole(), "there is no ball"),
        ("three-hinges", ball_and_hinge(), "a ball has damping"),
        ("free-bodies", cart_pole(), "points do not make prismatic joints"),
        ("free-bodies", ball_and_hinge(), "something acts on its joints"),
        ("planar", arm(), "there are: joints, three-hinges, free-bodies"),
    ],
)
def test_a_model_that_is_not_there_is_refused_with_the_reason(model: str, mechanism: Mechanism, reason: str) -> None:
    with pytest.raises(SceneUnsupported, match=f"no model '{model}' of this mechanism: {reason}"):
        mechanism_models.check(mechanism, model)
