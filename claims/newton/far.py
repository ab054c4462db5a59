"""The spin about z (rad/s) of a brick after 0.5 s in Newton's Featherstone and XPBD, by its distance from the origin."""

import newton
import numpy as np
import warp as wp

wp.set_device("cpu")
STEP = 0.002


def spin(name, distance):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    tensor, pose = (
        wp.mat33(*np.diag([13.0, 10.0, 5.0]).ravel().tolist()) / 300.0,
        wp.transform((distance, 0, 0), wp.quat_identity()),
    )
    body = builder.add_link(xform=pose, mass=1.0, inertia=tensor, lock_inertia=True)
    builder.add_articulation([builder.add_joint_free(body)])
    builder.joint_qd[:], builder.body_qd[body] = [0.0] * 3 + [6.0, 2.0, 4.0], wp.spatial_vector(0.0, 0.0, 0.0, 6.0, 2.0, 4.0)
    model = builder.finalize()
    solver, state, after = getattr(newton.solvers, f"Solver{name}")(model), model.state(), model.state()
    for number in range(round(0.5 / STEP)):
        solver.step(*((after, state) if number % 2 else (state, after)), model.control(), None, STEP)
    return (after if round(0.5 / STEP) % 2 else state).body_qd.numpy()[0, 5]


for distance in (0, 100, 200, 250, 300, 1000):
    print(f"featherstone_{distance} {(after := spin('Featherstone', float(distance))):.5g}")
    print(f"status_{distance} {'ok' if np.isfinite(after) else 'diverged'}")
    print(f"xpbd_{distance} {spin('XPBD', float(distance)):.5g}")
