"""Print the angle (rad) after 0.3 s of a pendulum that is released from the horizontal, in Newton's XPBD and Featherstone."""

import newton
import numpy as np
import warp as wp

ONE = {"joint_linear_relaxation": 1.0, "joint_angular_relaxation": 1.0}


def fallen(make, step, **chosen):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81))
    tensor = wp.mat33(*np.diag([0.02] * 3).ravel().tolist())
    link = builder.add_link(mass=1.0, com=wp.vec3(0.2, 0.0, 0.0), inertia=tensor, lock_inertia=True)
    builder.add_articulation([builder.add_joint_revolute(-1, link, axis=(0.0, 1.0, 0.0), armature=0.0, friction=0.0)])
    model = builder.finalize(device="cpu")
    solver, state, after = make(model, **chosen), model.state(), model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    for _ in range(round(0.3 / step)):
        state, after = (solver.step(state, after, model.control(), None, step), after, state)[1:]
        state.clear_forces()
    newton.eval_ik(model, state, state.joint_q, state.joint_qd)
    return float(state.joint_q.numpy()[0])


for step in (0.001, 0.00025):
    for name, solver, chosen in (("xpbd", "XPBD", {}), ("xpbd_1", "XPBD", ONE), ("featherstone", "Featherstone", {})):
        print(f"{name}_{step * 1e6:.0f} {fallen(getattr(newton.solvers, f'Solver{solver}'), step, **chosen):.5g}")
