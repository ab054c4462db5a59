"""The largest angular velocity (rad/s) of two hinged links that fall for 0.2 s in Newton's XPBD; 4.2 in mechanics."""

import newton
import numpy as np
import warp as wp

FACTORS = {"own": {}, "one": {"joint_linear_relaxation": 1.0, "joint_angular_relaxation": 1.0}}
TURNS = {"straight": 0.0, "turned": np.pi / 2}


def largest(angle, factors, step):
    turn = wp.quat_from_axis_angle(wp.vec3(0.0, 0.0, 1.0), angle)  # of the first joint and of both links, about the vertical
    axis, along = (wp.quat_rotate_inv(turn, vector) for vector in (wp.vec3(0.0, 1.0, 0.0), wp.vec3(1.0, 0.0, 0.0)))
    builder, links, joints = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81)), [], []
    for place in (0.0, 0.5):
        pose, tensor = wp.transform((place, 0, 0), turn), wp.mat33(*np.diag([0.01] * 3).ravel().tolist())
        links.append(builder.add_link(xform=pose, mass=1.0, inertia=tensor, com=0.25 * along, lock_inertia=True))
        pose = wp.transform(0.5 * along, wp.quat_identity()) if joints else wp.transform((0, 0, 0), turn)
        joints.append(builder.add_joint_revolute([-1, *links][-2], links[-1], parent_xform=pose, axis=axis))
    builder.add_articulation(joints)
    model, spins = builder.finalize(device="cpu"), []
    solver, state, after = newton.solvers.SolverXPBD(model, **factors), model.state(), model.state()
    for _ in range(round(0.2 / step)):
        state, after = (solver.step(state, after, model.control(), None, step), after, state)[1:]
        spins.append(np.abs(state.body_qd.numpy()[:, 3:]).max())
    return max(spins)


for name, frame, step in ((name, frame, step) for name in FACTORS for frame in TURNS for step in (0.001, 0.00025)):
    print(f"{name}_{frame}_{step * 1e6:.0f} {largest(TURNS[frame], FACTORS[name], step):.4g}")
