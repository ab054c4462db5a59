"""Print the largest errors within 10 s of a brick that spins about its intermediate axis, stepped with Pinocchio by 2 ms."""

import numpy as np
import pinocchio as pin

free, world, fixed, exact, t = pin.Model(), pin.Model(), pin.SE3.Identity(), None, np.arange(1, 1001) / 100
free.addJoint(0, pin.JointModelFreeFlyer(), fixed, "body")  # its velocity is the twist of the body
world.addJoint(world.addJoint(0, pin.JointModelTranslation(), fixed, "place"), pin.JointModelSpherical(), fixed, "turn")
for name in ("exact", "world", "twist", "rk4", "naive"):  # exact: Runge-Kutta 4 with an eighth of the step
    model, parts = world if name == "world" else free, () if name in ("world", "twist") else (0.5, 0.5, 1.0)
    model.inertias[-1] = pin.Inertia(1.0, 0 * t[:3], np.diag([13.0, 5, 10]) / 300)
    data, q, count, path = model.createData(), np.array([0, 0, 0, 0.5**0.5, 0, 0, 0.5**0.5]), 40 if name == "exact" else 5, []
    v, h = np.array([1, 0, 2, 0.1, 0, 10.0] if name == "world" else [1, 2, 0, 0.1, 0, 10.0]), 0.01 / count
    for _ in range(1000 * count):
        slopes = [(v, pin.aba(model, data, q, v, 0 * v).copy())]
        for part in parts:
            there, w = pin.integrate(model, q, part * h * slopes[-1][0]), v + part * h * slopes[-1][1]
            u = w if name == "naive" else pin.dDifference(model, q, there, pin.ARG1) @ w  # in the tangent space at q
            slopes.append((u, pin.aba(model, data, there, w, 0 * v).copy()))
        du, dv = np.tensordot([1 / 6, 1 / 3, 1 / 3, 1 / 6] if parts else [1.0], slopes, 1)
        q, v = pin.integrate(model, q, h * (du if parts else v + h * dv)), v + h * dv
        path.append(q)
    path = np.array(path)[count - 1 :: count]
    exact = path[:, 3:] if exact is None else exact
    chords = np.min([np.linalg.norm(path[:, 3:] - sign * exact, axis=1) for sign in (1, -1)], axis=0)
    print(f"{name}_attitude {4 * np.arcsin(chords.max() / 2)}")
    print(f"{name}_position {np.linalg.norm(path[:, :3] - np.transpose([t, 0 * t, 2 * t - 4.905 * t**2]), axis=1).max()}")
