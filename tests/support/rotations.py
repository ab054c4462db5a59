"""Angles, rates and vectors to draw from in tests of rotations, and how far apart matrices are."""

import math

import numpy as np
from hypothesis import strategies as st

FULL_TURN = st.floats(-math.pi, math.pi)
ANGLE = st.floats(-20, 20)
RATE = st.floats(-100, 100)

#: Unit vectors (3,).
UNIT = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: math.hypot(*v) > 0.1).map(lambda v: np.array(v) / math.hypot(*v))


def apart(first: np.ndarray, second: np.ndarray) -> float:
    """The largest difference of two entries of arrays of the same shape."""
    return float(np.abs(np.asarray(first) - np.asarray(second)).max())
