"""A witness of a slide: the balance of momentum along a motion, by separate code that starts from the case file.

A motion is given in panels. In each panel, the changes of position and yaw are compared with the integrals of the velocities,
and the changes of the velocities with the integrals of the accelerations of `quadrature`. The difference is the defect of the
panel. The equations of motion, linearised along the motion, carry the defects on to later instants; the sum of the defects
there is the distance of the motion from the solution that the file determines (defect correction: Zadunaisky, Numer. Math. 27,
21, 1976).

It shares no code with the motion: it has separate code for the moment of inertia, the law of friction and the meaning of the
attitude.
"""

import math
from dataclasses import dataclass

import numpy as np

from bodycheck.reference.errors import OutOfReach, within_range
from bodycheck.reference.scene import EulerAngles, EulerRates, Scene, valid
from bodycheck.reference.sliding.panels import PANEL_NODES, PARTIAL_WEIGHTS, Panels
from bodycheck.reference.sliding.quadrature import Flat, accelerations, flat
from bodycheck.reference.trajectory import Array

#: Change of the velocity, as a fraction of the speed, in difference quotients of friction, which then have six correct digits.
DERIVATIVE_STEP = 1e-6


@dataclass(frozen=True, eq=False)
class Deviation:
    """The deviation of a motion from the motion that the file determines, in n panels: x, y and psi (m, rad) and their rates.

    Attributes
    ----------
    ends
        (n + 1, 6) the estimated errors at the ends of the panels.
    within
        (n, 6) the largest errors at the nodes of the panels, beyond the errors at the beginnings of the panels.
    gyration
        Radius of gyration sqrt(C/m) about the vertical (m).
    braking
        A lower bound, in every motion, of the deceleration (m/s^2) of the speed |u|, |u|^2 = v^2 + (C/m) w^2.
    """

    ends: Array
    within: Array
    gyration: float
    braking: float


def planar_start(scene: Scene) -> Array:
    """Initial x, y, psi, dx/dt, dy/dt, dpsi/dt (6,) of a body that lies flat, as its case file states them.

    psi is the direction of the body's axis I in the plane. Where K is vertical it is the sum of the Euler angles phi and psi.
    """
    x, y, _ = scene.initial.position
    vx, vy, _ = scene.initial.velocity
    yaw, spin = float(direction_of_first_axis(np.array(scene.initial.quaternion))), scene.initial.angular_velocity[2]
    definition = scene.definition
    if definition is not None and valid(scene).attitude:
        match definition.attitude:
            case EulerAngles(phi, _, psi):
                yaw = phi + psi
            case tuple() as quaternion:
                yaw = float(direction_of_first_axis(np.array(quaternion)))
        if valid(scene).rotation:
            rotation = definition.rotation
            spin = rotation.dphi + rotation.dpsi if isinstance(rotation, EulerRates) else rotation[2]
    return np.array([x, y, yaw, vx, vy, spin])


def direction_of_first_axis(quaternion: Array) -> Array:
    """Angle (...), rad, of the body's axis I in the plane, from quaternions (..., 4), w x y z, body to world."""
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    return np.asarray(np.arctan2(2 * (x * y + w * z), w * w + x * x - y * y - z * z))


def deviation(scene: Scene, panels: Panels) -> Deviation:
    """Return the deviation of a motion of a scene's body on its plane from the motion that the scene determines.

    Parameters
    ----------
    scene
        The scene, with a plane and a body that lies flat.
    panels
        The motion.

    Returns
    -------
    Deviation
        The estimated errors.

    Raises
    ------
    OutOfReach
        If the errors, or intermediate results, exceed the range of doubles.
    """
    try:
        with within_range("the error of the slide"):
            return _deviation(scene, panels)
    except np.linalg.LinAlgError as error:
        raise OutOfReach(f"the error of the slide cannot be estimated: {error}") from error


