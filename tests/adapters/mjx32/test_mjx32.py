"""MJX in single precision."""

import numpy as np

from bodycheck import load
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method

MJX32 = registry.load("mjx32")


def test_states_are_numbers_of_single_precision_that_differ_from_mujoco_by_its_roundings() -> None:
    scene = load("osrf-boxes-complex").scene
    strides = np.full(10, 10)
    own, other = (
        registry.load(name).prepare([scene], Method.parse("Euler", 1e-3)).advance(strides) for name in ("mjx32", "mujoco")
    )
    assert MJX32.engine.precision == "float32"
    np.testing.assert_array_equal(own, own.astype(np.float32))
    # A hundred steps each round numbers of at most 8 by half of 2^-20; all of one sign would make 5e-5.
    difference = np.abs(own - other).max()
    assert 0 < difference < 5e-5
