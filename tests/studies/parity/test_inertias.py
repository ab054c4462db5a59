"""Causes of differences of inertia, in numbers that are rounded to single precision or changed a little by an engine."""

from random import Random

import numpy as np

from bodycheck.studies.parity.diagnosis.inertias import is_dropped, is_turned
from tests.support.robot_trees import random_link, random_rotation

#: The part of an inertia of 0.04 kg m^2 that an engine leaves which adds 1e-6 kg m^2 to all moments, as Newton does.
ADDED, SINGLE = 1e-6 * np.eye(3), 1e-4


def test_a_turned_inertia_is_one_in_the_precision_of_the_engine() -> None:
    truth = random_link(Random(1), "arm").inertia.astype(float)
    turn = random_rotation(Random(2)).astype(float)
    turned = turn @ truth @ turn.T
    assert is_turned(turned, truth)
    assert is_turned(turned + ADDED, truth, SINGLE)
    assert not is_turned(turned + ADDED, truth)


def test_a_dropped_inertia_is_one_in_the_precision_of_the_engine() -> None:
    truth = random_link(Random(1), "arm").inertia.astype(float)
    assert is_dropped(0 * truth, truth)
    assert is_dropped(ADDED, truth, SINGLE)
    assert not is_dropped(ADDED, truth)


def test_a_turned_inertia_may_have_lost_its_negative_moments() -> None:
    turn = random_rotation(Random(2)).astype(float)
    impossible, raised = np.diag([-0.1, 0.4, 1.0]), np.diag([0.0, 0.4, 1.0])
    assert is_turned(turn @ raised @ turn.T, impossible)
    assert not is_turned(raised, raised)
    assert not is_turned(turn @ (raised + 0.1 * np.eye(3)) @ turn.T, impossible)
