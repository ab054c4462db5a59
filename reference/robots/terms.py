"""The terms of the equations of motion of a robot model at a state: M a + c + g = effort + p."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: Doubles of an engine, or the reference's numbers in the 80-bit type.
Array = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms at one state. A term that an engine does not offer is None or empty.

    The n velocities are in the order of the engine or reference that computes the terms. M is the mass matrix with armature.

    Attributes
    ----------
    poses
        Position (m) and unit quaternion w, x, y, z (link to world) of each link's frame (7,), by the name of the link.
    jacobians
        Matrix (6, n) of each link, by its name: velocity of the origin of the link's frame and angular velocity, per unit of
        each joint velocity, along the world's axes where an engine offers that choice.
    mass_matrix
        M (n, n).
    gravity_force
        g (n,): the efforts that hold the robot still against gravity.
    coriolis_force
        c (n,): Coriolis and centrifugal forces, on the side of the accelerations in the equation.
    passive_force
        p (n,): forces of springs, damping and dry friction, on the side of the efforts in the equation.
    forward_dynamics
        The accelerations (n,) under the efforts of the state.
    inverse_dynamics
        The efforts (n,) for the accelerations of the state, without p.
    """

    poses: Mapping[str, Array] = field(default_factory=dict)
    jacobians: Mapping[str, Array] = field(default_factory=dict)
    mass_matrix: Array | None = None
    gravity_force: Array | None = None
    coriolis_force: Array | None = None
    passive_force: Array | None = None
    forward_dynamics: Array | None = None
    inverse_dynamics: Array | None = None
