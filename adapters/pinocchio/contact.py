"""Step a brick that touches a plane at its four lower corners by Pinocchio's rigid contacts, solved by ADMM in every step.

The velocities and impulses at the end of a step solve the nonlinear complementarity problem. The normal velocity of a corner is
limited such that the corner ends on the plane or above it. In units of the weight's impulse m g h and of the velocity g h, the
solver's work and accuracy are the same for every mass and time step. A contact's frame is the world frame and its point is
fixed in the body, so only the data of the contact models change.

The load of a rigid body on four corners is statically indeterminate: load can be moved from two opposite corners to the other
two corners without any effect except on the friction of corners that slide in different directions. ADMM converges to a
solution near its initial guess. The guess is the impulses of the previous step, rotated with the body, without their
alternating part. The alternating part of the solution then vanishes with the time step, and the load becomes linear.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import EngineDiverged, SceneUnsupported
from bodycheck.adapters.pinocchio.joints import UNIVERSE, Joints, Step
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Plane, Scene, State
from bodycheck.reference.trajectory import Array

#: Tolerance of the impulses and velocities at contacts, in units of the weight's impulse m g h and of the velocity g h.
#:
#: It is this tight because a brick at rest creeps with the remaining error, of the order of 1e-15 m/s.
SOLVER_TOLERANCE = 1e-13

#: Rounding error relative to the initial velocities. If it exceeds the tolerance, ADMM cannot reach the tolerance.
SPEED_ROUNDING = 16 * float(np.finfo(float).eps)

#: ADMM's penalty at the start of a step, in the same units; the solver adapts it by factors of two.
#:
#: It is about twice the largest eigenvalue of the Delassus matrix, which for a homogeneous brick on its four corners lies
#: between 12 and 16 for all lengths of the brick.
INITIAL_PENALTY = 32.0

#: Whether the installed release has point contacts.
HAS_POINT_CONTACTS = hasattr(pin, "PointContactConstraintModel")

#: Residual, in the same units, above which a step violates its contact model. A smaller residual only means a stalled solver.
STALL_RESIDUAL = 1e-6


def point_contacts(model: pin.Model, joint: int, points: Array, frictions: Sequence[float]) -> tuple[Any, Any]:
    """Return Pinocchio's models of the contacts of points (n, 3), m, in the frame of a joint with the world, and their data."""
    models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
    for place, friction in zip(points, frictions, strict=True):
        point = pin.SE3(np.eye(3), place)
        contact = pin.PointContactConstraintModel(model, UNIVERSE, pin.SE3.Identity(), joint, point)
        contact.setFriction(friction)
        models.append(pin.ConstraintModel(contact))
        datas.append(models[-1].createData())
    return models, datas


def residual_of(
    admm: Any, contacts: tuple[Any, Any], delassus: Array, drift: Array, settings: "pin.ADMMSolverSettings", result: Any
) -> float:
    """Return the residual at which ADMM stops, from the guess that its result has; 0 where it reaches its tolerance."""
    if admm.solve(pin.DelassusOperatorDense(delassus), drift, *contacts, settings, result):
        return 0.0
    return float(max(result.primal_feasibility, result.dual_feasibility, result.complementarity))


def set_tolerance(settings: "pin.ADMMSolverSettings", tolerance: float) -> None:
    """Set the tolerance of the impulses and velocities at contacts."""
    settings.absolute_feasibility_tol = settings.relative_feasibility_tol = tolerance
    settings.absolute_complementarity_tol = settings.relative_complementarity_tol = tolerance


class Solver:
    """ADMM on the contacts of one body, called once a step; impulses are in units of m g h and velocities in units of g h."""

    def __init__(self, models: Any, datas: Any, settings: "pin.ADMMSolverSettings", timestep: float) -> None:
        self._contacts, self._settings, self._timestep = (models, datas), settings, timestep
        self._admm, self._result = pin.ADMMConstraintSolver(3 * len(models)), pin.ADMMSolverResult()
        self._steps = 0

    def impulses(self, delassus: Array, drift: Array, guess: Array) -> Array:
        """Return the impulses (3n,) at n contacts.

        delassus: (3n, 3n), from impulses to velocities. drift: (3n,), the velocities at the contacts without any impulse.
        guess: (3n,), from which ADMM starts. Raises `EngineDiverged` if ADMM finds no solution.
        """
        self._steps += 1
        self._result.setConstraintImpulseGuess(guess)
        residual = residual_of(self._admm, self._contacts, delassus, drift, self._settings, self._result)
        if not residual < STALL_RESIDUAL:
            time = self._steps * self._timestep
            raise EngineDiverged(f"ADMM stops at a residual of {residual:.3g} at t = {time:.6g} s")
        return np.asarray(self._result.retrieveConstraintImpulses())


