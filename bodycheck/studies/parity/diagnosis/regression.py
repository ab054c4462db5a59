"""The mass matrix and the gravity forces of a robot as linear functions of the inertial parameters of its bodies.

The ten parameters of a body are its mass, its mass times its centre of mass, and the components xx, yy, zz, xy, xz, yz of its
inertia about the origin of its frame (Atkeson, An and Hollerbach 1986).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bodycheck.adapters.robot_numbers import components
from bodycheck.reference.robots.rotations import matrices
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity.diagnosis.inertias import Inertial, steiner
from bodycheck.studies.parity.numbers import tensor
from bodycheck.studies.parity.rotations import crossing
from bodycheck.studies.parity.stacks import Stack, times, transposed


@dataclass(frozen=True, eq=False)
class Regression:
    """The differences to explain, and the effects of parameters on them, both relative to the sizes of their rows.

    Attributes
    ----------
    left
        The mass matrices and gravity forces of an engine at some states, minus those of a model (r,).
    bodies
        For each body, the changes (r, 10) by a unit of each of its parameters.
    armatures
        The changes (r, n) by a unit of armature at each velocity.
    """

    left: Array
    bodies: dict[str, Array]
    armatures: Array


def regression(engine: Stack, model: Stack, names: Sequence[str], gravity: Vector) -> Regression | None:
    """Return the regression of an engine's terms minus those of a model at the same states.

    names: the bodies whose parameters may differ. gravity: the gravitational acceleration (m/s^2). Return None if a mass matrix
    is missing or not finite.
    """
    mass, expected = engine.mass_matrix, model.mass_matrix
    if mass is None or expected is None or not np.all(np.isfinite(mass)) or not np.all(np.isfinite(expected)):
        return None
    n = expected.shape[1]
    upper = np.triu_indices(n)
    roots = np.sqrt(np.maximum(np.diagonal(expected, axis1=1, axis2=2), 1e-300))
    weights = 1 / (roots[:, :, None] * roots[:, None, :])
    pulls = engine.gravity_force is not None and model.gravity_force is not None
    size = float(np.max(np.abs(model.gravity_force) / roots, initial=0.0)) if model.gravity_force is not None else 0.0
    pulls = pulls and size > 0

    # If the file has an impossible body, an engine may report mass matrices of any size. An overflow explains nothing.
    @np.errstate(over="ignore")
    def rows(matrices_: Array, forces: Array | None) -> Array:
        parts = [(matrices_ * weights)[:, upper[0], upper[1]].ravel()]
        if pulls:
            parts.append(np.zeros(roots.size) if forces is None else (forces / roots / size).ravel())
        return np.concatenate(parts)

    more = engine.gravity_force - model.gravity_force if pulls else None  # type: ignore[operator]
    bodies = {
        name: np.stack([rows(*unit) for unit in _units(model.jacobians[name], model.poses[name], np.array(gravity))], axis=1)
        for name in names
        if name in model.jacobians
    }
    identity = np.eye(n)
    units = [rows(np.broadcast_to(np.outer(identity[i], identity[i]), mass.shape), None) for i in range(n)]
    return Regression(rows(mass - expected, more), bodies, np.stack(units, axis=1))


def _units(jacobian: Array, poses: Array, gravity: Array) -> list[tuple[Array, Array]]:
    """Return the mass matrix (s, n, n) and the gravity forces (s, n) that a unit of each parameter of a body makes."""
    turn = matrices(poses[:, 3:])
    back = transposed(turn)
    linear, angular = back @ jacobian[:, :3], back @ jacobian[:, 3:]  # along the axes of the body
    pull = back @ gravity
    units = [(transposed(linear) @ linear, -times(transposed(linear), pull))]
    for axis in np.eye(3):
        cross = crossing(axis)
        mixed = transposed(linear) @ (-cross) @ angular  # linear velocity of the centre of mass: v - h x w
        torque = np.cross(np.broadcast_to(axis, pull.shape), pull)
        units.append((mixed + transposed(mixed), -times(transposed(angular), torque)))
    for unit in map(tensor, np.eye(6)):
        units.append((transposed(angular) @ unit @ angular, np.zeros(linear.shape[::2])))
    return units


def parameters(body: Inertial) -> Array:
    """Return the ten parameters of a body."""
    about = body.tensor + steiner(body.mass, body.centre)
    return np.array([body.mass, *(body.mass * body.centre), *components(about)])
