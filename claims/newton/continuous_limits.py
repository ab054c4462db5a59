"""Newton: the limits that a file states for a continuous joint stop it, in the solver that passes models to MuJoCo Warp."""

import tempfile

import newton
import warp as wp

wp.set_device("cpu")
INERTIA = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
LINKS = "".join(f'<link name="{name}"><inertial><mass value="1"/>{INERTIA}</inertial></link>' for name in ("base", "arm"))
LIMIT = '<limit lower="-6.28318530718" upper="6.28318530718" effort="1" velocity="10"/>'
JOINT = f'<joint name="joint" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>{LIMIT}</joint>'

builder = newton.ModelBuilder()
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(f'<robot name="robot">{LINKS}{JOINT}</robot>')
    file.flush()
    builder.add_urdf(file.name)
model = builder.finalize()
model.set_gravity((0.0, 0.0, 0.0))
state = model.state()
state.joint_qd.assign([5.0])
newton.eval_fk(model, state.joint_q, state.joint_qd, state)
solver, control = newton.solvers.SolverMuJoCo(model, disable_contacts=True), model.control()
largest = 0.0
for _ in range(1500):
    solver.step(state, state, control, None, 0.001)
    largest = max(largest, float(state.joint_q.numpy()[0]))
print("told", float(model.joint_limit_upper.numpy()[0]))
print("largest", largest)
