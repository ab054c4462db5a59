"""Print the error of the yaw (rad) at which a brick that slides and spins comes to rest with Pinocchio's rigid contacts."""

import numpy as np
import pinocchio as pin

H, CORNERS, EVEN = 0.0005, np.array([[2, 4, -1], [-2, 4, -1], [-2, -4, -1], [2, -4, -1]]) / 20, np.array([0.5, -0.5, 0.5, -0.5])
EXACT = 2.89569  # rad, for friction that acts at all points of the face, see claims/mujoco/curling.py
model, fixed = pin.Model(), pin.SE3.Identity()
model.addJoint(model.addJoint(0, pin.JointModelTranslation(), fixed, "place"), pin.JointModelSpherical(), fixed, "turn")
model.appendBodyToJoint(2, pin.Inertia.FromBox(1.0, 0.2, 0.4, 0.1), fixed)
models, states, settings = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData(), pin.ADMMSolverSettings()
for contact in (pin.PointContactConstraintModel(model, 0, fixed, 2, pin.SE3(np.eye(3), corner)) for corner in CORNERS):
    contact.setFriction(0.5)
    models.append(pin.ConstraintModel(contact))
    states.append(models[-1].createData())
settings.solve_ncp, settings.absolute_feasibility_tol, settings.absolute_complementarity_tol = True, 1e-13, 1e-13
q, v, data = np.array([0, 0, 0.05, 0, 0, 0, 1]), np.array([2.0, 0, 0, 0, 0, 10]), model.createData()
solver, result, guess = pin.ADMMConstraintSolver(12), pin.ADMMSolverResult(), np.tile([0, 0, 9.81 * H / 4], (4, 1))
for _ in range(1600):
    v = v + H * pin.aba(model, data, q, v, 0 * v)
    pin.computeJointJacobians(model, data, q)
    _ = [contact.calc(model, data, state) for contact, state in zip(models, states, strict=True)]
    jacobian, inverse_mass = pin.getConstraintsJacobian(model, data, models, states), pin.computeMinverse(model, data, q)
    drift, guess[:, 2] = jacobian @ v, guess[:, 2] - EVEN @ guess[:, 2] * EVEN  # the loads of corners are not unique
    drift[2::3] += (q[2] + CORNERS @ data.oMi[2].rotation[2]) / H
    result.setConstraintImpulseGuess((guess @ data.oMi[2].rotation.T).ravel())
    solver.solve(pin.DelassusOperatorDense(jacobian @ inverse_mass @ jacobian.T), drift, models, states, settings, result)
    v = v + inverse_mass @ jacobian.T @ (impulses := np.array(result.retrieveConstraintImpulses()))
    q, guess = pin.integrate(model, q, H * v), impulses.reshape(4, 3) @ data.oMi[2].rotation
print("admm", 2 * np.arctan2(q[5], q[6]) - EXACT)
