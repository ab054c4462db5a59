"""Print how far a hinge at 2 rad/s goes beyond a limit of 40 N m/rad and 0.3 N m s/rad in Newton, and what returns."""

import functools

import newton
import numpy as np
import warp as wp

SOFTEST = {"custom_attributes": {"mujoco:solimplimit": [(1e-4, 1e-4, 1e-3, 0.5, 1.0)]}}


def limited(make, damping, chosen):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    link = builder.add_link(mass=1.0, inertia=wp.mat33(*np.diag([0.01] * 3).ravel().tolist()), lock_inertia=True)
    limit = {"limit_lower": -1.0, "limit_upper": 0.1, "limit_ke": 40.0, "limit_kd": damping, "armature": 0.0, "friction": 0.0}
    builder.add_articulation([builder.add_joint_revolute(-1, link, axis=(0.0, 1.0, 0.0), **limit, **chosen)])
    builder.joint_qd[0] = 2.0
    model, angles = builder.finalize(device="cpu"), []
    solver, state, after = make(model), model.state(), model.state()
    for _ in range(1500):
        state, after = (solver.step(state, after, model.control(), None, 2e-4), after, state)[1:]
        angles.append(float(state.joint_q.numpy()[0]))
    return max(angles) - 0.1, -float(state.joint_qd.numpy()[0]) / 2


mujoco = functools.partial(newton.solvers.SolverMuJoCo, integrator="rk4")
runs = {"featherstone": limited(newton.solvers.SolverFeatherstone, 0.3, {}), "own": limited(mujoco, 0.3, {})}
for name, values in {**runs, "softest": limited(mujoco, 0.3, SOFTEST), "undamped": limited(mujoco, 0.0, SOFTEST)}.items():
    print("{0}_beyond {1:.6g}\n{0}_returned {2:.6g}".format(name, *values))
