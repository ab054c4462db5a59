"""Euler's equations with a quaternion in wide arithmetic, against which other ways are checked (heyoka)."""

import numpy as np

from bodycheck.reference.exact.start import start
from bodycheck.reference.integration.heyoka_solver import integrator, solve
from bodycheck.reference.integration.rotation import Rotation
from bodycheck.reference.integration.taylor import (
    FLOAT_TYPES,
    Precision,
    euler_equations,
    euler_start,
    in_body_frame,
    unit_of_rate,
)
from bodycheck.reference.kinematics import normalise
from bodycheck.reference.scene import Scene
from bodycheck.reference.trajectory import Array


def quasi_coordinates(scene: Scene, times: Array, precision: Precision = "extended") -> Rotation:
    """The rotation of a free body at times (n,) >= 0 in any order, s. Raises `OutOfReach` as `solve` does."""
    unit, dtype = unit_of_rate(scene), FLOAT_TYPES[precision]
    state, parameters = euler_start(scene, dtype)
    solution = solve(integrator(euler_equations, dtype), state, parameters, np.asarray(times) * unit)
    return in_body_frame(start(scene), Rotation(normalise(solution[:, :4]), solution[:, 4:] * unit))
