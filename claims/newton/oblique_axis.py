"""Print where a body is (m) that falls for 0.5 s along an oblique slide in Newton's XPBD: (0, -0.5886, -0.7848) in mechanics.

The slide is given by an oblique axis, and by frames that are turned so that one of their axes lies along it.
"""

import newton
import numpy as np
import warp as wp

AXIS, STEP = (0.0, 0.6, 0.8), 1e-3
NO_TURN, TO_AXIS = wp.quat_identity(), wp.quat_between_vectors(wp.vec3(1.0, 0.0, 0.0), wp.vec3(*AXIS))

for name, axis, turn in (("oblique", AXIS, NO_TURN), ("turned", (1.0, 0.0, 0.0), TO_AXIS)):
    builder, frame = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81)), wp.transform((0.0, 0.0, 0.0), turn)
    link = builder.add_link(mass=1.0, inertia=wp.mat33(*np.diag([0.01] * 3).ravel().tolist()), lock_inertia=True)
    ends = {"parent_xform": frame, "child_xform": frame, "axis": axis}
    builder.add_articulation([builder.add_joint_prismatic(-1, link, **ends)])
    model = builder.finalize(device="cpu")
    solver, state, after = newton.solvers.SolverXPBD(model), model.state(), model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    for _ in range(round(0.5 / STEP)):
        state, after = (solver.step(state, after, model.control(), None, STEP), after, state)[1:]
    _, y, z = (float(part) for part in state.body_q.numpy()[0, :3])
    print(f"{name}_y {y:.4f}\n{name}_z {z:.4f}")
