"""Print the impact of a ball that falls and spins on a plane without friction in Newton's XPBD: its rebound and its spin."""

import newton
import numpy as np
import warp as wp

for name, rate in (("still", 0.0), ("spinning", -44.7213595)):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81))
    shape = newton.ModelBuilder.ShapeConfig(mu=0.0, restitution=0.7, mu_torsional=0.0, mu_rolling=0.0)
    builder.add_ground_plane(cfg=shape)
    tensor = wp.mat33(*np.diag([0.004] * 3).ravel().tolist())
    ball = builder.add_link(xform=wp.transform((0, 0, 0.6), wp.quat_identity()), mass=1.0, inertia=tensor, lock_inertia=True)
    builder.add_articulation([builder.add_joint_free(ball)])
    builder.add_shape_sphere(ball, radius=0.1, cfg=shape)
    builder.body_qd[ball] = 0.0, 0.0, -1.0, 0.0, rate, 0.0
    builder.joint_qd[:] = builder.body_qd[ball]
    model = builder.finalize(device="cpu")
    solver = newton.solvers.SolverXPBD(model, iterations=10, enable_restitution=True)
    pipeline, state, after, falling = newton.CollisionPipeline(model), model.state(), model.state(), -1.0
    contacts = pipeline.contacts()
    while state.body_qd.numpy()[0, 2] < 0:
        falling = state.body_qd.numpy()[0, 2]
        state.clear_forces()
        pipeline.collide(state, contacts)
        solver.step(state, after, model.control(), contacts, 0.002)
        state, after = after, state
    print(name, -state.body_qd.numpy()[0, 2] / falling)
print("spin", -state.body_qd.numpy()[0, 4])
