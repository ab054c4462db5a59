"""Move one mechanism of four links whose bodies are added in several orders. Needs newton[sim] 1.8.0; takes a minute.

The joints are always in depth-first order. The motion of the tips must not depend on the order of the bodies.
"""

import newton
import numpy as np
import warp as wp

wp.config.log_level = wp.LOG_WARNING
wp.set_device("cpu")

#: Each link: its parent, its mass (kg) and the principal moments of its inertia (kg m^2).
LINKS = {
    "base": (None, 1.3, (0.05, 0.06, 0.03)),
    "arm": ("base", 0.8, (0.02, 0.03, 0.02)),
    "hand": ("arm", 0.4, (0.01, 0.01, 0.015)),
    "tail": ("base", 0.2, (0.004, 0.003, 0.005)),
}
ORDERS = {
    "as the joints": ("base", "arm", "hand", "tail"),
    "parents first": ("base", "tail", "arm", "hand"),
    "children first": ("tail", "hand", "arm", "base"),
}


def tips(solver_of, order, step=0.001, duration=0.2):
    """Return the positions (m) of hand and tail at the end."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -9.81))
    bodies = {}
    for name in order:
        _, mass, moments = LINKS[name]
        inertia = wp.mat33(*np.diag(moments).ravel().tolist())
        bodies[name] = builder.add_link(mass=mass, inertia=inertia, com=wp.vec3(0.05, -0.1, 0.35), lock_inertia=True)
    place = wp.transform(wp.vec3(0.1, 0.2, 0.3), wp.normalize(wp.quat(0.2, -0.4, 0.4, 0.8)))
    joints = [
        builder.add_joint_revolute(bodies.get(parent, -1), bodies[name], parent_xform=place, axis=wp.vec3(0.0, 0.6, 0.8))
        for name, (parent, _, _) in LINKS.items()
    ]
    builder.add_articulation(joints)
    builder.joint_qd[:] = [-1.5, 1.1, 2.0, -0.7]
    model = builder.finalize()
    solver, state, following = solver_of(model), model.state(), model.state()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    for _ in range(round(duration / step)):
        state.clear_forces()
        solver.step(state, following, model.control(), None, step)
        state, following = following, state
    poses = state.body_q.numpy()
    return np.concatenate([poses[bodies["hand"], :3], poses[bodies["tail"], :3]])


SOLVERS = {
    "Featherstone": newton.solvers.SolverFeatherstone,
    "MuJoCo, euler": lambda model: newton.solvers.SolverMuJoCo(model, integrator="euler"),
}
print(f"newton {newton.__version__}")
for name, solver_of in SOLVERS.items():
    for order, bodies in ORDERS.items():
        print(f"{name:14} bodies {order:15}", *(f"{number:9.5f}" for number in tips(solver_of, bodies)), flush=True)
apart = [
    np.abs(
        tips(SOLVERS["Featherstone"], ORDERS["children first"], step)
        - tips(SOLVERS["Featherstone"], ORDERS["as the joints"], step)
    ).max()
    for step in (0.002, 0.001, 0.0005)
]
print(
    "Featherstone, children first against the order of the joints, at 2, 1 and 0.5 ms:",
    *(f"{number:.5f} m" for number in apart),
)
