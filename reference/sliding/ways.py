"""Every way of computing a slide, each with bounds of its own error, for a cross-check."""

from dataclasses import replace

import numpy as np

from bodycheck.reference.errors import NotFlat
from bodycheck.reference.planar import planar_state
from bodycheck.reference.scene import Scene
from bodycheck.reference.sliding.balance import deviation
from bodycheck.reference.sliding.bounds import RELATIVE_ROUNDING, SAFETY, largest_deviation
from bodycheck.reference.sliding.coupled_motion import Motion
from bodycheck.reference.sliding.motion import coupled, in_closed_form, is_coupled, to_trajectory
from bodycheck.reference.trajectory import Array
from bodycheck.reference.witness import DOUBLE_DIGITS, Witness

#: Name of the witness that starts from the file.
BALANCE_WITNESS = "balance of momentum, quadrature"

#: Fraction of an estimated error by which the estimate itself may be wrong, since it is linear in the error.
LINEARITY = 0.25


def ways(scene: Scene, times: Array) -> tuple[Witness, ...]:
    """The ways of a slide at ascending times (n,) >= 0, s.

    For a slide in closed form, the ways are the closed form and the balance of momentum. For any other slide, they are the
    integrations in log time and in plain time, and the balance of momentum along the first of them. The bound of an integration
    is twice its disagreement with the other, since its own error is known only from this disagreement: two integrations of
    different equations with different steps have errors of like size, and the errors would have to have equal signs and sizes
    for the disagreement to be below half of one of them.

    Raises as `motion.slide` does.
    """
    if scene.plane is None:
        raise NotFlat("the scene has no plane to lie on")
    start = planar_state(scene)
    if not is_coupled(scene, scene.plane, start):
        motion = in_closed_form(scene, scene.plane, start, times)
        none = np.zeros((len(times), 6))
        return _witness("closed form", scene, motion, none, times), _balance(scene, motion, times)
    motion, other = coupled(scene, scene.plane, start, times)
    apart = SAFETY * np.maximum.accumulate(np.abs(motion.rows - other.rows))
    return (
        _witness("log time, scipy-dop853", scene, motion, apart, times),
        _witness("plain time, scipy-dop853", scene, other, apart, times),
        _balance(scene, motion, times),
    )


def _balance(scene: Scene, motion: Motion, times: Array) -> Witness:
    """A motion minus the errors that the balance of momentum finds in it, with bounds of the remaining errors."""
    estimate = deviation(scene, motion.panels)
    panel = np.searchsorted(motion.panels.times[1:], times, side="left")
    # The error at the end of a panel is taken for the whole panel; the differences within it are part of the bound.
    errors = estimate.ends[np.minimum(panel + 1, len(estimate.ends) - 1)]
    within = (
        largest_deviation(estimate)[panel]
        - np.abs(errors)
        + np.abs(np.diff(estimate.ends, axis=0, append=estimate.ends[-1:]))[panel]
    )
    corrected = replace(motion, rows=motion.rows - errors)
    return _witness(BALANCE_WITNESS, scene, corrected, within + LINEARITY * np.abs(errors), times)


def _witness(name: str, scene: Scene, motion: Motion, errors: Array, times: Array) -> Witness:
    """A motion with bounds from the errors (n, 6) of its rows, and from rounding."""
    start, rows = planar_state(scene), motion.rows
    trajectory = to_trajectory(scene, times, rows, start[2])
    gyration = float(np.sqrt(scene.body.moments[2] / scene.body.mass))
    speed = float(np.linalg.norm(start[3:] * [1.0, 1.0, gyration]))
    way = np.abs(rows[:, :2]).sum(axis=1) + speed * times
    turn = 1 + np.abs(rows[:, 2]) + speed / gyration * times
    return Witness(
        name,
        quaternion=trajectory.quaternion,
        angular_velocity=trajectory.angular_velocity,
        position=trajectory.position,
        velocity=trajectory.velocity,
        error=errors[:, 2] + RELATIVE_ROUNDING * turn,
        angular_velocity_error=errors[:, 5] + RELATIVE_ROUNDING * speed / gyration,
        position_error=np.hypot(*errors[:, :2].T) + RELATIVE_ROUNDING * way,
        velocity_error=np.hypot(*errors[:, 3:5].T) + RELATIVE_ROUNDING * speed,
        digits=DOUBLE_DIGITS,
    )
