"""The kinetic energy that a body without forces loses in a second in Newton's solvers; it spins about z at 10 rad/s."""

import newton
import numpy as np
import warp as wp

wp.set_device("cpu")
STEP, SPIN = 0.002, 10.0


def lost(name, **arguments):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    newton.solvers.SolverSteel.register_custom_attributes(builder)
    tensor = wp.mat33(*np.diag([0.3, 0.4, 0.6]).ravel().tolist())
    body = builder.add_link(mass=1.0, inertia=tensor, lock_inertia=True)
    builder.add_articulation([builder.add_joint_free(body)])
    builder.joint_qd[:], builder.body_qd[body] = [0.0] * 5 + [SPIN], wp.spatial_vector(0.0, 0.0, 0.0, 0.0, 0.0, SPIN)
    builder.color()
    model = builder.finalize()
    solver, state, after = getattr(newton.solvers, f"Solver{name}")(model, **arguments), model.state(), model.state()
    for number in range(round(1.0 / STEP)):  # an even number of steps, so that the last one ends in `state`
        solver.step(*((after, state) if number % 2 else (state, after)), model.control(), None, STEP)
    return 1 - (state.body_qd.numpy()[0, 5] / SPIN) ** 2


for name in ("SemiImplicit", "Steel", "Featherstone", "VBD"):
    print(f"{name} {lost(name):.4g}")
print(f"SemiImplicit_undamped {lost('SemiImplicit', angular_damping=0.0):.4g}")
print(f"Featherstone_given_0_5 {lost('Featherstone', angular_damping=0.5):.4g}")
