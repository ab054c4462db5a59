"""Terms of an engine beside those of the reference, in whatever velocities the engine has."""

from typing import Any

import numpy as np

from bodycheck.reference.robots.dynamics import terms
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.terms import Terms
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array


def assert_the_same(own: Terms, model: RobotModel, state: RobotState, gravity: Vector, rounding: float = 1e-12) -> None:
    """Assert that an engine's terms are those of a model.

    The engine may have other velocities than the reference, for instance other axes or another order. The matrix T from those
    of the reference to its own follows from the Jacobians of both, and takes forces and the mass matrix back. An engine without
    Jacobians must have the velocities of the reference.

    Parameters
    ----------
    own
        The terms of the engine; those that it does not have are not compared.
    model, state, gravity
        What the terms are those of.
    rounding
        The largest error of a number of the size of 1, which is a sum of a hundred products or so.
    """
    true = doubles(terms(model, state, gravity))
    links = [name for name in own.poses if name in true.poses]
    assert links
    for link in links:
        pose, expected = own.poses[link], true.poses[link]
        np.testing.assert_allclose(pose[:3], expected[:3], rtol=0, atol=10 * rounding, err_msg=link)
        assert abs(abs(pose[3:] @ expected[3:]) - 1) < rounding, link
    matrix = given(own.mass_matrix)
    turn = np.eye(len(matrix))
    if own.jacobians:
        own_jacobian, true_jacobian = (np.concatenate([part.jacobians[link] for link in links]) for part in (own, true))
        turn, _, rank, _ = np.linalg.lstsq(own_jacobian, true_jacobian, rcond=None)
        assert rank == turn.shape[0] == turn.shape[1]
        np.testing.assert_allclose(own_jacobian @ turn, true_jacobian, rtol=0, atol=100 * rounding)
    close(turn.T @ matrix @ turn, true.mass_matrix, rounding)
    for force in ("gravity_force", "inverse_dynamics"):
        if (asked := getattr(own, force)) is not None:
            close(turn.T @ asked, getattr(true, force), rounding)
    if own.forward_dynamics is not None:
        passive = 0.0 if own.passive_force is None else own.passive_force
        efforts = matrix @ own.forward_dynamics + given(own.coriolis_force) + given(own.gravity_force) - passive
        flat = [number for joint in model.joints if joint.name in state.efforts for number in state.efforts[joint.name]]
        close(turn.T @ efforts, np.array(flat), rounding)


def close(found: Array, expected: Any, rounding: float) -> None:
    """Assert that numbers are near those expected, whose largest counts."""
    size = max(1.0, float(np.abs(expected).max()))
    np.testing.assert_allclose(found, expected, rtol=0, atol=100 * rounding * size)


def given(value: Any) -> Array:
    """A term that there must be."""
    assert value is not None
    return np.asarray(value, dtype=float)


def doubles(wide: Terms) -> Terms:
    """Terms of the reference in double precision."""

    def rounded(value: Any) -> Any:
        if isinstance(value, dict):
            return {name: rounded(part) for name, part in value.items()}
        return None if value is None else np.asarray(value, dtype=float)

    return Terms(**{name: rounded(value) for name, value in vars(wide).items()})
