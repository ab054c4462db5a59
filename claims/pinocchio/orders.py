"""Print the orders of two schemes that users write with Pinocchio, from attitude errors within 10 s of OSRF's tumbling box."""

import numpy as np
import pinocchio as pin

model, exact, before = pin.Model(), None, 1.0
model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "body")
model.appendBodyToJoint(1, pin.Inertia.FromBox(10.0, 0.1, 0.4, 0.9), pin.SE3.Identity())
data = model.createData()
for name, count in (("exact", 20), ("twist", 5), ("twist", 10), ("naive", 5), ("naive", 10)):  # steps in 10 ms
    q, v, h, path = np.array([0, 0, 0, 0, 0, 0, 1.0]), np.array([-2.0, 2, 8, 0.1, 5, 0.1]), 0.01 / count, []
    for _ in range(1000 * count):
        slopes = [(v, pin.aba(model, data, q, v, 0 * v).copy())]
        for part in () if name == "twist" else (0.5, 0.5, 1.0):
            there, w = pin.integrate(model, q, part * h * slopes[-1][0]), v + part * h * slopes[-1][1]
            u = w if name == "naive" else pin.dDifference(model, q, there, pin.ARG1) @ w  # in the tangent space at q
            slopes.append((u, pin.aba(model, data, there, w, 0 * v).copy()))
        du, dv = np.tensordot([1.0] if name == "twist" else [1 / 6, 1 / 3, 1 / 3, 1 / 6], slopes, 1)
        q, v = pin.integrate(model, q, h * (v + h * dv if name == "twist" else du)), v + h * dv
        path.append(q)
    path = np.array(path)[count - 1 :: count, 3:]
    exact = path if exact is None else exact
    error = 4 * np.arcsin(np.min([np.linalg.norm(path - sign * exact, axis=1) for sign in (1, -1)], axis=0).max() / 2)
    print(name, np.log2(before / (error or 1.0)))
    before = error or 1.0
