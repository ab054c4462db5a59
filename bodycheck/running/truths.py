"""The truth of a case."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bodycheck.casefile.case import Case
from bodycheck.reference import certificate
from bodycheck.reference.certificate import Certificate
from bodycheck.reference.errors import NotModelled, OutOfReach
from bodycheck.reference.planar import Stop
from bodycheck.reference.scene import Plane
from bodycheck.reference.trajectory import Array
from bodycheck.reference.truth import Truth
from bodycheck.reference.truth import truth as truth_of_scene

#: Durations of a case after which a body that still slides counts as one that does not stop.
STOP_HORIZON = 100


def truth(case: Case, times: ArrayLike | None = None) -> Truth:
    """The reference trajectory of a case and its error bound, at the case's instants or at ascending times (n,) >= 0 s.

    Raises `bodycheck.reference.errors.NotModelled` for a scene that the reference has no model of, and
    `bodycheck.reference.errors.OutOfReach` for a motion that it cannot follow.
    """
    return truth_of_scene(case.scene, _instants(case, times))


def certify(case: Case, times: ArrayLike | None = None) -> Certificate:
    """Every way to the truth of a case held against every other, at the instants and with the errors raised of `truth`."""
    return certificate.certify(case.scene, _instants(case, times))


def stop_under(case: Case, law: Plane) -> Stop | None:
    """Return where and when the body of a case stops if a law of friction acts on its plane.

    None if it does not stop within `STOP_HORIZON` times the duration of the case, or if the reference has no truth there.
    """
    try:
        return truth_of_scene(replace(case.scene, plane=law), np.array([0.0, STOP_HORIZON * case.duration])).stop
    except (NotModelled, OutOfReach):
        return None


def _instants(case: Case, times: ArrayLike | None) -> Array:
    return case.instants if times is None else np.asarray(times, dtype=float)


def as_json(case: Case, truth: Truth) -> dict[str, Any]:
    """A truth as `bodycheck truth --json` prints it: arrays by name, and what made them."""
    trajectory = truth.trajectory
    return {
        "case": case.name,
        "model": truth.model,
        "reason": truth.reason,
        "backend": truth.backend,
        "witnesses": list(truth.witnesses),
        "t": trajectory.t.tolist(),
        "position": trajectory.position.tolist(),
        "quaternion": trajectory.quaternion.tolist(),
        "velocity": trajectory.velocity.tolist(),
        "angular_velocity": trajectory.angular_velocity.tolist(),
        "truth_error": truth.error.tolist(),
        "truth_position_error": truth.position_error.tolist(),
    }


def certificate_as_json(found: Certificate) -> dict[str, Any]:
    """What `bodycheck truth --certify --json` adds: differences (rad) by pairs of ways, the bound, the growth of an error."""
    return {
        "differences": [
            {"one": one, "other": other, "attitude": apart.tolist()} for (one, other), apart in found.differences.items()
        ],
        "certified_error": found.bound.tolist(),
        "growth": None if found.growth is None else found.growth.tolist(),
    }
