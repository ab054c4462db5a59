"""Pinocchio's own rigid contact: a brick on the four lower corners of its plane face, solved by ADMM in every step."""

import itertools
import math

import numpy as np
import pinocchio as pin

from bodycheck.adapters.contract import EngineDiverged, SceneUnsupported
from bodycheck.adapters.pinocchio.joints import UNIVERSE, Joints, Step
from bodycheck.reference.planar import describe_shape
from bodycheck.reference.scene import Brick, Plane, Scene, State
from bodycheck.reference.trajectory import Array

#: Of the impulses and velocities at contacts, in units of the weight's impulse m g h and of g h, the velocity that it stops.
#:
#: So tight because a brick that has come to rest creeps with what is left, of the order of 1e-15 m/s.
TOLERANCE = 1e-13

#: Of the initial velocities: what ADMM cannot fall below where that is more than the tolerance.
ROUNDING = 16 * float(np.finfo(float).eps)

#: ADMM's at the start of a step, in these units; from there it is adapted by factors of two.
#:
#: It is some two times the largest eigenvalue of the Delassus matrix, which for a homogeneous brick on its four corners is
#: between 12 and 16 whatever the lengths.
PENALTY = 32.0

AVAILABLE = hasattr(pin, "PointContactConstraintModel")

#: Residual, in the same units, above which a step is not what its contact model says; below it, the solver has stalled.
UNSOLVED = 1e-6


def rigid_contact(scene: Scene, plane: Plane, joints: Joints, timestep: float) -> Step:
    """The step of a brick with a rigid point contact with Coulomb friction at each of its four lower corners.

    joints: for translation and rotation apart, under gravity.

    Velocities and impulses at the end of the step solve the nonlinear complementarity problem, by ADMM. The normal velocity
    of a corner is limited so that the corner ends on the plane or above it. In units of the weight's impulse m g h and of
    g h the solver's work and accuracy are the same for every mass and time step.

    A contact's frame is the world's and its point is fixed in the body: the models never change, only their data do.

    How a rigid body spreads its load over four corners is not determined: adding to the loads of two opposite corners what
    is taken from the others changes nothing but, where the corners slide in different directions, the friction. ADMM ends
    near where it starts. It starts from the impulses of the step before, turned with the body and without that alternating
    part, of which the solution then has the less the smaller the step is. In the limit the load is the linear one.

    Raises `SceneUnsupported` for bodies without corners; the step raises `EngineDiverged` where ADMM finds no solution.
    """
    if not AVAILABLE:
        raise SceneUnsupported(f"contact: Pinocchio {pin.__version__} has no point contacts")
    shape, gravity = scene.body.shape, scene.gravity
    if not isinstance(shape, Brick):
        raise SceneUnsupported(f"admm has contacts at corners, which {describe_shape(shape)} does not have")
    model, joint = joints.model, joints.joint
    data, no_force = model.createData(), np.zeros(6)
    a, b, c = shape.semi_axes
    corners = np.array([[a, b, -c], [-a, b, -c], [-a, -b, -c], [a, -b, -c]])
    models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
    for corner in corners:
        point = pin.SE3(np.eye(3), corner)
        contact = pin.PointContactConstraintModel(model, UNIVERSE, pin.SE3.Identity(), joint, point)
        contact.setFriction(plane.friction)
        models.append(pin.ConstraintModel(contact))
        datas.append(models[-1].createData())
    contacts = list(zip(models, datas, strict=True))

    speed = gravity * timestep
    settings = solver_settings(shape, scene.initial, speed)
    solver, result = pin.ADMMConstraintSolver(corners.size), pin.ADMMSolverResult()
    alternating = np.array([0.5, -0.5, 0.5, -0.5])
    guess = np.tile([0.0, 0.0, 0.25], (4, 1))  # a quarter of the weight on each corner; in the body frame, as it is carried on
    # In these velocities the mass matrix is the same in all configurations; in units of m, it has none.
    inverse_mass = scene.body.mass * pin.computeMinverse(model, data, pin.neutral(model))
    numbers = itertools.count(1)

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
        result.setConstraintImpulseGuess((guess @ turn.T).ravel())
        number = next(numbers)
        if not solver.solve(pin.DelassusOperatorDense(jacobian @ response), drift, models, datas, settings, result):
            residual = max(result.primal_feasibility, result.dual_feasibility, result.complementarity)
            if not residual < UNSOLVED:
                raise EngineDiverged(f"ADMM stops at a residual of {residual:.3g} at t = {number * timestep:.6g} s")
        impulses = result.retrieveConstraintImpulses()
        np.matmul(impulses.reshape(4, 3), turn, out=guess)
        guess[:, 2] -= (alternating @ guess[:, 2]) * alternating
        v = v + response @ (speed * impulses)
        return pin.integrate(model, q, timestep * v), v

    return step


def solver_settings(shape: Brick, initial: State, velocity: float) -> "pin.ADMMSolverSettings":
    """How ADMM solves the contacts of a brick that starts from some state, in units of m g h and the velocity g h (m/s)."""
    fastest = math.hypot(*initial.velocity) + math.hypot(*initial.angular_velocity) * math.hypot(*shape.semi_axes)
    tolerance = max(TOLERANCE, ROUNDING * fastest / velocity)
    settings = pin.ADMMSolverSettings()
    settings.solve_ncp = True
    settings.absolute_feasibility_tol = settings.relative_feasibility_tol = tolerance
    settings.absolute_complementarity_tol = settings.relative_complementarity_tol = tolerance
    settings.rho_init, settings.admm_update_rule = PENALTY, pin.ADMMUpdateRule.LINEAR
    return settings