def _deviation(scene: Scene, panels: Panels) -> Deviation:
    """The deviation, as in `deviation`; raises `LinAlgError` if the trapezoidal rule for the errors is singular."""
    body = flat(scene)
    # Angles times the radius of gyration are lengths.
    units = np.array([1.0, 1.0, body.gyration, 1.0, 1.0, body.gyration])
    ends, nodes = panels.rows * units, panels.node_rows * units
    count = len(panels.weights)
    caused = np.empty_like(nodes)
    caused[..., :3] = nodes[..., 3:]
    flattened = accelerations(body, panels.node_rows[..., 2].ravel(), nodes[..., 3:].reshape(-1, 3))
    caused[..., 3:] = flattened.reshape(count, PANEL_NODES, 3)

    def missing(change: Array, late: Array, integral: Array, rates: Array) -> Array:
        # If the times of a motion are later than the weights say, the motion has moved on in the meantime.
        return np.asarray(change - integral - rates * late[..., None])

    weights = panels.weights
    defects = missing(
        np.diff(ends, axis=0),
        np.diff(panels.times) - weights.sum(axis=1),
        np.einsum("nq,nqc->nc", weights, caused),
        caused[:, -1],
    )
    partial = PARTIAL_WEIGHTS * weights[:, None, :]
    within = missing(
        nodes - ends[:-1, None],
        panels.node_times - panels.times[:-1, None] - partial.sum(axis=2),
        np.einsum("nkq,nqc->nkc", partial, caused),
        caused,
    )
    start = (panels.rows[0] - planar_start(scene)) * units
    full_turn = 2 * math.pi * body.gyration
    start[2] -= full_turn * round(start[2] / full_turn)
    # The trapezoidal rule for a small error e: e1 - e0 = M dt (e0 + e1)/2 + defect.
    half = _rates_of_errors(body, panels, nodes, caused) * (weights.sum(axis=1) / 2)[:, None, None]
    implicit = np.linalg.inv(np.eye(6) - half)
    carried = _carried(start, np.einsum("nij,nj->ni", implicit, defects), implicit @ (np.eye(6) + half))
    within = np.abs(within).max(axis=1, initial=0.0)
    return Deviation(carried / units, within / units, body.gyration, least_braking(body))


def least_braking(body: Flat) -> float:
    """Half the smaller of the decelerations (m/s^2) of |u| in a straight slide and in a pure spin.

    The power of friction divided by |u| is a convex function of the velocities and, for a symmetrical face, an even function of
    the spin and of the velocity. So the deceleration is at least 1/sqrt(2) of the smaller of the two; the remaining margin is
    for pressures that shift.
    """
    pure = accelerations(body, np.zeros(2), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    return float(np.hypot.reduce(pure, axis=1).min()) / 2  # squares of strong friction would overflow


def _rates_of_errors(body: Flat, panels: Panels, nodes: Array, caused: Array) -> Array:
    """The matrices (n, 6, 6) M of the equations de/dt = M e of a small error e, at the middle node of each panel."""
    middle = PANEL_NODES // 2
    yaw, velocity, acceleration = panels.node_rows[:, middle, 2], nodes[:, middle, 3:], caused[:, middle, 3:]
    count = len(yaw)
    step = DERIVATIVE_STEP * np.linalg.norm(velocity, axis=1)
    changed = velocity[:, None] + step[:, None, None] * np.eye(3)
    moved = accelerations(body, np.repeat(yaw, 3), changed.reshape(-1, 3)).reshape(count, 3, 3)
    by_velocity = np.moveaxis((moved - acceleration[:, None]) / np.where(step > 0, step, np.inf)[:, None, None], 1, 2)
    # Friction turns with the body: turning the body alone is the same as turning everything and turning the velocity back.
    by_yaw = -by_velocity[:, :, 1] * velocity[:, :1] + by_velocity[:, :, 0] * velocity[:, 1:2]
    by_yaw[:, 0] -= acceleration[:, 1]
    by_yaw[:, 1] += acceleration[:, 0]
    rates = np.zeros((count, 6, 6))
    rates[:, :3, 3:] = np.eye(3)
    rates[:, 3:, 3:] = by_velocity
    rates[:, 3:, 2] = by_yaw / body.gyration
    return rates


def _carried(start: Array, defects: Array, propagators: Array) -> Array:
    """The errors (n + 1, 6) that follow from an error at the start (6,), the defects (n, 6) and the propagators (n, 6, 6)."""
    errors = np.empty((len(defects) + 1, 6))
    errors[0] = start
    for i, (propagator, defect) in enumerate(zip(propagators, defects, strict=True)):
        errors[i + 1] = propagator @ errors[i] + defect
    return errors
