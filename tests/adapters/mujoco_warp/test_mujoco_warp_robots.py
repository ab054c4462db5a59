"""Robot models in MuJoCo Warp: how far its mass matrices are from those of MuJoCo, which has made them of the same model."""

from pathlib import Path

import numpy as np
import pytest

from bodycheck.adapters.mujoco import robots as double
from bodycheck.reference.robots.state import RobotState
from tests.support.robot_texts import GRAVITY, LIMIT, joint, link, robot, written

pytest.importorskip("mujoco_warp")

from bodycheck.adapters.mujoco_warp import robots as single

HEAVY = '<inertial><mass value="50"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
LIGHT = '<inertial><mass value="0.02"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>'

#: A finger on a body whose centre of mass is 1.5 m away.
FAR = robot(
    link("base", ""),
    link("body", HEAVY),
    link("finger", LIGHT),
    joint("hip", "revolute", "base", "body", '<axis xyz="0 0 1"/>' + LIMIT),
    '<joint name="knuckle" type="revolute"><parent link="body"/><child link="finger"/><origin xyz="0.9 0.7 1"/>'
    f'<axis xyz="0 0 1"/>{LIMIT}</joint>',
)


def test_a_light_link_far_from_the_centre_of_mass_is_within_the_rounding_that_is_told(tmp_path: Path) -> None:
    file = written(FAR, tmp_path)
    states = [RobotState({"hip": (0.1 * turn,), "knuckle": (0.3 * turn,)}, {}, {}, {}) for turn in range(20)]
    one, other = (adapter.read_robot(file, states, GRAVITY) for adapter in (single, double))
    worst = 0.0
    for mine, exact in zip(one.terms, other.terms, strict=True):
        assert mine.mass_matrix is not None
        assert exact.mass_matrix is not None
        roots = np.sqrt(np.diagonal(exact.mass_matrix))
        worst = max(worst, float(np.max(np.abs(mine.mass_matrix - exact.mass_matrix) / np.outer(roots, roots))))
    # A moment of 0.02 kg at 1.5 m is 40000 times that of the finger itself, and so is its rounding.
    assert 1e-4 < worst < one.rounding < 0.1
