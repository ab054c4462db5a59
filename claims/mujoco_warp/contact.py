"""Print how far (m) MuJoCo Warp's contacts let a block on a ramp slide from its exact place in 4 s."""

import mujoco
import mujoco_warp as mjw
import numpy as np

MODEL = """<mujoco><option timestep="0.002" integrator="Euler" gravity="0 0 -9.81"/><default><geom friction="0.5 0.005 0.0001"/>
</default><worldbody><geom type="plane" size="0 0 1" quat="0.9727884648304514 0 0.23169506402341308 0"/>
<body pos="0.02253902856401292 0 0.044631739730718656" quat="0.9727884648304514 0 0.23169506402341308 0"><freejoint/>
<inertial pos="0 0 0" mass="1" diaginertia="0.0041666666666666675 0.0041666666666666675 0.006666666666666667"/>
<geom type="box" size="0.1 0.1 0.05"/></body></worldbody></mujoco>"""
model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qpos[3:] = 0.9727884648304514, 0, 0.23169506402341308, 0
put, own = mjw.put_model(model), mjw.put_data(model, data)
cos, farthest = 1 / np.sqrt(1 + 0.505**2), 0.0
for number in range(1, 2001):
    mjw.step(put, own)
    if number % 5 == 0:
        way = 9.81 * cos * (0.505 - 0.5) / 2 * (number * 0.002) ** 2
        exact = data.qpos[:3] + way * cos * np.array([1, 0, -0.505])
        farthest = max(farthest, np.linalg.norm(own.qpos.numpy()[0, :3] - exact))
print("farthest", farthest)
