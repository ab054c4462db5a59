"""MJCF that bodycheck writes means to MuJoCo's compiler what was written."""

from dataclasses import replace
from pathlib import Path
from random import Random

import numpy as np
import pytest

from bodycheck.adapters.mujoco.robots import compiled
from bodycheck.reference.robots.dynamics import terms, velocity_labels
from bodycheck.reference.robots.model import RobotJoint
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.mjcf_text import mjcf
from tests.support.robot_trees import random_tree

#: Some hundred roundings in double precision, in which MuJoCo has principal moments, and that of a solution of equations.
ROUNDINGS = 1e-13


def acting(joint: RobotJoint) -> RobotJoint:
    """A joint with all that can act on it; the spring of a ball is slack where the ball is not turned."""
    rest = 0.4 if joint.type in ("revolute", "prismatic") else 0.0
    return replace(joint, armature=0.1, damping=0.2, friction=0.05, stiffness=0.3, rest=rest)


@pytest.mark.parametrize("seed", range(4))
def test_a_compiled_model_has_the_terms_of_the_model_that_was_written(seed: int, tmp_path: Path) -> None:
    random = Random(seed)
    model = random_tree(random, 15, types=("revolute", "prismatic", "fixed", "spherical"))
    model = replace(model, gravity=(0.5, 0.25, -9.0), joints=tuple(map(acting, model.joints)))
    path = tmp_path / "tree.xml"
    path.write_text(mjcf(model), "utf-8")
    other = compiled(str(path))
    assert other.gravity == model.gravity
    (state,) = seeded_states(model, 1, seed)
    one, two = terms(model, state, model.gravity), terms(other, state, model.gravity)
    order = [velocity_labels(other).index(label) for label in velocity_labels(model)]
    for name in ("gravity_force", "coriolis_force", "passive_force", "forward_dynamics", "inverse_dynamics"):
        expected = getattr(one, name)
        assert np.abs(getattr(two, name)[order] - expected).max() <= ROUNDINGS * max(1, np.abs(expected).max()), name
    np.testing.assert_allclose(two.mass_matrix[np.ix_(order, order)].astype(float), one.mass_matrix.astype(float), atol=1e-13)
