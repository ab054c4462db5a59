"""Print how far (m) the contacts of Newton's XPBD and MuJoCo let a block on a ramp slide from its exact place in 4 s."""

import newton
import numpy as np
import warp as wp

cos, turn = 1 / np.sqrt(1 + 0.505**2), wp.quat(0.0, 0.23169506402341308, 0.0, 0.9727884648304514)
start, inertia = (0.02253902856401292, 0.0, 0.044631739730718656), [0.0041666666666666675] * 2 + [0.006666666666666667]
for name, make in (
    ("xpbd", lambda model: newton.solvers.SolverXPBD(model, iterations=10)),
    ("mujoco", lambda model: newton.solvers.SolverMuJoCo(model, integrator="implicitfast")),
    ("kept", lambda model: newton.solvers.SolverMuJoCo(model, integrator="implicitfast", update_data_interval=0)),
):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81))
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    shape = newton.ModelBuilder.ShapeConfig(mu=0.5, mu_torsional=0.0, mu_rolling=0.0)
    builder.add_shape_plane(plane=(0.505 * cos, 0.0, cos, 0.0), width=0.0, length=0.0, cfg=shape)
    tensor = wp.mat33(*np.diag(inertia).ravel().tolist())
    block = builder.add_link(xform=wp.transform(start, turn), mass=1.0, inertia=tensor, lock_inertia=True)
    builder.add_articulation([builder.add_joint_free(block)])
    builder.add_shape_box(block, hx=0.1, hy=0.1, hz=0.05, cfg=shape)
    model = builder.finalize(device="cpu", skip_validation_inertia=True)
    pipeline, solver, state, after, far = newton.CollisionPipeline(model), make(model), model.state(), model.state(), [0.0]
    contacts = pipeline.contacts()
    for number in range(1, 2001):
        pipeline.collide(state, contacts)
        solver.step(state, after, model.control(), contacts if name == "xpbd" else None, 0.002)
        state, after, way = after, state, 9.81 * 0.0025 * (number * 0.002 * cos) ** 2 * np.array([1, 0, -0.505])
        far += [np.linalg.norm(state.body_q.numpy()[0, :3] - np.array(start) - way)] * (number % 5 == 0)
    print(name, max(far))
