"""The change of the angular momentum of two welded links that spin for 0.4 s in Newton's XPBD, relative to its size."""

import newton
import numpy as np
import warp as wp

PLACE, STEPS = wp.transform((0.4, 0.0, 0.0), wp.quat_identity()), {"0_002": 0.002, "0_0005": 0.0005}
MOMENTS, RELAXED = np.array([0.3, 0.4, 0.6]), {"joint_linear_relaxation": 1.0, "joint_angular_relaxation": 1.0}


def momentum(state):  # about the common centre of mass
    q, v = state.body_q.numpy().astype(float), state.body_qd.numpy().astype(float)
    pairs = [(np.array(wp.quat_to_matrix(wp.quat(*q[body, 3:]))).reshape(3, 3), v[body, 3:]) for body in (0, 1)]
    spins = sum(turn @ (MOMENTS * (turn.T @ spin)) for turn, spin in pairs)
    return np.cross(q[:, :3] - q[:, :3].mean(axis=0), v[:, :3]).sum(axis=0) + spins


for name, factors, written in ((name, factors, step) for name, factors in (("default", {}), ("1", RELAXED)) for step in STEPS):
    builder, tensor = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0)), wp.mat33(*np.diag(MOMENTS).ravel().tolist())
    links = [builder.add_link(mass=1.0, inertia=tensor, lock_inertia=True) for _ in range(2)]
    builder.add_articulation([builder.add_joint_free(links[0]), builder.add_joint_fixed(*links, parent_xform=PLACE)])
    builder.joint_qd[:6] = [0.0, 0.0, 0.0, 6.0, 2.0, 4.0]
    model, step = builder.finalize(device="cpu"), STEPS[written]
    solver, state, after = newton.solvers.SolverXPBD(model, **factors), model.state(), model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    start = momentum(state)
    for number in range(round(0.4 / step)):
        solver.step(*((after, state) if number % 2 else (state, after)), model.control(), None, step)
    print(f"relaxation_{name}_{written} {np.linalg.norm(momentum(state) - start) / np.linalg.norm(start):.5g}")
