"""The tip of four links on hinges after 0.2 s in Newton, with bodies in the order of the joints, and in two others."""

import newton
import numpy as np
import warp as wp

MASSES = {"base": 1.3, "arm": 0.8, "hand": 0.4, "tail": 0.2}
wp.set_device("cpu")


def tip(solver_of, order, step=0.001, duration=0.2):
    builder, bodies = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81)), {"world": -1}
    hinge = {"parent_xform": wp.transform((0.1, 0.2, 0.3), wp.quat_identity()), "axis": (0.0, 0.6, 0.8)}
    for name in order:
        mass, tensor = MASSES[name], wp.mat33(*(0.05 * MASSES[name] * np.eye(3)).ravel().tolist())
        bodies[name] = builder.add_link(mass=mass, inertia=tensor, com=(0.05, -0.1, 0.35), lock_inertia=True)
    pairs = (("world", "base"), ("base", "arm"), ("arm", "hand"), ("base", "tail"))
    builder.add_articulation([builder.add_joint_revolute(bodies[a], bodies[b], **hinge) for a, b in pairs])
    builder.joint_qd[:] = [-1.5, 1.1, 2.0, -0.7]
    solver, state, after = solver_of(model := builder.finalize()), model.state(), model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    for number in range(round(duration / step)):  # an even number of steps, so that the last one ends in `state`
        solver.step(*((after, state) if number % 2 else (state, after)), model.control(), None, step)
    return state.body_q.numpy()[bodies["hand"], :3]


ORDERS = {"parents_first": ("base", "tail", "arm", "hand"), "children_first": ("tail", "hand", "arm", "base")}
for name, solver in (("featherstone", newton.solvers.SolverFeatherstone), ("mujoco", newton.solvers.SolverMuJoCo)):
    for order, names in ORDERS.items():
        print(f"{name}_{order} {np.abs(tip(solver, tuple(MASSES)) - tip(solver, names)).max():.4g}")
