"""Print which of Pinocchio's algorithms take a model with a mimic joint."""

import numpy as np
import pinocchio as pin

plain, inertia = pin.Model(), pin.Inertia(1.0, np.zeros(3), np.diag([0.02, 0.025, 0.03]))
for name in ("leader", "follower"):
    joint = plain.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), name)
    plain.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
model = pin.transformJointIntoMimic(plain, 1, 2, 2.0, 0.0)
data, zero = model.createData(), np.zeros(1)
calls = {
    "crba": lambda: pin.crba(model, data, zero),
    "nonLinearEffects": lambda: pin.nonLinearEffects(model, data, zero, zero),
    "aba": lambda: pin.aba(model, data, zero, zero, zero),
    "computeMinverse": lambda: pin.computeMinverse(model, data, zero),
    "initConstraintDynamics": lambda: pin.initConstraintDynamics(
        model, data, pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    ),
}
for name, call in calls.items():
    try:
        call()
        print(name, "supported")
    except Exception as error:
        print(name, "refused" if "does not support Joint Mimic" in str(error) else "fails")
print("inertia", pin.crba(model, data, zero)[0, 0])
