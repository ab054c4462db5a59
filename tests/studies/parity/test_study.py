"""How much is asked of large models."""

from random import Random

from bodycheck.studies.parity.study import LARGEST, fitting
from tests.support.robot_trees import random_tree


def test_a_large_model_is_compared_at_fewer_states() -> None:
    robot = random_tree(Random(1), 60, types=("revolute",))
    assert fitting(robot, 100) == 100
    large = random_tree(Random(1), 700, types=("revolute",))
    assert 1 < fitting(large, 100) < 10
    assert 6 * 700 * 701 * fitting(large, 100) <= LARGEST
    assert fitting(large, 1) == fitting(random_tree(Random(1), 1999, types=("revolute",)), 100) == 1