def rigid_contact(scene: Scene, plane: Plane, joints: Joints, data: pin.Data, timestep: float) -> Step:
    """Return the step of a brick with a rigid point contact with Coulomb friction at each of its four lower corners.

    Parameters
    ----------
    scene
        The scene with the brick.
    plane
        The plane with the coefficient of friction.
    joints
        Separate joints for translation and rotation, with gravity.
    data
        The data of their model in which the step computes.
    timestep
        The time step (s).

    Raises
    ------
    SceneUnsupported
        For a body without corners, and for a release without point contacts.
    EngineDiverged
        From the returned step, if ADMM finds no solution.
    """
    if not HAS_POINT_CONTACTS:
        raise SceneUnsupported(f"contact: Pinocchio {pin.__version__} has no point contacts")
    shape, gravity = scene.body.shape, scene.gravity
    if not isinstance(shape, Brick):
        raise SceneUnsupported(f"admm has contacts at corners, which {describe_shape(shape)} does not have")
    model, joint = joints.model, joints.joint
    no_force = np.zeros(6)
    a, b, c = shape.semi_axes
    corners = np.array([[a, b, -c], [-a, b, -c], [-a, -b, -c], [a, -b, -c]])
    models, datas = point_contacts(model, joint, corners, [plane.friction] * len(corners))
    contacts = list(zip(models, datas, strict=True))

    speed = gravity * timestep
    solver = Solver(models, datas, solver_settings(shape, scene.initial, speed), timestep)
    alternating = np.array([0.5, -0.5, 0.5, -0.5])
    # The guess is kept in the body frame; at the start each corner bears a quarter of the weight.
    guess = np.tile([0.0, 0.0, 0.25], (4, 1))
    # For these velocities the mass matrix does not depend on the configuration; here it is in units of the mass.
    inverse_mass = scene.body.mass * pin.computeMinverse(model, data, pin.neutral(model))

    def step(q: Array, v: Array) -> tuple[Array, Array]:
        v = v + timestep * pin.aba(model, data, q, v, no_force)
        pin.computeJointJacobians(model, data, q)
        for contact, state in contacts:
            contact.calc(model, data, state)
        jacobian = pin.getConstraintsJacobian(model, data, models, datas)
        response = inverse_mass @ jacobian.T
        turn = data.oMi[joint].rotation
        drift = jacobian @ (v / speed)
        drift[2::3] += (q[2] + corners @ turn[2]) / (speed * timestep)
        impulses = solver.impulses(jacobian @ response, drift, (guess @ turn.T).ravel())
        np.matmul(impulses.reshape(4, 3), turn, out=guess)
        guess[:, 2] -= (alternating @ guess[:, 2]) * alternating
        v = v + response @ (speed * impulses)
        return pin.integrate(model, q, timestep * v), v

    return step


def solver_settings(shape: Brick, initial: State, velocity: float) -> "pin.ADMMSolverSettings":
    """Return ADMM's settings for the contacts of a brick; `velocity` is the unit g h (m/s) of the velocities at contacts."""
    fastest = math.hypot(*initial.velocity) + math.hypot(*initial.angular_velocity) * math.hypot(*shape.semi_axes)
    tolerance = max(SOLVER_TOLERANCE, SPEED_ROUNDING * fastest / velocity)
    settings = pin.ADMMSolverSettings()
    settings.solve_ncp = True
    set_tolerance(settings, tolerance)
    settings.rho_init, settings.admm_update_rule = INITIAL_PENALTY, pin.ADMMUpdateRule.LINEAR
    return settings
