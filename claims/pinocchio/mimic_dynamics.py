"""Print whether aba of Pinocchio takes a mimic joint, and how far crba is from rnea if this joint carries two branches."""

import numpy as np
import pinocchio as pin

plain, inertia = pin.Model(), pin.Inertia(1.0, np.array([0.1, 0.2, 0.3]), np.diag([0.02, 0.025, 0.03]))
for parent, name in ((0, "leader"), (0, "follower"), (2, "one"), (2, "two")):
    joint = plain.addJoint(parent, pin.JointModelRX(), pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])), name)
    plain.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
model = pin.transformJointIntoMimic(plain, 1, 2, 2.0, 0.0)
data, zero = model.createData(), np.zeros(3)
q = np.array([0.3, 0.2, 0.1])
try:
    pin.aba(model, data, q, zero, zero)
    print("aba taken")
except Exception:
    print("aba refused")
upper = np.triu(pin.crba(model, data, q))
by_crba = upper + np.triu(upper, 1).T
rest = pin.rnea(model, data, q, zero, zero).copy()
by_rnea = np.array([pin.rnea(model, data, q, zero, unit) - rest for unit in np.eye(3)])
print("crba", abs(by_crba - by_rnea).max())
full = pin.crba(plain, plain.createData(), np.array([0.3, 0.6, 0.2, 0.1]))
full = np.triu(full) + np.triu(full, 1).T
ratios = np.array([[1, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 1]])
print("rnea", abs(ratios.T @ full @ ratios - by_rnea).max())
