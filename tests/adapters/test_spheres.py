"""MuJoCo and Pinocchio with spheres that hit each other, without a plane and with one."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters.contract import Adapter, Method
from bodycheck.adapters.mujoco import engine as mujoco
from bodycheck.adapters.pinocchio import engine as pinocchio
from bodycheck.adapters.pinocchio.contact import HAS_POINT_CONTACTS
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import truth
from tests.support.spheres import pair, sphere

STEP = 0.001

#: Spheres that hit each other head-on, beside the centre without slip afterwards, and sliding.
HEAD_ON = pair(sphere("first", (-0.5, 0.0, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.3, 0.0, 0.0), mass=3.0), 0.5, 0.5)
STICKING = pair(sphere("first", (-0.5, 0.06, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.3, 0.0, 0.0)), 0.5, 0.8)
SLIDING = pair(sphere("first", (-0.5, 0.15, 0.0), (1.0, 0.0, 0.0)), sphere("second", (0.3, 0.0, 0.0)), 0.1, 0.8)

ENGINES = [
    pytest.param(mujoco, "Euler:cone=elliptic,restitution=solref", id="mujoco"),
    pytest.param(
        pinocchio, "admm", id="pinocchio", marks=pytest.mark.skipif(not HAS_POINT_CONTACTS, reason="has no point contacts")
    ),
]


def last_velocities(adapter: Adapter, method: str, scene: Mechanism) -> Array:
    """The velocities (2, 3) of both spheres after 1.5 s."""
    steps = np.array([round(1.5 / STEP)], dtype=np.int64)
    return np.asarray(adapter.prepare([scene], Method.parse(method, STEP)).advance(steps)[0, -1, :, 7:10])


@pytest.mark.parametrize("scene", [HEAD_ON, STICKING, SLIDING])
@pytest.mark.parametrize(("adapter", "method"), ENGINES)
def test_spheres_part_with_nearly_the_exact_velocities(adapter: Adapter, method: str, scene: Mechanism) -> None:
    exact = truth(scene, np.array([0.0, 1.5])).trajectory.velocity[:, -1]
    # A step moves the first sphere by 1 mm, 1 % of the radius, before the line of centres is known. MuJoCo's contact is a
    # spring that lasts 20 steps, in which the line of centres turns and the cone of friction is regularised.
    assert np.abs(last_velocities(adapter, method, scene) - exact).max() < 0.05


@pytest.mark.parametrize(("adapter", "method"), ENGINES)
def test_pairs_that_no_table_names_pass_through_each_other(adapter: Adapter, method: str) -> None:
    third = sphere("third", (0.0, 0.0, 0.0))
    scene = replace(HEAD_ON, bodies=(*HEAD_ON.bodies, third))
    seen = last_velocities(adapter, method, scene)
    assert np.abs(seen[:2] - last_velocities(adapter, method, HEAD_ON)).max() < 1e-12
    assert not seen[2].any()
