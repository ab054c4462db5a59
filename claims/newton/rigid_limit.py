"""Print how far a hinge at 2 rad/s goes beyond its limit in Newton's Steel and XPBD, and which part of its rate returns."""

import newton
import numpy as np
import warp as wp

STEP, ONE = 1e-3, {"joint_linear_relaxation": 1.0, "joint_angular_relaxation": 1.0}


def limited(make, **chosen):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    link = builder.add_link(mass=1.0, inertia=wp.mat33(*np.diag([0.01] * 3).ravel().tolist()), lock_inertia=True)
    limit = {"limit_lower": -1.0, "limit_upper": 0.1, "armature": 0.0, "friction": 0.0}
    builder.add_articulation([builder.add_joint_revolute(-1, link, axis=(0.0, 1.0, 0.0), **limit)])
    builder.joint_qd[0] = 2.0
    model, angles = builder.finalize(device="cpu"), []
    solver, state, after = make(model, **chosen), model.state(), model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    for _ in range(round(0.3 / STEP)):
        state, after = (solver.step(state, after, model.control(), None, STEP), after, state)[1:]
        newton.eval_ik(model, state, state.joint_q, state.joint_qd)
        angles.append(float(state.joint_q.numpy()[0]))
    return max(angles) - 0.1, -float(state.joint_qd.numpy()[0]) / 2


steel, xpbd = newton.solvers.SolverSteel, newton.solvers.SolverXPBD
runs = {"steel": limited(steel), "enabled": limited(steel, enable_joint_limits=True)}
for name, values in {**runs, "xpbd": limited(xpbd), "xpbd_1": limited(xpbd, **ONE)}.items():
    print("{0}_beyond {1:.6g}\n{0}_returned {2:.6g}".format(name, *values))
