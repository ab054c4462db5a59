"""The truth of a case."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.case import Case
from bodycheck.reference.truth import Truth
from bodycheck.reference.truth import truth as truth_of_scene


def truth(case: Case, times: ArrayLike | None = None) -> Truth:
    """The reference trajectory of a case and its error bound, at the case's instants or at ascending times (n,) >= 0 s.

    Raises `bodycheck.reference.truth.NotModelled` for a scene that the reference has no model of, and
    `bodycheck.reference.integration.OutOfReach` for a motion that it cannot follow.
    """
    instants = case.instants if times is None else np.asarray(times, dtype=float)
    return truth_of_scene(case.scene, instants)


def as_json(case: Case, truth: Truth) -> dict[str, Any]:
    """A truth as `bodycheck truth --json` prints it: arrays by name, and what made them."""
    trajectory = truth.trajectory
    return {
        "case": case.name,
        "model": truth.model,
        "backend": truth.backend,
        "t": trajectory.t.tolist(),
        "position": trajectory.position.tolist(),
        "quaternion": trajectory.quaternion.tolist(),
        "velocity": trajectory.velocity.tolist(),
        "angular_velocity": trajectory.angular_velocity.tolist(),
        "truth_error": truth.error.tolist(),
    }
