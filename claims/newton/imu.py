"""Newton's IMU and wrench at the centre of mass of an arm that turns at 5 rad/s about a vertical hinge 0.5 m beside it."""

import newton
import numpy as np
import warp as wp

wp.set_device("cpu")
KIND = newton.solvers.SolverBase.ObservableKind
for name, step in (("2ms", 0.002), ("1ms", 0.001)):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81))
    inertia = wp.mat33(0.02, 0, 0, 0, 0.08, 0, 0, 0, 0.09)
    link = builder.add_link(com=wp.vec3(0.5, 0, 0), mass=3.0, inertia=inertia, lock_inertia=True)
    builder.add_articulation([builder.add_joint_revolute(-1, link, axis=(0, 0, 1))])
    builder.joint_qd[0], builder.body_qd[link] = 5.0, (0, 2.5, 0, 0, 0, 5.0)
    builder.add_site(link, xform=wp.transform((0.5, 0, 0), wp.quat_identity()), label="imu")
    model = builder.finalize()
    imu = newton.sensors.SensorIMU(model, "imu", request_state_attributes=False)
    solver = newton.solvers.SolverMuJoCo(model, integrator="euler")
    seen = solver.observables(kinds={KIND.BODY_QDD, KIND.BODY_PARENT_F})
    before, after = model.state(), model.state()
    for _ in range(3):
        before.clear_forces()
        solver.step(before, after, model.control(), None, step, observables=seen)
        before, after = after, before
        imu.update(before, observables=seen)
    print(f"across_{name} {imu.accelerometer.numpy()[0][1]:.5g}")
    print(f"moment_{name} {np.linalg.norm(seen.body_parent_f.numpy()[0][3:]):.3g}")
    print(f"force_{name} {np.hypot(*seen.body_parent_f.numpy()[0][:2]):.5g}")
