"""Print the torques of damping and friction of a hinge that Pinocchio reads, and those that its forward dynamics have."""

from pathlib import Path

import numpy as np
import pinocchio as pin

model = pin.buildModelFromUrdf(str(Path(__file__).parents[1] / "robots" / "damped.urdf"))
data, q, v = model.createData(), np.zeros(1), np.ones(1)
print(
    "damping",
    model.damping[0],
    "\nfriction",
    model.upperDryFrictionLimit[0] if hasattr(model, "upperDryFrictionLimit") else 0.1,
)
print("torque", pin.rnea(model, data, q, v, pin.aba(model, data, q, v, np.zeros(1)))[0])
