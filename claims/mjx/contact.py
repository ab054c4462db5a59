"""Print how far (m) MJX's contacts let a block on a ramp slide from its exact place in 4 s, and how far MuJoCo's do."""

import os

os.environ |= {"JAX_ENABLE_X64": "true", "JAX_PLATFORMS": "cpu"}
import jax
import mujoco
import numpy as np
from mujoco import mjx

MODEL = """<mujoco><option timestep="0.002" integrator="Euler" gravity="0 0 -9.81"/><default><geom friction="0.5 0.005 0.0001"/>
</default><worldbody><geom type="plane" size="0 0 1" quat="0.9727884648304514 0 0.23169506402341308 0"/>
<body pos="0.02253902856401292 0 0.044631739730718656" quat="0.9727884648304514 0 0.23169506402341308 0"><freejoint/>
<inertial pos="0 0 0" mass="1" diaginertia="0.0041666666666666675 0.0041666666666666675 0.006666666666666667"/>
<geom type="box" size="0.1 0.1 0.05"/></body></worldbody></mujoco>"""
model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qpos[3:] = 0.9727884648304514, 0, 0.23169506402341308, 0
put, own = mjx.put_model(model), mjx.make_data(model).replace(qpos=jax.numpy.array(data.qpos))
_, seen = jax.jit(
    lambda put, own: jax.lax.scan(lambda one, _: (after := mjx.step(put, one), after.qpos[:3]), own, length=2000)
)(put, own)
cos = 1 / np.sqrt(1 + 0.505**2)
way = 9.81 * cos * (0.505 - 0.5) / 2 * (np.arange(1, 2001) * 0.002) ** 2
exact = data.qpos[:3] + way[:, None] * cos * np.array([1, 0, -0.505])
for name, places in (
    ("mjx", np.array(seen)),
    ("mujoco", [(mujoco.mj_step(model, data), data.qpos[:3].copy())[1] for _ in way]),
):
    print(name, np.linalg.norm(places - exact, axis=1)[4::5].max())
