"""Print how far (m) a cube slides within a minute with Pinocchio's rigid contacts, at 0.99 of the slope that friction holds."""

import numpy as np
import pinocchio as pin

H, SLOPE, CORNERS = 0.002, np.arctan(0.99 * 0.5), 0.1 * np.array([[1, 1, -1], [-1, 1, -1], [-1, -1, -1], [1, -1, -1]])
model, fixed = pin.Model(), pin.SE3.Identity()
model.addJoint(0, pin.JointModelTranslation(), fixed, "place")
model.addJoint(1, pin.JointModelSpherical(), fixed, "turn")
model.appendBodyToJoint(2, pin.Inertia.FromBox(1.0, 0.2, 0.2, 0.2), fixed)
model.gravity.linear, data = 9.81 * np.array([np.sin(SLOPE), 0, -np.cos(SLOPE)]), model.createData()
models, states, settings = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData(), pin.ADMMSolverSettings()
for corner in CORNERS:
    contact = pin.PointContactConstraintModel(model, 0, fixed, 2, pin.SE3(np.eye(3), corner))
    contact.setFriction(0.5)
    models.append(pin.ConstraintModel(contact))
    states.append(models[-1].createData())
settings.solve_ncp, settings.absolute_feasibility_tol, settings.absolute_complementarity_tol = True, 1e-13, 1e-13
q, v, solver, result = np.array([0, 0, 0.1, 0, 0, 0, 1.0]), np.zeros(6), pin.ADMMConstraintSolver(12), pin.ADMMSolverResult()
for _ in range(30000):
    v = v + H * pin.aba(model, data, q, v, np.zeros(6))
    pin.computeJointJacobians(model, data, q)
    _ = [contact.calc(model, data, state) for contact, state in zip(models, states, strict=True)]
    jacobian, inverse_mass = pin.getConstraintsJacobian(model, data, models, states), pin.computeMinverse(model, data, q)
    drift = jacobian @ v
    drift[2::3] += (q[2] + CORNERS @ data.oMi[2].rotation[2]) / H
    solver.solve(pin.DelassusOperatorDense(jacobian @ inverse_mass @ jacobian.T), drift, models, states, settings, result)
    v = v + inverse_mass @ jacobian.T @ np.asarray(result.retrieveConstraintImpulses())
    q = pin.integrate(model, q, H * v)
print("admm", np.linalg.norm(q[:2]))
