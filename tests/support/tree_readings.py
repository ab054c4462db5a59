"""Random robot models as an engine reads them from a URDF, beside the reference."""

from pathlib import Path
from random import Random

import pytest

from bodycheck.adapters.robot_reading import RobotModels
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.urdf_text import urdf
from tests.support.robot_texts import GRAVITY, written
from tests.support.robot_trees import random_tree
from tests.support.robot_truths import assert_the_same

#: The number of joints of a tree.
JOINTS = 12


def assert_trees_agree(adapter: RobotModels, folder: Path, rounding: float, floating: bool = False) -> None:
    """Assert that an engine has the masses and terms of three random trees with turned inertias, welds and branches.

    rounding: the largest error of a number of the size of 1, in parts of 1.
    """
    for seed in range(3):
        model = random_tree(Random(seed), JOINTS, floating)
        states = seeded_states(model, 2, seed)
        reading = adapter.read_robot(written(urdf(model), folder), states, GRAVITY)
        masses = {link.name: float(link.mass) for link in model.links if link.mass}
        read = {body.name: body.mass for body in reading.bodies if body.name in masses}
        assert read == pytest.approx(masses, rel=max(rounding, 1e-15))
        for state, terms in zip(states, reading.terms, strict=True):
            assert_the_same(terms, model, state, GRAVITY, rounding)
