"""Print the orders of MJX's RK4 in the angular velocity and in the attitude of a tumbling brick after 1 s."""

import jax
import mujoco
import numpy as np
from mujoco import mjx

jax.config.update("jax_enable_x64", True)
MODEL = """<mujoco><option integrator="RK4" gravity="0 0 0"><flag contact="disable" constraint="disable"/></option><worldbody>
<body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="0.043 0.017 0.033"/></body></worldbody></mujoco>"""

model = mujoco.MjModel.from_xml_string(MODEL)
system, start = mjx.put_model(model), mjx.make_data(model)
start = start.replace(qvel=jax.numpy.array([0.0, 0.0, 0.0, 1.0, 2.0, 3.0]))


@jax.jit
def end(timestep, steps):
    """Return the state after steps of a size (s)."""
    stepped = system.replace(opt=system.opt.replace(timestep=timestep))
    last = jax.lax.fori_loop(0, steps, lambda _, data: mjx.step(stepped, data), start)
    return last.qpos[3:], last.qvel[3:]


ends = [end(1 / steps, steps) for steps in (125, 250, 500)]
for place, name in enumerate(("attitude", "angular_velocity")):
    coarse, middle, fine = (np.array(one[place]) for one in ends)
    print(name, np.log2(np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine)))
